"""Memory and time to read a long trajectory of many spheres, frame by frame.

    python benchmarks/reading.py [--spheres 1000000] [--gigabytes 2] [--folder results] [--keep]

Writes a LAMMPS text dump of that size (made of a loose lattice of spheres in a tube, in random order, shaken anew in
every frame), then reads it in fresh processes: all frames with `read_frames`, and the last one with `read`. Reports the
largest memory of each process, with numpy, scipy and every `Packing` checked, and the time of a frame.
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
from pathlib import Path

import numpy as np

RADIUS, PITCH = 3e-4, 6.1e-4
COLUMNS = "id type x y z vx vy vz radius"

READER = """
import resource, sys, time
import bedrad
path, radius, what = sys.argv[1], float(sys.argv[2]), sys.argv[3]
wall, start = bedrad.Tube(radius), time.perf_counter()
frames = bedrad.read_frames(path, wall) if what == "all" else [bedrad.read(path, wall)]
count = spheres = 0
for packing in frames:
    count, spheres = count + 1, len(packing)
seconds = time.perf_counter() - start
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(f"{what:<5} {count:>4} frames of {spheres} spheres, {seconds:8.1f} s, {seconds / count:6.1f} s a frame, "
      f"largest memory {memory:6.0f} MiB")
"""


def tube_radius(spheres: int) -> float:
    """Radius of a tube that so many spheres of the lattice fill to 4 diameters of height for one of width. [m]"""
    return PITCH * (spheres / (8.0 * math.pi)) ** (1.0 / 3.0) + RADIUS


def lattice(spheres: int, radius: float, rng: np.random.Generator) -> np.ndarray:
    """Places of the spheres, in random order. [m]"""
    half = int(radius / PITCH) + 1
    x, y = (PITCH * part.ravel() for part in np.meshgrid(*[np.arange(-half, half + 1)] * 2))
    inside = np.hypot(x, y) < radius - RADIUS - 1e-5
    floor = np.stack([x[inside], y[inside]], axis=1)
    levels = -(-spheres // len(floor))
    places = np.column_stack([np.tile(floor, (levels, 1)), np.repeat(PITCH * np.arange(levels), len(floor))])
    return places[rng.permutation(spheres)]


def write_dump(path: Path, spheres: int, size: float) -> float:
    """Write frames until the file has its size; the radius of the tube. [m]"""
    rng = np.random.default_rng(1)
    radius = tube_radius(spheres)
    places = lattice(spheres, radius, rng)
    order = rng.permutation(spheres) + 1
    step = 0
    with path.open("wb") as stream:
        while stream.tell() < size:
            shaken = places + rng.uniform(-4e-6, 4e-6, places.shape)
            speeds = rng.normal(0.0, 0.1, places.shape)
            head = f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{spheres}\nITEM: BOX BOUNDS ff ff ff\n"
            head += "-1 1\n-1 1\n-1 9\n" + f"ITEM: ATOMS {COLUMNS}\n"
            stream.write(head.encode())
            for start in range(0, spheres, 50_000):
                rows = slice(start, start + 50_000)
                table = np.column_stack([order[rows], shaken[rows], speeds[rows]])
                lines = [f"{i:.0f} 1 {' '.join(f'{v:.9g}' for v in row)} {RADIUS}\n" for i, *row in table.tolist()]
                stream.write("".join(lines).encode())
            step += 1000
    return radius


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spheres", type=int, default=1_000_000)
    parser.add_argument("--gigabytes", type=float, default=2.0)
    parser.add_argument("--folder", type=Path, default=Path("results"))
    parser.add_argument("--keep", action="store_true", help="keep the file")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    path = given.folder / "reading.dump"
    try:
        radius = write_dump(path, given.spheres, 1e9 * given.gigabytes)
        print(f"{path.stat().st_size / 1e9:.2f} GB")
        for what in ("last", "all"):
            subprocess.run([sys.executable, "-c", READER, str(path), repr(radius), what], check=True)
    finally:
        if not given.keep:
            path.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
