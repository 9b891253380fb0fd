"""What is measured of a flow, on frames whose flow is known."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import bedrad
from bedrad import EngineFailedError
from bedrad.packings.flow import plan_flow
from bedrad.packings.flow_frames import FlowFrame, Motion, motion_between, read_frame, read_rest
from bedrad.packings.flow_measures import FlowMeasures, measure_flow
from bedrad.packings.flow_plan import FlowPlan
from bedrad.packings.flow_script import COLUMNS, REST_COLUMNS
from bedrad.packings.velocity_profile import VelocityProfile, velocity_profile

FloatArray = NDArray[np.float64]

D = 6e-4
R = 3e-3
LENGTH = 30 * D
U = 0.1
PRESSURE, SHEAR = 90.0, 30.0
PLAN = plan_flow(bedrad.Tube(R), D, U, frames=41, spacing=1.5)
COUNT = 1500


def frames_of(
    speed: Callable[[FloatArray], FloatArray],
    plan: FlowPlan = PLAN,
    drift: float = 0.0,
    seed: int = 0,
    jitter: float = 0.0,
) -> list[FlowFrame]:
    """Spheres at random places that move down at a speed that depends on their distance from the axis, and come back.

    The wall forces of the outermost add up to a known pressure and shear in the mean.
    """
    rng = np.random.default_rng(seed)
    out = R * np.sqrt(rng.random(COUNT))
    turn = 2.0 * math.pi * rng.random(COUNT)
    start = LENGTH * rng.random(COUNT)
    down = speed(out)
    touching = out > R - D / 2
    area = 2.0 * math.pi * R * LENGTH
    frames = []
    for k, step in enumerate(plan.frame_numbers):
        time = (step - plan.frame_numbers[0]) * plan.time_step
        factor = 1.0 + drift * k / len(plan.frame_numbers)
        z = start - down * factor * time
        # what has left below is another sphere when it comes in above
        numbers = np.arange(COUNT) - COUNT * np.floor(z / LENGTH).astype(np.int64)
        order = np.argsort(numbers)
        z = np.mod(z, LENGTH)
        centers = np.stack([out * np.cos(turn), out * np.sin(turn), z], axis=1)
        forces = np.zeros((COUNT, 3))
        inward = np.where(touching, PRESSURE * area / touching.sum(), 0.0)
        forces[:, 0], forces[:, 1] = -inward * np.cos(turn), -inward * np.sin(turn)
        forces[:, 2] = np.where(touching, SHEAR * area / touching.sum(), 0.0)
        velocities = np.zeros((COUNT, 3)) + jitter * rng.standard_normal((COUNT, 3))
        velocities[:, 2] -= down
        columns = (numbers, centers, np.full(COUNT, D / 2), velocities, forces)
        frames.append(FlowFrame(step, *(column[order] for column in columns)))
    return frames


def plug(out: FloatArray) -> FloatArray:
    return np.full_like(out, U)


def measured(frames: list[FlowFrame], plan: FlowPlan = PLAN) -> FlowMeasures:
    return measure_flow(plan, frames, (frames[0].centers, frames[0].radii))


class TestMeasures:
    def test_a_plug_has_one_velocity(self) -> None:
        found = measured(frames_of(plug))
        assert found.velocity == pytest.approx(U, rel=1e-9)
        assert found.velocity_fluctuation < 1e-9 * U
        assert found.profile.core == pytest.approx(U, rel=1e-9)
        assert math.isnan(found.profile.shear_width)
        assert found.granular_temperature == pytest.approx(0.0, abs=1e-12)
        assert found.problems == ()

    def test_stresses_and_solid_fraction_are_those_of_the_spheres(self) -> None:
        found = measured(frames_of(plug))
        for value, error, true in (
            (found.wall_pressure, found.wall_pressure_error, PRESSURE),
            (found.wall_shear, found.wall_shear_error, SHEAR),
            (found.solid_fraction, found.solid_fraction_error, COUNT * math.pi / 6 * D**3 / (math.pi * R**2 * LENGTH)),
        ):
            assert abs(value - true) < 4.5 * error  # the stated errors are at worst 10 % short: 1 in 50,000
            assert error < 0.2 * true
        assert found.friction_mobilised == pytest.approx(SHEAR / PRESSURE, rel=1e-9)
        assert found.discharge == pytest.approx(found.solid_fraction * 3800.0 * U * math.pi * R**2, rel=1e-9)
        bulk = found.solid_fraction * 3800.0
        assert found.janssen_pressure == pytest.approx(bulk * 9.81 * 2 * R / (4 * 0.4), rel=1e-12)
        low, high = PLAN.window
        assert found.independent_structures == pytest.approx(1.0 + 40 * 1.5 * D / (high - low), rel=0.01)

    def test_agitation_is_the_mean_square_of_a_component(self) -> None:
        found = measured(frames_of(plug, jitter=0.02))
        # a chi-square of some 3 x 600 x 41 numbers: one part in 190
        assert found.granular_temperature == pytest.approx(0.02**2 / (9.81 * D), rel=5 * math.sqrt(2 / (3 * 600 * 41)))

    def test_a_jammed_flow_is_told(self) -> None:
        found = measured(frames_of(lambda out: np.full_like(out, 0.05 * U)))
        assert [p.split(":")[0] for p in found.problems] == ["jammed", "short of independent structures"]

    def test_a_thinned_flow_is_told(self) -> None:
        frames = frames_of(plug)
        rest = np.concatenate([frames[0].centers, frames[5].centers])
        found = measure_flow(PLAN, frames, (rest, np.full(len(rest), D / 2)))
        assert [p.split(":")[0] for p in found.problems] == ["thinned"]

    def test_a_drift_is_told_and_a_steady_flow_is_not(self) -> None:
        def alone(frames: list[FlowFrame]) -> list[str]:
            return [p for p in measured(frames).problems if "velocity drifts" in p]

        assert alone(frames_of(plug, drift=0.1))
        assert not any(alone(frames_of(plug, seed=seed)) for seed in range(10))

    def test_few_windows_of_bed_are_told(self) -> None:
        plan = dataclasses.replace(PLAN, protocol=dataclasses.replace(PLAN.protocol, frames=10))
        found = measured(frames_of(plug, plan), plan)
        assert [p.split(":")[0] for p in found.problems] == ["short of independent structures"]


class TestProfile:
    def profile(self, speed: Callable[[FloatArray], FloatArray]) -> VelocityProfile:
        # a sphere in the middle of every bin but the outermost; the first of them touches the wall
        out = R - (np.arange(9) + 1.0) * D / 2
        places = np.stack([out, np.zeros(9), np.full(9, 5e-3)], axis=1)
        return velocity_profile([Motion(places, speed(out))] * 3, (0.0, 1e-2), R, D)

    def test_a_gaussian_layer_at_the_wall_is_found(self) -> None:
        found = self.profile(lambda r: 0.1 - 0.03 * np.exp(-(((r - R) / (1.2 * D)) ** 2)))
        gaussian = found.gaussian
        assert gaussian.residual < 1e-6
        assert (gaussian.amplitude, gaussian.center, gaussian.width, gaussian.offset) == pytest.approx(
            (-0.03, R, 1.2 * D, 0.1), rel=1e-4
        )

    def test_a_gaussian_hump_about_the_axis_is_found(self) -> None:
        gaussian = self.profile(lambda r: 0.02 + 0.08 * np.exp(-((r / (0.6 * R)) ** 2))).gaussian
        assert gaussian.residual < 1e-6
        assert (gaussian.amplitude, gaussian.width, gaussian.offset) == pytest.approx((0.08, 0.6 * R, 0.02), rel=1e-4)

    def test_the_shear_layer_ends_where_nine_tenths_are_made_up(self) -> None:
        # a ramp up to a plug that ends in the middle of a bin
        found = self.profile(lambda r: np.minimum(0.1, 0.04 + 0.06 * (R - r) / (2.5 * D)))
        wall = 0.04 + 0.06 / 5
        assert found.wall == pytest.approx(wall, rel=1e-12)
        assert found.core == pytest.approx(0.1, rel=1e-12)
        end = 0.1 - 0.1 * (0.1 - wall)
        assert found.shear_width == pytest.approx((end - 0.04) / 0.06 * 2.5 * D, rel=1e-9)

    @pytest.mark.parametrize("pressed", [1e-6, 1e-4, 1e-2])
    def test_the_wall_speed_is_that_of_all_spheres_beside_it_whatever_the_springs(self, pressed: float) -> None:
        # half of the outermost spheres hang back and are pressed into the wall, half are off it by as much
        out = R - D / 2 + pressed * D * np.array([1.0, -1.0, 1.0, -1.0])
        places = np.stack([out, np.zeros(4), np.full(4, 5e-3)], axis=1)
        speeds = np.array([0.04, 0.08, 0.06, 0.10])
        found = velocity_profile([Motion(places, speeds)] * 3, (0.0, 1e-2), R, D)
        assert found.wall == pytest.approx(0.07, rel=1e-12)
        assert found.speeds[-2] == pytest.approx(0.07, rel=1e-12)
        assert np.isnan(found.speeds[-1])

    def test_small_spheres_of_a_mixture_are_beside_the_wall_too(self) -> None:
        places = np.array([[R - D / 2, 0.0, 5e-3], [R - 0.1 * D, 0.0, 5e-3], [R - 1.2 * D, 0.0, 5e-3]])
        found = velocity_profile([Motion(places, np.array([0.08, 0.05, 0.1]))] * 3, (0.0, 1e-2), R, D)
        assert found.speeds[-2:] == pytest.approx([0.08, 0.05], rel=1e-12)
        assert found.wall == pytest.approx(0.065, rel=1e-12)

    @pytest.mark.parametrize("seed", range(3))
    def test_a_linear_profile_is_read_at_the_places_of_the_spheres(self, seed: int) -> None:
        # spheres anywhere in the bins, and unevenly: the mean speed at the mean place stays on the line
        out = R - np.append(0.5 * D, np.random.default_rng(seed).uniform(D, R, 40))
        places = np.stack([out, np.zeros(len(out)), np.full(len(out), 5e-3)], axis=1)
        speeds = 0.05 + 0.04 * (R - out) / D
        found = velocity_profile([Motion(places, speeds)] * 3, (0.0, 1e-2), R, D)
        short = found.core - 0.1 * (found.core - found.wall)
        assert found.wall == pytest.approx(0.07, rel=1e-12)
        assert 0.5 * D < found.shear_width < R
        assert found.shear_width == pytest.approx((short - 0.05) / 0.04 * D, rel=1e-9)

    def test_errors_of_the_bins_are_right(self) -> None:
        # independent motions with a known scatter of one sphere a bin; the scatter of many estimates is the error
        out = R - (np.arange(9) + 1.0) * D / 2
        places = np.stack([out, np.zeros(9), np.full(9, 5e-3)], axis=1)
        rng = np.random.default_rng(5)
        stated, means = [], []
        for _ in range(100):
            motions = [Motion(places, 0.1 + 0.01 * rng.standard_normal(9)) for _ in range(64)]
            found = velocity_profile(motions, (0.0, 1e-2), R, D)
            stated.append(found.speeds_error[1:-1])
            means.append(found.speeds[1:-1])
        true = 0.01 / math.sqrt(64)
        assert np.std(means) == pytest.approx(true, rel=5 / math.sqrt(2 * 900))
        # single errors scatter, as block averages take the larger length now and then; their mean square is right: over
        # 40 seeds its root was 1.000 of the truth and scattered by 0.012, so that this is five standard errors
        assert math.sqrt(np.mean(np.square(stated))) == pytest.approx(true, rel=0.06)

    def test_bins_without_spheres_have_no_speed(self) -> None:
        places = np.array([[R - 0.5 * D, 0.0, 5e-3], [R - 0.6 * D, 0.0, 2e-2]])
        found = velocity_profile([Motion(places, np.array([0.1, 9.0]))] * 2, (0.0, 1e-2), R, D)
        assert np.flatnonzero(~np.isnan(found.speeds)).tolist() == [len(found.speeds) - 2]
        assert found.speeds[-2] == 0.1
        assert math.isnan(found.gaussian.amplitude)


class TestFrames:
    def text(self, rows: str, count: int | None = None, columns: str = COLUMNS) -> str:
        number = len(rows.splitlines()) if count is None else count
        box = "-1 1\n-1 1\n0 1\n"
        head = f"ITEM: TIMESTEP\n70\nITEM: NUMBER OF ATOMS\n{number}\nITEM: BOX BOUNDS ff ff pp\n{box}"
        return f"{head}ITEM: ATOMS {columns}\n{rows}"

    ROWS = "2 .1 .2 .3 .01 1 2 3 4 5 6\n5 .4 .5 .6 .01 7 8 9 10 11 12\n"

    def test_a_frame_is_read(self, tmp_path: Path) -> None:
        path = tmp_path / "frame.70.dump"
        path.write_text(self.text(self.ROWS))
        frame = read_frame(path)
        assert frame.step == 70
        assert frame.numbers.tolist() == [2, 5]
        assert frame.centers.tolist() == [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]
        assert frame.velocities[1].tolist() == [7.0, 8.0, 9.0]
        assert frame.wall_forces[1].tolist() == [10.0, 11.0, 12.0]

    @pytest.mark.parametrize(
        "broken",
        [
            lambda self: self.text(self.ROWS, count=3),
            lambda self: self.text(self.ROWS[:40]),
            # what is left of the last number, 12, is a number
            lambda self: self.text(self.ROWS[:-2]),
            lambda self: self.text(self.ROWS, columns="id x y z"),
            lambda self: self.text(self.ROWS.replace("7", "seven")),
            lambda self: "ITEM: TIMESTEP\n",
            lambda self: "",
        ],
    )
    def test_a_broken_frame_is_named(self, tmp_path: Path, broken: Callable[[TestFrames], str]) -> None:
        path = tmp_path / "frame.70.dump"
        path.write_text(broken(self))
        with pytest.raises(EngineFailedError, match=r"no whole frame in frame\.70\.dump"):
            read_frame(path)

    def test_spheres_at_rest_are_read_and_missing_ones_told(self, tmp_path: Path) -> None:
        path = tmp_path / "rest.dump"
        rows = "1 .1 .2 .3 .01\n2 .4 .5 .6 .02\n"
        path.write_text(self.text(rows, columns=REST_COLUMNS))
        centers, radii = read_rest(path)
        assert centers.tolist() == [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]
        assert radii.tolist() == [0.01, 0.02]
        path.write_text(self.text(rows, count=3, columns=REST_COLUMNS))
        with pytest.raises(EngineFailedError, match=r"rest\.dump: 2 rows; 3 whole ones were announced"):
            read_rest(path)

    def test_a_missing_frame_is_named(self, tmp_path: Path) -> None:
        with pytest.raises(EngineFailedError, match=r"no whole frame in frame\.9\.dump"):
            read_frame(tmp_path / "frame.9.dump")

    def test_motion_is_of_the_spheres_that_both_frames_hold(self) -> None:
        zeros = np.zeros((3, 3))
        first = FlowFrame(
            0, np.array([1, 4, 7]), np.array([[0, 0, 3.0], [1, 0, 3.0], [2, 0, 3.0]]), np.ones(3), zeros, zeros
        )
        second = FlowFrame(
            10, np.array([4, 7, 9]), np.array([[1, 0, 2.0], [2, 2, 2.5], [0, 0, 0]]), np.ones(3), zeros, zeros
        )
        motion = motion_between(first, second, 0.01)
        assert motion.speeds.tolist() == pytest.approx([10.0, 5.0])
        assert motion.places.tolist() == [[1.0, 0.0, 2.5], [2.0, 1.0, 2.75]]
