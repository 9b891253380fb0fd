"""A bed of rings in a tube, and a job on it that runs in a moment."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import bedrad
from bedrad.jobs import stages

DIAMETER = 600e-6
"""Particle diameter. [m]"""

WALL = bedrad.Tube(12.9 * DIAMETER / 2)

STAGES = ("packing", "statistics", "view_factors", "convergence", "prediction")

JOB = """
name = "rings"
seed = 3

[packing.file]
path = "bed.h5"

[statistics]

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


def ring_bed(seed=1, rings=12):
    """Rings of equal spheres along the wall, one in five off it by up to half a radius, and more rings behind."""
    rng = np.random.default_rng(seed)
    spacing, centers = 2.05, []
    for depth, shell_count in ((1.0, 36), (3.5, 28), (5.55, 22), (7.6, 15)):
        for ring in range(rings):
            angle = 2 * np.pi * (np.arange(shell_count) + rng.random()) / shell_count
            lifted = rng.uniform(0.1, 0.5, shell_count) * (rng.random(shell_count) < 0.2) if depth == 1.0 else 0.0
            radial = 12.9 - depth - lifted
            height = np.full(shell_count, spacing * ring)
            centers.append(np.c_[radial * np.cos(angle), radial * np.sin(angle), height])
    scale = DIAMETER / 2
    return bedrad.Packing(np.vstack(centers) * scale, scale, WALL, period=rings * spacing * scale)


def write_job(folder: Path, text: str = JOB, seed: int = 1) -> Path:
    """Write the bed and the job into a folder; the job's path."""
    bedrad.write(ring_bed(seed), folder / "bed.h5")
    path = folder / "job.toml"
    path.write_text(text, encoding="utf-8")
    return path


def stub_stages(monkeypatch, **failures):
    """Stages that do nothing, or fail as told."""

    def stub(name):
        def run(*_):
            if name in failures:
                raise failures[name]
            return lambda group: group.create_dataset("nothing", data=0.0)

        return run

    monkeypatch.setattr(stages, "RUNNERS", {name: stub(name) for name in STAGES})
