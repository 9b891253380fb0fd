"""A dense flow down a tube from Python: let it flow, measure its frames, and average the view factors over them.

python examples/flow_statistics.py

The flow is small and short, so that it takes half a minute, and says so: what is published needs longer windows and
more frames.
"""

from __future__ import annotations

import numpy as np

import bedrad
from bedrad.packings.flow import Flow
from bedrad.packings.flow_plan import Channel
from bedrad.packings.statistics import Statistics
from bedrad.packings.time_averages import errors_of_mean

CHANNEL = Channel(tube_length=20.0, window=(6.0, 14.0))  # [mean diameters]
PIECES = 4  # of the window, two diameters each


def main(frames: int = 11, flush: float = 10.0) -> tuple[Flow, Statistics, np.ndarray, np.ndarray]:
    wall = bedrad.Tube(radius=2.4e-3)
    flow = bedrad.flow(wall, diameter=600e-6, velocity=0.1, frames=frames, flush=flush, channel=CHANNEL, seed=1)
    print(flow)

    edges = bedrad.layer_edges(flow[0], layers=3)
    stats = bedrad.statistics(flow, edges=edges, window=flow.window)
    print(f"\n{stats}")

    # rays of its own for every frame; how its pieces along the axis differ says how much one bed differs from another
    traced = [
        bedrad.view_factors(bed, edges, tolerance=2e-3, seed=k, window=flow.window, blocks=PIECES)
        for k, bed in enumerate(flow)
    ]
    pieces = np.array([found.block_shares for found in traced])  # (frames, pieces, layers + 3)
    shares = pieces.mean(axis=(0, 1))
    errors, structures = errors_of_mean(pieces)
    print(f"\nview factors from the wall, mean over {len(flow)} frames")
    names = ("layer 1", "layer 2", "layer 3", "beyond", "wall", "escaped")
    for name, share, error, count in zip(names, shares, errors, structures, strict=True):
        print(f"{name:<10} {share:.4f} ± {error:.4f}   ({count:.1f} independent structures)")
    return flow, stats, shares, errors


if __name__ == "__main__":
    main()
