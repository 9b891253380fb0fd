# make demo: set everything up and run the main job.  make test: set everything up and pass the tests.
# Needs Python 3.11 or newer (PYTHON=...), make and a C library.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: demo test lint format docs benchmark calibration fuzz study-structure study-flow study-grey heat-effort study-kills study-full-disk clean help

help:  ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/' | expand -t 18

demo: $(READY)  ## settle a bed, measure it, trace it, predict its heat transfer up to 1100 degC
	$(BIN)/bedrad run examples/hot_tube.toml -o results/hot_tube.h5

test: $(READY)  ## all tests, without those that take longer than a coffee
	$(BIN)/python -m pytest

lint: $(READY)  ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(READY)  ## put the code into the common style
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: $(READY)  ## the documentation, with a gallery that runs, into build/docs/index.html; some 2 minutes, then seconds
	$(BIN)/sphinx-build -q -W --keep-going -n -b html docs build/docs

benchmark: $(READY)  ## rays a second and time to an error, against meshes, on this machine; some 40 minutes
	$(BIN)/python benchmarks/raytrace.py --csv results/raytrace.csv
	$(BIN)/python benchmarks/scaling.py

calibration: $(READY)  ## are the stated errors of the view factors right? 200 seeds, 5 tolerances, 3 beds; some 15 minutes
	$(BIN)/python benchmarks/calibration.py --csv docs/calibration.csv

fuzz: $(READY)  ## hostile files for every reader, a million cases; some 40 minutes of a core, goes on where it was cut off
	$(BIN)/python benchmarks/fuzz.py --cases 1000000

study-structure: $(READY)  ## settled beds in tubes of 2.5 to 25 diameters: porosity beside the wall, mean porosity; some 15 minutes
	$(BIN)/python benchmarks/structure_of_settled_beds.py --csv docs/structure_of_settled_beds.csv --figure docs/images/near_wall_structure.png

study-flow: $(READY)  ## wall layers and view factors of flows; some 13 hours on two cores; goes on where it was cut off
	$(BIN)/python benchmarks/flow_study.py --csv docs/flow_study.csv
	$(BIN)/python benchmarks/flow_fits.py --csv docs/flow_study.csv --module src/bedrad/heat/flow_coefficients.py
	$(BIN)/python benchmarks/flow_study_figures.py --csv docs/flow_study.csv --folder docs/images
	$(BIN)/python benchmarks/flow_study_tables.py --csv docs/flow_study.csv

study-grey: $(READY)  ## grey walls and particles: exchange factors of settled and random beds, when black is wrong; some 5 minutes
	$(BIN)/python benchmarks/grey_radiation.py

heat-effort: $(READY)  ## error against run time of series, quadratures and draws; a minute
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/heat_effort.py --csv docs/heat_effort.csv --figure docs/images/heat_effort.png

study-kills: $(READY)  ## ensembles killed at random moments, alone, with workers, on Dask; some 40 minutes
	$(BIN)/python benchmarks/ensemble_kills.py
	$(BIN)/python benchmarks/ensemble_kills.py --workers 2
	$(BIN)/python benchmarks/ensemble_kills.py --dask

study-full-disk: $(READY)  ## commands on disks that are too small, for real (Linux, may need root); some 10 minutes
	$(BIN)/python benchmarks/full_disk.py

clean:  ## remove the environment and the results
	rm -rf $(VENV) results

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else f"bedrad needs Python 3.11 or newer; {sys.executable} is {sys.version.split()[0]}. Name another: make PYTHON=python3.12")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	@$(BIN)/python -c 'import open3d' 2>/dev/null || echo "open3d is left out, and its tests are skipped (README.md says what it needs): $$($(BIN)/python -c 'import open3d' 2>&1 | tail -n 1)"
	@touch $(READY)
