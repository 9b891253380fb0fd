"""Whole files of every kind, from which hostile ones are made: those of the tests, and what bedrad writes."""

from __future__ import annotations

import gzip
import io
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import bedrad
from bedrad.jobs.fields import PREDICTION, VIEW_FACTORS
from bedrad.jobs.results import Results, save_fields
from bedrad.packings.files import save_packing

__all__ = ["Sample", "job_samples", "measured_samples", "results_samples", "samples", "small_bed"]

ROOT = Path(__file__).resolve().parents[1]
DATA = ROOT / "tests" / "data"
EXAMPLES = ROOT / "examples"

_LARGEST = 60_000
"""What a sample may have, so that a case stays cheap. [bytes]"""

_SOURCES = {
    "LAMMPS dump": ("lammps_dumps/*.dump*", "vtk/*.dump"),
    "MercuryDPM data": ("mercury/*.data",),
    "MercuryDPM restart": ("mercury/*.restart",),
    "MFiX": ("mfix/*.dat",),
    "VTK legacy": ("vtk/*.vtk",),
    "VTK XML": ("vtk/*.vtp", "vtk/*.vtu", "vtk/*.vtr"),
    "xyz": ("extended_xyz/*.xyz",),
    "YADE text": ("yade/*.txt",),
    "LAMMPS data": ("lammps_data/*.data",),
    "npz": ("npz/*.npz",),
    "points": ("yade/x_y_z_r.txt", "yade/clumps.txt"),
    "CSV": (),
    "bedrad HDF5": (),
}
_WRITTEN = {
    "bedrad HDF5": (".h5",),
    "VTK XML": (".vtp",),
    "CSV": (".csv",),
    "xyz": (".xyz",),
    "YADE text": (".yade",),
    "LAMMPS data": (".lmp",),
}


@dataclass(frozen=True)
class Sample:
    """Files that belong together; the first is the one that is read.

    Parameters
    ----------
    files : mapping of str to bytes
        Names, which may have a folder before them, and contents.
    """

    files: dict[str, bytes]

    @property
    def name(self) -> str:
        """Name of the file that is read."""
        return next(iter(self.files))


def small_bed(wall: bedrad.Tube | bedrad.Rod | bedrad.Plate | None = None) -> bedrad.Packing:
    """Some rings of spheres in a tube, or beside another wall."""
    turn = 2.0 * np.pi * np.arange(12) / 12
    centers = np.vstack([np.c_[3e-3 * np.cos(turn), 3e-3 * np.sin(turn), np.full(12, 2e-3 * k)] for k in range(4)])
    centers[:, 2] += 1e-3
    beside = bedrad.Tube(3.7e-3) if wall is None else wall
    period = 8e-3 if beside.kind == "tube" else None
    return bedrad.Packing(centers, 7e-4, beside, period, {"program": "fuzz", "friction": 0.4, "seed": 3})


def samples() -> dict[str, list[Sample]]:
    """The samples of every format of packings by its name."""
    found = {
        name: [Sample({path.name: path.read_bytes()}) for pattern in patterns for path in sorted(DATA.glob(pattern))]
        for name, patterns in _SOURCES.items()
    }
    with tempfile.TemporaryDirectory() as folder:
        for name, suffixes in _WRITTEN.items():
            for suffix in suffixes:
                for wall in (None, bedrad.Rod(2e-3), bedrad.Plate()):
                    path = Path(folder) / f"bed{suffix}"
                    bedrad.write(small_bed(wall), path)
                    found[name].append(Sample({path.name: path.read_bytes()}))
    found["CSV"] += [Sample({"table.csv": text.encode()}) for text in _TABLES]
    found["points"] += [Sample({"points.txt": text.encode()}) for text in _POINTS]
    found["VTK pointing"] = _pointing()
    found["EDEM"] = _decks()
    found["STL"] = _stl()
    return {
        name: [sample for sample in listed if sum(map(len, sample.files.values())) < _LARGEST]
        for name, listed in found.items()
    }


_TABLES = (
    "x [mm],y [mm],z [mm],radius [mm]\n1,2,3,0.5\n4,5,6,0.5\n",
    '"Track: Position[X] (m)","Track: Position[Y] (m)","Track: Position[Z] (m)","Size (m)"\n0,0,1,0.5\n0,0,3,0.5\n',
    "Particle X-Coordinate: (m);Particle Y-Coordinate: (m);Particle Z-Coordinate: (m);Diameter (m)\n0;0;1;0.5\n",
    "id\tx_mm\ty_mm\tz_mm\tdiameter_mm\n1\t0\t0\t1\t0.5\n2\t0\t0\t2\t0.5\n",
)
_POINTS = ("# x y z r\n0 0 1 0.5\n0 0 3 0.5\n", "x[mm] y[mm] z[mm] d[mm]\n0 0 1 0.5\n0 0 3 0.5\n", "0 0 1\n0 0 3\n")


def _pointing() -> list[Sample]:
    """Files that name other files, with these."""
    beside = {
        "mfix.pvd": ("mfix_0000.vtp", "mfix_0001.vtp"),
        "parallel2000.pvtp": ("parallel2000_0.vtp", "parallel2000_1.vtp"),
        "parallelgrid2000.pvtu": ("parallelgrid2000_0.vtu", "parallelgrid2000_1.vtu"),
    }
    return [Sample({name: (DATA / "vtk" / name).read_bytes() for name in (k, *v)}) for k, v in beside.items()]


def _decks() -> list[Sample]:
    """An EDEM deck with its time steps, and two of these by themselves."""
    deck = DATA / "edem"
    parts = {f"deck_data/{k}.h5": (deck / "deck_data" / f"{k}.h5").read_bytes() for k in range(3)}
    whole = {"deck.dem": (deck / "deck.dem").read_bytes(), **parts}
    alone = [Sample({"0.h5": parts["deck_data/0.h5"]})]
    return [Sample(whole), *alone * 4]


def _stl() -> list[Sample]:
    """Tubes and a plate as triangles, binary and text, where the extra mesh is installed."""
    try:
        import trimesh
    except ImportError:
        return []
    meshes = [
        trimesh.creation.cylinder(radius=1.0, height=3.0, sections=24),
        trimesh.creation.annulus(r_min=1.0, r_max=1.2, height=2.0, sections=16),
        trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]),
    ]
    found = [Sample({"wall.stl": trimesh.exchange.stl.export_stl(mesh)}) for mesh in meshes]
    return found + [Sample({"wall.stl": trimesh.exchange.stl.export_stl_ascii(mesh).encode()}) for mesh in meshes]


_JOB = """
name = "rings"
seed = 3

[packing.file]
path = "bed.h5"
frames = "0:3:1"
axis = [0.0, 0.0, 1.0]
period = "8 mm"
unit = "mm"

[packing.file.columns]
x = 1
y = "Y"

[layers]
count = 2
margin = 0.5

[statistics]
contact_gap = 0.01

[view_factors]
rays = 4096

[convergence]
rays = 2048
reference_rays = 32768
seeds = 2

[prediction]
wall_temperatures = ["100 degC", "850 degC"]
velocity = "0.016 m/s"

[output]
figures = false
"""
_SWEEP = """
[wall]
shape = "tube"
diameter = "7.75 mm"

[packing.settle]
height = "18 mm"
sizes = [{diameter = "500 um", share = 0.3}, {diameter = "600 um", share = 0.7}]

[sweep]
tube_diameter = ["7.75 mm", "9 mm"]
seed = {first = 1, count = 4}

[view_factors]
tolerance = 1e-3
"""


def job_samples() -> list[Sample]:
    """Jobs, with the bed that they name."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bed.h5"
        bedrad.write(small_bed(), path)
        bed = {"bed.h5": path.read_bytes()}
    texts = [*(path.read_bytes() for path in sorted(EXAMPLES.glob("*.toml"))), _JOB.encode(), _SWEEP.encode()]
    return [Sample({"job.toml": text, **bed}) for text in texts]


def results_samples() -> list[Sample]:
    """A results file with three stages, written as jobs write it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "results.h5"
        results, attributes = Results(path), {"job": "{}", "inputs": "{}"}
        rows = {name: np.linspace(300.0, 1000.0, 3) for name in PREDICTION}
        shares = {name: np.array([0.8, 0.15]) for name in VIEW_FACTORS}
        results.write_stage("packing", "a" * 64, lambda g: save_packing(g, small_bed()), keep=(), attributes=attributes)
        for stage, values, fields in (("view_factors", shares, VIEW_FACTORS), ("prediction", rows, PREDICTION)):
            results.write_stage(
                stage,
                "b" * 64,
                lambda group, v=values, f=fields: save_fields(group, v, f),  # type: ignore[misc]
                keep=("packing", "view_factors"),
                attributes=attributes,
            )
        return [Sample({"results.h5": path.read_bytes()})]


def measured_samples() -> list[Sample]:
    """Tables of measured flows."""
    text = (EXAMPLES / "measured_flow.csv").read_bytes()
    stream = io.BytesIO(gzip.compress(text, mtime=0))
    return [Sample({"measured.csv": text}), Sample({"measured.csv": text}), Sample({"measured.csv": stream.getvalue()})]
