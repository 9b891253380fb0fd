"""Slow, literal counterparts of the contact counts and of the order of the wall layer."""

from __future__ import annotations

import cmath
import itertools
import math

import numpy as np


def images(packing, reach=2):
    """All spheres with their images a few periods around: (image number, sphere number, centre)."""
    ranges = [range(-reach, reach + 1) if length else (0,) for length in packing.box]
    for shift in itertools.product(*ranges):
        for j, center in enumerate(packing.centers):
            yield shift, j, center + np.multiply(shift, packing.box)


def contact_counts(packing, tolerance):
    """Contacts of every sphere with others, one sphere after the other."""
    everything = list(images(packing))
    others = np.array([center for _, _, center in everything])
    radii = packing.radii[[j for _, j, _ in everything]]
    counts = []
    for i, (center, r) in enumerate(zip(packing.centers, packing.radii, strict=True)):
        gaps = np.sqrt(((others - center) ** 2).sum(axis=1)) - r - radii
        itself = [j == i and not any(shift) for shift, j, _ in everything]
        counts.append(int(((gaps <= tolerance * np.minimum(r, radii)) & ~np.array(itself)).sum()))
    return counts


def orders(packing, touching):
    """|psi_6| of the touching spheres and their number of neighbours, on the unrolled wall."""
    shell = (1 + math.sqrt(3)) / 2
    found = {}
    plate = packing.wall.kind == "plate"
    partners = [image for image in images(packing, 1) if touching[image[1]]]
    for i in np.flatnonzero(touching):
        bonds = []
        for shift, j, other in partners:
            if j == i and not any(shift):
                continue
            x, y, z = packing.centers[i]
            if plate:
                along, across = other[0] - x, other[1] - y
            else:
                along = other[2] - z
                turn = math.atan2(other[1], other[0]) - math.atan2(y, x)
                turn = (turn + math.pi) % (2 * math.pi) - math.pi
                across = turn * 0.5 * (math.hypot(x, y) + math.hypot(other[0], other[1]))
            if math.hypot(along, across) <= shell * (packing.radii[i] + packing.radii[j]):
                bonds.append(cmath.exp(6j * math.atan2(along, across)))
        found[int(i)] = (abs(sum(bonds)) / len(bonds) if len(bonds) > 1 else 0.0, len(bonds))
    return found
