"""A slice of the campaign of `benchmarks/fuzz.py`: the same cases every time, each taken or refused."""

from __future__ import annotations

import os
import shutil
import sys
import warnings
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import bedrad
from bedrad.packings.files.hdf5_reader import Reader

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
try:
    import fuzz_guard
    import fuzz_targets

    import fuzz
finally:
    sys.path.remove(str(ROOT / "benchmarks"))

TARGETS = fuzz_targets.targets()
CHEAP = [name for name in TARGETS if name not in ("command line", "results file", "job file")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("hostile")
    fuzz.outside(place)
    return place


def case(folder: Path, name: str, seed: int) -> None:
    """Run one case; what is neither taken nor refused in a line that can be shown comes through."""
    inside = folder / "inside"
    shutil.rmtree(inside, ignore_errors=True)
    inside.mkdir()
    rng = Random(seed)
    path = fuzz_targets.make(TARGETS[name], rng, inside, folder / "outside")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        told = "read"
        try:
            TARGETS[name].call(path, rng)
        except (ValueError, OSError) as error:
            told = str(error)
    assert told
    assert len(told) < 2000
    assert told.isprintable()
    assert not (folder / "outside" / "ran").exists()


@pytest.mark.parametrize("name", CHEAP)
@settings(max_examples=40, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**32))
def test_files_are_taken_or_refused(folder: Path, name: str, seed: int) -> None:
    case(folder, name, seed)


def refuse_badly() -> None:
    raise ValueError("x\n\x1b[31m")


def die_of_it() -> None:
    raise bedrad.BadFileError("a.h5: the HDF5 library ended with signal 11 (SIGSEGV) while it read the file")


def start_the_reader(path: Path) -> None:
    reader = Reader()
    assert reader.ask("is_edem", path) is False
    reader.close()


def misbehave(path: Path, rng: Random) -> None:
    """What no reader should do, one kind after the other: by the number in the file."""
    kinds = (
        lambda: None,
        lambda: 1 / 0,
        lambda: warnings.warn("odd", stacklevel=1),
        lambda: (Path(__file__).parents[2] / "LICENSE").read_text(),
        lambda: exec("1"),
        lambda: os.system("true"),
        lambda: np.ones(20_000_000),
        refuse_badly,
        lambda: os._exit(3),
        lambda: [None for _ in iter(int, 1)],
        die_of_it,
        lambda: start_the_reader(path),
    )
    kinds[int(path.read_text())]()


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_the_campaign_finds_what_it_looks_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fuzz_guard, "LONGEST", 1.0)
    monkeypatch.setattr(fuzz_guard, "LARGEST_MEMORY", 1 << 27)

    def numbered(target: fuzz_targets.Target, _rng: Random, folder: Path, _outside: Path) -> Path:
        (folder / "file").write_text(target.name)
        return folder / "file"

    monkeypatch.setattr(fuzz, "make", numbered)
    found = {}
    for number in range(12):
        target = fuzz_targets.Target(str(number), 1.0, [], misbehave)
        campaign = fuzz.Campaign(1, tmp_path / f"{number}.json", tmp_path / "findings")
        campaign.run_target(target, 1)
        found[number] = next(iter(campaign.records[str(number)].outcomes))
    assert list(found.values()) == [
        "read",
        "ZeroDivisionError",
        "UserWarning",
        "opened or ran what it should not",
        "opened or ran what it should not",
        "opened or ran what it should not",
        "memory",
        "ValueError: no line that can be shown",
        "the process ended (3)",
        "more than 1 s",
        # and what is told, but right
        "the HDF5 library died of it",
        "read",
    ]
    assert len(list((tmp_path / "findings").iterdir())) == 10
    # the next run goes on where this one ended
    assert fuzz.Campaign(1, tmp_path / "0.json", tmp_path / "findings").records["0"].done == 1
