"""Contacts between spheres: lattices with known coordination, a slow count, images, windows, rattlers."""

import itertools
import math

import numpy as np
import pytest

import bedrad
from bedrad.packings.coordination import sphere_contacts
from bedrad.packings.neighbours import close_pairs
from bedrad.walls import Window
from oracles.beds import axial_chain, random_bed
from oracles.layers_beds import hexagonal_sheet
from oracles.unrolled import contact_counts

TOLERANCES = np.array([0.0, 1e-3, 0.05, 0.4])


def lattice(basis, cell, across, high):
    """Unit spheres on a lattice over a plate, its lowest ones touching it; a period across."""
    shifts = itertools.product(range(across), range(across), range(high))
    centers = np.vstack([np.multiply(s, cell) + basis for s in shifts])
    return bedrad.Packing(centers + np.array([0, 0, 1]), 1.0, bedrad.Plate(), (across * cell, across * cell))


FCC = np.sqrt(2.0) * np.array([[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]])
BCC = 2 / np.sqrt(3.0) * np.array([[0, 0, 0], [1, 1, 1]])


@pytest.mark.parametrize(
    ("basis", "cell", "floor", "inside"),
    [
        (np.zeros((1, 3)), 2.0, 5, 6),
        (BCC, 4 / np.sqrt(3.0), 4, 8),
        (FCC, 2 * np.sqrt(2.0), 8, 12),
    ],
    ids=["simple cubic", "body-centred cubic", "face-centred cubic"],
)
def test_lattices_have_their_coordination(basis, cell, floor, inside):
    bed = lattice(basis, cell, 4, 3)
    # the second layer of spheres starts where the lattice puts it
    rise = np.unique(bed.centers[:, 2].round(9))[1] - 1.0
    stats = bedrad.statistics(bed, [0.0, 0.5 * rise, 1.5 * rise], contact_gap=1e-3, blocks=4)
    assert stats.coordination.tolist() == [floor, inside]
    assert stats.coordination_error == pytest.approx([0.0, 0.0], abs=1e-12)
    assert stats.contact_number_shares[floor] == pytest.approx(0.5)
    assert stats.contact_number_shares[inside] == pytest.approx(0.5)
    assert stats.contact_number_shares.sum() == pytest.approx(1.0)
    assert stats.rattler_share == 0.0


def test_contacts_of_a_lattice_lie_where_they_are():
    # simple cubic: two contacts a cell in each plane of spheres, one between two planes
    bed = lattice(np.zeros((1, 3)), 2.0, 4, 3)
    stats = bedrad.statistics(bed, [0.0, 1.0, 4.0], contact_gap=1e-3, profile_depths=[0.0, 0.9, 1.1, 1.9, 2.1, 4.0])
    volumes = 4.0 * np.diff(stats.centre_depths)  # a column of one cell
    assert stats.centre_density * volumes == pytest.approx([0, 1, 0, 0, 1])
    assert stats.contact_density * volumes == pytest.approx([0, 2, 0, 1, 2])


@pytest.mark.parametrize("kind", ["tube", "rod", "plate"])
@pytest.mark.parametrize("periodic", [True, False])
def test_counts_are_those_of_a_slow_search(kind, periodic):
    wall = {"tube": bedrad.Tube(4.0), "rod": bedrad.Rod(1.5), "plate": bedrad.Plate()}[kind]
    period = None if not periodic else (5.0, 5.0) if kind == "plate" else 5.0
    bed = random_bed(wall, 60, seed=3, length=5.0, spread=3.0, ratio=6.0, period=period)
    expected = np.array([contact_counts(bed, tolerance) for tolerance in TOLERANCES]).T
    some = np.arange(len(bed)) % 3 > 0
    found = sphere_contacts(bed, some, TOLERANCES, kept=3)
    assert found.counts.tolist() == expected[some].tolist()
    assert expected.sum() > 30
    assert np.bincount(found.first, minlength=some.sum()).tolist() == expected[some, 3].tolist()


def test_a_sphere_touches_its_own_images():
    found = sphere_contacts(axial_chain(2.0), np.array([True]), TOLERANCES + 1e-9, kept=1)
    assert found.counts.tolist() == [[2, 2, 2, 2]]
    assert found.depths == pytest.approx([2.0, 2.0])


def test_the_place_of_a_contact_is_the_middle_of_its_gap():
    bed = bedrad.Packing([[0, 0, 1.0], [0, 0, 2.34]], [1.0, 0.3], bedrad.Plate(), (9.0, 9.0))
    found = sphere_contacts(bed, np.array([True, True]), np.array([0.2]), kept=0)
    assert found.depths == pytest.approx([2.02, 2.02])


def test_gaps_are_in_radii_of_the_smaller_sphere():
    bed = bedrad.Packing([[0, 0, 1.0], [0, 0, 2.34]], [1.0, 0.3], bedrad.Plate(), (9.0, 9.0))
    found = sphere_contacts(bed, np.array([True, True]), np.array([0.13, 0.14]), kept=0)
    assert found.counts.tolist() == [[0, 1], [0, 1]]


def test_partners_outside_the_window_count():
    bed = hexagonal_sheet(4, 4)
    whole = bedrad.statistics(bed, [0.0, 1.0], blocks=2, contact_gap=1e-4)
    part = bedrad.statistics(bed, [0.0, 1.0], window=Window((0.0, 2.1), (0.0, 3.5)), blocks=1, contact_gap=1e-4)
    assert part.spheres < whole.spheres
    assert part.coordination.tolist() == whole.coordination.tolist() == [6.0]
    # and those at an open end are missing
    row = bedrad.Packing([[2.0 * k, 0, 1] for k in range(6)], 1.0, bedrad.Plate(), None)
    ends = bedrad.statistics(row, [0.0, 1.0], window=Window((-1, 11), (-1, 1)), contact_gap=1e-4, blocks=1)
    assert ends.coordination[0] == pytest.approx(10 / 6)


def test_rattlers_have_fewer_than_four_contacts_with_the_wall():
    # a square sheet with one sphere gone: four neighbours and the wall, three where the one is missing
    spots = [(2.0 * i, 2.0 * j) for i in range(4) for j in range(4)]
    bed = bedrad.Packing([[x, y, 1.0] for x, y in spots[1:]], 1.0, bedrad.Plate(), (8.0, 8.0))
    stats = bedrad.statistics(bed, [0.0, 1.0], contact_gap=1e-4, blocks=1)
    assert stats.rattler_share == 0.0
    assert stats.contact_number_shares[[3, 4]].tolist() == pytest.approx([4 / 15, 11 / 15])
    lifted = bed.centers + [[0, 0, 0.001 * (k < 5)] for k in range(15)]
    lone = bedrad.statistics(bedrad.Packing(lifted, 1.0, bed.wall, bed.period), [0.0, 1.0], contact_gap=1e-4, blocks=1)
    held = np.array(contact_counts(bedrad.Packing(lifted, 1.0, bed.wall, bed.period), 1e-4))
    held = held + (lifted[:, 2] <= 1.0001)
    assert lone.rattler_share == np.mean(held < 4) > 0


def test_more_contacts_than_classes_come_into_the_last():
    ring = [[3 * math.cos(a), 3 * math.sin(a), 5.0] for a in np.arange(13) * 2 * math.pi / 13]
    small = [[*c] for c in ring]
    bed = bedrad.Packing([[0, 0, 5.0], *small], [2.5, *[0.5] * 13], bedrad.Plate(), (20.0, 20.0))
    stats = bedrad.statistics(bed, [0.0, 1.0, 9.0], contact_gap=1e-3, blocks=1)
    assert stats.contact_number_shares[-1] == pytest.approx(1 / 14)
    assert stats.contact_number_shares[1] == pytest.approx(13 / 14)


def test_pairs_in_portions_are_the_same(monkeypatch):
    bed = random_bed(bedrad.Tube(4.0), 60, seed=3, length=5.0, spread=3.0, period=5.0)
    spheres = np.arange(len(bed))

    def found():
        pairs = list(close_pairs(bed, spheres, spheres, 1.2))
        rows = [(a, b, *v.round(12)) for p in pairs for a, b, v in zip(p.first, p.second, p.vector, strict=True)]
        return sorted(rows)

    whole = found()
    monkeypatch.setattr("bedrad.packings.neighbours.SPHERES_AT_ONCE", 7)
    assert found() == whole
    assert len(whole) > 60
