"""Rays a second on one core and on all, and what it buys: run time to an error, scrambled Sobol against plain random.

Ratios are measured side by side in this one run; single times depend on the machine.

    python benchmarks/ray_rate.py [BED]

BED is a packing; without it, a bed like that of the demo is settled first (needs the extra dem).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import bedrad
from bedrad.raytrace import view_factors as tracer
from bedrad.raytrace.sampling import DIMENSIONS, SobolStreams

RUNS = 5
RAYS = 2**22


class RandomStreams(SobolStreams):
    """Plain Monte Carlo in place of Sobol points."""

    def __init__(self, seed: int, count: int) -> None:
        self._generators = [np.random.default_rng(c) for c in np.random.SeedSequence(seed).spawn(count)]

    def __len__(self) -> int:
        return len(self._generators)

    def draw(self, stream: int, count: int):  # noqa: D102 - as its base
        while count > 0:
            batch = min(count, 2**13)
            yield self._generators[stream].random((batch, DIMENSIONS))
            count -= batch


def demo_bed(argument: str | None) -> bedrad.Packing:
    if argument is not None:
        return bedrad.read(argument)
    kept = Path("results/benchmark_bed.h5")
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        bedrad.write(bedrad.settle(bedrad.Tube(3.875e-3), 600e-6, 18e-3, seed=1), kept)
    return bedrad.read(kept)


def rate(bed: bedrad.Packing, threads: int | None) -> float:
    found = bedrad.view_factors(bed, rays=RAYS, threads=threads)
    return found.rays / (found.seconds - found.setup_seconds)


def main() -> None:
    bed = demo_bed(sys.argv[1] if len(sys.argv) > 1 else None)
    bedrad.view_factors(bed, rays=2**12)  # compile
    processors = tracer.available_processors()
    pairs = [(rate(bed, 1), rate(bed, processors)) for _ in range(RUNS)]
    one = sorted(p[0] for p in pairs)
    ratio = sorted(p[1] / p[0] for p in pairs)
    print(f"{len(bed):,} spheres; {RAYS:,} rays, {RUNS} runs: lowest, median, highest")
    print("one core, million rays a second     " + "  ".join(f"{one[k] / 1e6:6.2f}" for k in (0, RUNS // 2, -1)))
    print(
        f"{processors} cores over one                    " + "  ".join(f"{ratio[k]:6.2f}" for k in (0, RUNS // 2, -1))
    )
    errors = {}
    for name, streams in (("Sobol", SobolStreams), ("random", RandomStreams)):
        tracer.SobolStreams = streams
        squares = [bedrad.view_factors(bed, rays=RAYS, seed=s).layers_error[0] ** 2 for s in range(RUNS)]
        errors[name] = np.sqrt(np.mean(squares))
    tracer.SobolStreams = SobolStreams
    gain = (errors["random"] / errors["Sobol"]) ** 2
    print(f"standard error of F_w1 at {RAYS:,} rays: Sobol {errors['Sobol']:.2e}, random {errors['random']:.2e}")
    print(f"plain random rays need {gain:.1f} times as many rays for the same error")
    for spheres in (10**3, 10**4, 10**5):
        wide = random_plate(spheres)
        bedrad.view_factors(wide, rays=2**12)
        found = bedrad.view_factors(wide, rays=2**21, threads=1)
        seconds = found.seconds - found.setup_seconds
        print(
            f"{spheres:>7,} spheres on a plate: {seconds / found.rays * 1e9:6.0f} ns a ray, "
            f"set-up {found.setup_seconds:.3f} s"
        )


def random_plate(count: int) -> bedrad.Packing:
    """Loose jittered rows of unit spheres three deep, as wide as it takes."""
    across = int(np.ceil(np.sqrt(count / 3)))
    x, y, z = np.meshgrid(np.arange(across), np.arange(across), np.arange(3), indexing="ij")
    rng = np.random.default_rng(1)
    centers = 2.4 * np.column_stack([x.ravel(), y.ravel(), z.ravel()]) + rng.uniform(-0.19, 0.19, (x.size, 3))
    centers[:, 2] += 1.2
    return bedrad.Packing(centers[:count], 1.0, bedrad.Plate(), period=(2.4 * across, 2.4 * across))


if __name__ == "__main__":
    main()
