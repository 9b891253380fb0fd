"""Statistics over several frames: means, errors against the truth, frames that are alike, frames that do not fit."""

import dataclasses
import gc
import math
import weakref

import numpy as np
import pytest
import scipy.stats

import bedrad
from bedrad.packings.statistics import Statistics, TrajectoryStatistics
from bedrad.walls import Window
from oracles.layers_beds import free_gas, hexagonal_sheet

WALL, LENGTH = bedrad.Tube(6.0), 32.0
EDGES = [0.0, 1.0, 3.0]
MEASURED = [field.name.removesuffix("_error") for field in dataclasses.fields(Statistics) if "_error" in field.name]


def gas(seed, count=150):
    return free_gas(WALL, seed, count, LENGTH)


def measure(frames, **options):
    return bedrad.statistics(frames, EDGES, profile_depths=EDGES, **options)


@pytest.fixture(scope="module")
def three():
    frames = [gas(seed) for seed in (1, 2, 3)]
    return measure(frames), [measure(frame) for frame in frames]


# ---- values ----


def test_one_frame_is_one_packing():
    found, alone = measure(iter([gas(1)])), measure(gas(1))
    assert type(found) is Statistics
    for name in MEASURED:
        assert np.array_equal(getattr(found, name), getattr(alone, name), equal_nan=True), name
        assert np.array_equal(getattr(found, name + "_error"), getattr(alone, name + "_error"), equal_nan=True), name


def test_densities_are_means_over_the_frames(three):
    found, single = three
    assert isinstance(found, TrajectoryStatistics)
    assert found.frames == 3
    for name in ("packing_fractions", "profile", "contacts_per_area_by_gap", "contact_ratio", "centre_density",
                 "contact_density", "packing_fraction"):  # fmt: skip
        assert getattr(found, name) == pytest.approx(np.mean([getattr(s, name) for s in single], axis=0)), name


def test_shares_and_distances_are_ratios_of_sums(three):
    found, single = three
    nc, touching = (np.array([getattr(s, name) for s in single]) for name in ("no_contacts", "contacts"))
    assert len(set(nc)) == 3
    assert found.nc_share == pytest.approx(nc.sum() / (nc + touching).sum())
    assert found.nc_distance == pytest.approx(np.average([s.nc_distance for s in single], weights=nc))
    assert found.hexagonal_order == pytest.approx(np.average([s.hexagonal_order for s in single], weights=touching))
    assert found.nc_gap_density == pytest.approx(np.average([s.nc_gap_density for s in single], axis=0, weights=nc))
    # the closing distance is that of the sums, not the mean of those of the frames
    assert min(s.nc_distance_closing for s in single) < found.nc_distance_closing
    assert found.nc_distance_closing < max(s.nc_distance_closing for s in single)


def test_counts_are_those_of_all_frames(three):
    found, single = three
    for name in ("spheres", "contacts", "no_contacts"):
        assert getattr(found, name) == sum(getattr(s, name) for s in single)
    for reason in ("outside_window", "deeper"):
        assert found.left_out[reason] == sum(s.left_out[reason] for s in single)
    assert found.overlap_share == pytest.approx(np.mean([s.overlap_share for s in single]))


def test_frames_in_any_order_give_the_same_values():
    frames = [gas(seed) for seed in (4, 5, 6, 7)]
    # the layers of equal spheres do not depend on which frame comes first
    there, back = measure(frames), measure(frames[::-1])
    for name in MEASURED:
        np.testing.assert_allclose(getattr(there, name), getattr(back, name), rtol=1e-12)
        np.testing.assert_allclose(getattr(there, name + "_error"), getattr(back, name + "_error"), rtol=1e-6)


# ---- errors ----


@pytest.mark.parametrize("count", [2, 9])
def test_identical_frames_have_the_error_of_one(count):
    alone, frozen = measure(gas(1)), measure([gas(1)] * count)
    for name in MEASURED:
        np.testing.assert_allclose(getattr(frozen, name), getattr(alone, name), rtol=1e-12)
        one, many = getattr(alone, name + "_error"), getattr(frozen, name + "_error")
        # ratios of few particles are linearised about all frames, which changes their errors by a few percent
        np.testing.assert_allclose(many, one, rtol=0.1, atol=1e-12, err_msg=name)
        np.testing.assert_allclose(np.nan_to_num(frozen.structures[name], nan=1.0), 1.0, rtol=1e-9, err_msg=name)
    for name in ("packing_fraction", "contact_ratio", "profile", "contact_density"):
        np.testing.assert_allclose(getattr(frozen, name + "_error"), getattr(alone, name + "_error"), rtol=1e-9)


RUNS, FRAMES = 40, 8
FALSE_ALARM = 1e-5  # of each comparison, two-sided, if the errors were exact


@pytest.fixture(scope="module")
def independent():
    return [measure([gas(1000 * run + k, 80) for k in range(FRAMES)]) for run in range(RUNS)]


@pytest.mark.parametrize(
    "name",
    ["packing_fraction", "contacts_per_area", "nc_share", "nc_distance", "nc_distance_weighted",
     "nc_distance_closing", "hexagonal_order", "rattler_share"],
)  # fmt: skip
def test_errors_of_independent_frames_are_right_or_a_little_large(independent, name):
    values = np.array([getattr(s, name) for s in independent])
    errors = np.array([getattr(s, name + "_error") for s in independent])
    # with eight frames the errors are meant to be up to 1.6 times too large (test_time_averages)
    ratio = values.var(ddof=1) / np.mean(errors**2)
    low, high = scipy.stats.f.ppf([FALSE_ALARM / 2, 1 - FALSE_ALARM / 2], RUNS - 1, 7 * RUNS)
    assert low / 1.6**2 < ratio < high
    structures = np.array([s.structures[name] for s in independent])
    assert np.median(structures) > FRAMES / 3
    assert structures.max() <= FRAMES
    # and smaller than those of one frame
    alone = [getattr(measure(gas(1000 * run, 80)), name + "_error") for run in range(20)]
    assert np.sqrt(np.mean(errors**2)) < 0.85 * np.sqrt(np.nanmean(np.square(alone)))


def test_errors_without_blocks_come_from_time_alone():
    found = measure([gas(seed, 80) for seed in range(12)], blocks=1)
    assert found.packing_fraction_error > 0
    assert 1 <= found.structures["packing_fraction"] <= 12
    assert math.isnan(measure([gas(1)] * 3, blocks=1).packing_fraction_error)


# ---- sources ----


def write_dump(path, frames):
    with path.open("w") as stream:
        for step, bed in enumerate(frames):
            stream.write(f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(bed)}\nITEM: BOX BOUNDS ff ff ff\n")
            stream.write("-9 9\n-9 9\n0 40\nITEM: ATOMS id x y z radius\n")
            for number, (center, radius) in enumerate(zip(bed.centers.tolist(), bed.radii.tolist(), strict=True)):
                stream.write(" ".join(map(repr, (number + 1, *center, radius))) + "\n")


def rings(turn):
    angles = np.arange(12) * 2 * np.pi / 12 + turn
    heights = np.arange(12) * 2.1
    ring = np.c_[4.9 * np.cos(angles), 4.9 * np.sin(angles)]
    return bedrad.Packing([[x, y, 1 + z] for z in heights for x, y in ring], 1.0, bedrad.Tube(6.0))


def test_all_frames_of_a_file_are_read(tmp_path):
    frames = [rings(turn) for turn in (0.0, 0.1, 0.25)]
    write_dump(tmp_path / "three.dump", frames)
    direct = bedrad.statistics(frames, margin=1)
    found = bedrad.statistics(bedrad.read_frames(tmp_path / "three.dump", WALL), margin=1)
    assert (found.frames, found.packing_fraction) == (3, pytest.approx(direct.packing_fraction, rel=1e-12))
    for bed, name in ((frames[0], "one.h5"), (frames[1], "one.csv")):
        bedrad.write(bed, tmp_path / name)
        for path in (tmp_path / name, str(tmp_path / name)):
            assert type(bedrad.statistics(path, margin=1)) is Statistics
            assert bedrad.statistics(path, margin=1).nc_distance == bedrad.statistics(bed, margin=1).nc_distance


def test_one_frame_is_in_memory_at_a_time():
    alive = []

    def frames():
        for seed in range(6):
            gc.collect()
            assert sum(reference() is not None for reference in alive) <= 1
            bed = gas(seed, 60)
            alive.append(weakref.ref(bed))
            yield bed

    assert measure(frames()).frames == 6


def taller(shift):
    bed = rings(0.0)
    return bedrad.Packing(bed.centers + np.array([0, 0, shift]), 1.0, bed.wall)


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        ([], "there are no frames"),
        ([gas(1), bedrad.Packing([], 1.0, WALL, LENGTH)], "frame 1: the packing is empty"),
        ([bedrad.Packing([], 1.0, WALL, LENGTH)], "frame 0: the packing is empty"),
        (
            [gas(1), gas(2), free_gas(bedrad.Tube(6.1), 1, 50, LENGTH)],
            r"frame 2: the wall is Tube\(radius=6\.1\)",
        ),
        ([rings(0.0), taller(12.0)], "frame 1: the bed reaches from 12 to .* does not fill the window from 8"),
        ([gas(1), free_gas(WALL, 1, 50, 20.0)], r"frame 1: the axial window .* is longer than the period of 20 m"),
    ],
)
def test_frames_that_do_not_fit_are_named(frames, message):
    with pytest.raises(ValueError, match=message):
        bedrad.statistics(iter(frames))


def test_a_wall_that_was_fitted_to_each_frame_may_differ_a_little():
    frames = [gas(1), free_gas(bedrad.Tube(6.005), 2, 150, LENGTH)]
    assert measure(frames).wall == WALL
    with pytest.raises(ValueError, match="frame 1: the wall is Rod"):
        measure([gas(1), free_gas(bedrad.Rod(6.0), 2, 150, LENGTH)])


def test_what_is_no_packing_is_refused():
    with pytest.raises(TypeError, match=r"frame 1 is a str; expected a bedrad\.Packing"):
        bedrad.statistics([gas(1), "bed.h5"])


def test_a_frame_with_nothing_in_the_window_is_named():
    bed = bedrad.Packing([[4.9, 0, 5.0], [4.9, 0, 20.0]], 1.0, WALL, LENGTH)
    gone = bedrad.Packing([[4.9, 0, 20.0]], 1.0, WALL, LENGTH)
    with pytest.raises(ValueError, match="frame 1: no sphere has its centre"):
        bedrad.statistics([bed, gone], window=Window((4.0, 8.0)))


# ---- the result ----


def test_the_result_is_frozen_and_names_its_structures(three):
    found, _ = three
    assert set(found.structures) == set(MEASURED)
    for name in MEASURED:
        assert np.shape(found.structures[name]) == np.shape(getattr(found, name))
        value = getattr(found, name)
        assert not isinstance(value, np.ndarray) or not value.flags.writeable, name
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.frames = 1


def test_the_result_reads_well(three):
    text = str(three[0])
    assert "mean over 3 frames; at least " in text
    assert "independent structures (" in text
    assert max(len(line) for line in text.splitlines()) < 140
    assert "nothing varies" in str(bedrad.statistics([hexagonal_sheet(4, 4)] * 2, blocks=1))
