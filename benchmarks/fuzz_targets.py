"""What is fuzzed: how a hostile file of each kind is made, and what reads it."""

from __future__ import annotations

import io
import itertools
import os
import re
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import fuzz_samples
from fuzz_mutations import NUMBERS, WORDS, mutated, packed
from fuzz_samples import Sample
from fuzz_structures import edited_hdf5, hostile_npz, hostile_toml, hostile_xml

import bedrad
from bedrad import cli
from bedrad.jobs.job import load_job
from bedrad.jobs.measurements import read_measurements
from bedrad.jobs.results import Results
from bedrad.jobs.units import quantity, temperature_difference
from bedrad.packings.files import count_frames, read, read_frames, write
from bedrad.packings.wall_stl import read_wall_stl

__all__ = ["CANARY", "Target", "UnwantedError", "make", "targets"]

CANARY = 17
"""Spheres of the bed that lies outside: a reader that gives so many of its radius has followed a name there."""

CANARY_RADIUS = 0.123456789

_BINARY = ("npz", "bedrad HDF5", "EDEM", "results file", "STL")
_SUFFIXES = (
    *(".h5", ".dump", ".data", ".dat", ".vtp", ".pvd", ".vtk", ".csv", ".xyz", ".yade", ".lmp", ".npz", ".txt"),
)
_FRAMES = 20


class UnwantedError(Exception):
    """What a file had a reader do, and no file should."""


@dataclass(frozen=True)
class Target:
    """Something that reads files.

    Parameters
    ----------
    name : str
        Its name.
    weight : float
        Its share of the cases, before it is divided by the sum of all.
    samples : list of Sample
        What the files are made from.
    call : callable
        Reads the file at a path; gets a source of chance for its options.
    """

    name: str
    weight: float
    samples: list[Sample]
    call: Callable[[Path, Random], Any]


def targets() -> dict[str, Target]:
    """All targets by name."""
    found = fuzz_samples.samples()
    # what is read quickly is read often
    weights = {"EDEM": 0.05, "bedrad HDF5": 0.25, "VTK pointing": 0.5, "STL": 0.1}
    made = [
        Target(name, weights.get(name, 1.0), listed, _read_wall if name == "STL" else _read)
        for name, listed in found.items()
        if listed
    ]
    everything = [sample for name, listed in found.items() if name != "STL" for sample in listed]
    made.append(Target("any by its content", 1.0, everything, _read))
    made.append(Target("job file", 0.15, fuzz_samples.job_samples(), _load_job))
    made.append(Target("results file", 0.03, fuzz_samples.results_samples(), _read_results))
    made.append(Target("measurements", 0.2, fuzz_samples.measured_samples(), _read_measurements))
    made.append(Target("quantities", 0.5, [Sample({"text": text.encode()}) for text in _QUANTITIES], _read_quantity))
    mixed = everything + fuzz_samples.job_samples() + fuzz_samples.measured_samples() + fuzz_samples.results_samples()
    made.append(Target("command line", 0.01, mixed, _command))
    return {target.name: target for target in made}


def make(target: Target, rng: Random, folder: Path, outside: Path) -> Path:
    """Write the files of a case into a folder; the path of the one to read."""
    sample = rng.choice(target.samples)
    files = dict(sample.files)
    names = list(files)
    changed = names[0] if len(names) == 1 or rng.random() < 0.7 else rng.choice(names)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        files[changed] = _hostile(target, rng, changed, files[changed], outside)
    name = names[0]
    if rng.random() < 0.02:
        renamed = Path(name).stem + rng.choice(_SUFFIXES) + rng.choice(("", "", ".gz"))
        files = {renamed: files.pop(name), **files}
        name = renamed
    for each, data in files.items():
        path = folder / each
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    if target.name in ("VTK pointing", "job file", "command line", "EDEM"):
        _leads_elsewhere(folder, outside)
    return folder / name


def _leads_elsewhere(folder: Path, outside: Path) -> None:
    """Put beside the files what names may lead to: a link out, a pipe, a folder."""
    for name, kind in (("link.vtp", "link"), ("fifo", "pipe"), ("folder", "folder")):
        path = folder / name
        if kind == "link":
            path.symlink_to(outside / "canary.vtp")
        elif kind == "pipe":
            os.mkfifo(path)
        else:
            path.mkdir()


def _hostile(target: Target, rng: Random, name: str, data: bytes, outside: Path) -> bytes:
    others = [next(iter(sample.files.values())) for sample in target.samples[:20]]
    suffix = Path(name).suffix
    chance = rng.random()
    structured: Callable[[], bytes] | None = None
    if data.startswith(b"\x89HDF"):
        structured = lambda: edited_hdf5(rng, data, outside)  # noqa: E731
    elif data.startswith(b"PK"):
        structured = lambda: hostile_npz(rng, data, outside)  # noqa: E731
    elif b"<VTKFile" in data[:300]:
        structured = lambda: hostile_xml(rng, data)  # noqa: E731
    elif suffix == ".toml":
        structured = lambda: hostile_toml(rng, data)  # noqa: E731
    if structured is not None and chance < 0.5:
        data = structured()
        if chance < 0.4:
            return data
    binary = target.name in _BINARY or b"\0" in data[:4000]
    data = mutated(rng, data, others, binary=binary)
    if structured is None and rng.random() < 0.02:
        data = packed(rng, data)
    return data


_OPTIONS = (
    ("unit", "mm", 0.05),
    ("diameter", 1e-3, 0.05),
    ("period", 0.0, 0.05),
    ("period", 1.0, 0.02),
    ("axis", "x", 0.05),
    ("axis", (0.3, 1.0, 0.2), 0.03),
)


def _read(path: Path, rng: Random) -> None:
    """Read a packing, in one of the ways that users have."""
    wall = rng.choice((*(bedrad.Tube(1e3),) * 9, None, None, None, "rod", "plate", bedrad.Plate()))
    options: dict[str, Any] = {"max_overlap": rng.choice((2.0, 2.0, 2.0, None))}
    options |= {name: value for name, value, share in _OPTIONS if rng.random() < share}
    way = rng.random()
    if way < 0.4:
        beds = iter([read(path, wall, frame=rng.choice((-1, -1, 0, 1)), **options)])
    elif way < 0.97:
        beds = itertools.islice(read_frames(path, wall, **options), _FRAMES)
    else:
        count_frames(path)
        return
    for bed in beds:
        if not isinstance(bed, bedrad.Packing) or (len(bed) == CANARY and bed.radii[0] == CANARY_RADIUS):
            raise UnwantedError(f"{path.name}: gave {bed!r}, which lies outside")
        if rng.random() < 0.01:
            write(bed, path.with_name("again" + rng.choice((".h5", ".vtp", ".csv", ".xyz", ".lmp", ".yade"))))


def _read_wall(path: Path, _: Random) -> None:
    read_wall_stl(path)


def _load_job(path: Path, _: Random) -> None:
    job = load_job(path)
    job.resolved()


def _read_results(path: Path, _: Random) -> None:
    results = Results(path)
    results.attributes()
    for stage in ("packing", *results.digests()):
        data = results.read(stage)
        if str(CANARY_RADIUS) in str(data):
            raise UnwantedError(f"{path.name}: gave numbers from outside")
    results.bed()


def _read_measurements(path: Path, rng: Random) -> None:
    read_measurements(path, rng.choice((None, 1.57)))


_QUANTITIES = (
    "600 um",
    "7.75mm",
    "850 degC",
    "2.1 W/(m K)",
    "3800 kg/m^3",
    "1.9 mm^-2",
    "50 kW/m^2",
    "5 K",
    "0.05 m/s",
)
_UNITS = ("m", "m/s", "K", "kg/m^3", "N/m", "W/(m K)", "1/m^2", "W/m^2", "Pa", "1")


def _read_quantity(path: Path, rng: Random) -> None:
    text = path.read_bytes().decode("utf-8", "replace")
    if rng.random() < 0.3:
        text = rng.choice(NUMBERS).decode() + " " + rng.choice(WORDS).decode("utf-8", "replace") + text
    quantity(text, rng.choice(_UNITS))
    temperature_difference(text)


def _command(path: Path, rng: Random) -> None:
    """Give a file to the command line, which must answer with an exit code and lines that can be shown."""
    job = path.suffix == ".toml"
    words = {
        "job": ("run", path, "--dry-run", "-o", path.with_name("out.h5")),
        "measured": ("reduce", path, *_TUBE),
        "bed": rng.choice(
            (
                ("statistics", path, "--dry-run", "--tube", "2km"),
                ("view-factors", path, "--dry-run"),
                ("convert", path, path.with_name("out.vtp"), "--tube", "2km"),
                ("convert", path, path.with_name("out.csv"), "--dry-run", "--all-frames"),
            )
        ),
    }["job" if job else "measured" if path.name.startswith("measured") else "bed"]
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", RuntimeWarning)
        code = cli.main([str(word) for word in words])
    said, told = out.getvalue(), [line for line in err.getvalue().splitlines() if line.strip()]
    if code not in (0, 1, 2) or "Traceback" in said + err.getvalue():
        raise UnwantedError(f"exit code {code}: {told}")
    if code and not (told and told[0].startswith("bedrad: ") and (job or len(told) == 1)):
        raise UnwantedError(f"exit code {code} without one line that says why: {told}")
    if odd := re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", said + "\n".join(told)):
        raise UnwantedError(f"a control character, {odd.group()!r}, on the screen, in {words[0]}")


_TUBE = ("--tube", "7.614mm", "--outer", "9.53mm", "--diameter", "270um", "--heated-length", "1.57m")
