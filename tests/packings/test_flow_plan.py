"""The numbers of a flow, and the LAMMPS input that they become."""

from __future__ import annotations

import dataclasses
import math
import re
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

import bedrad
from bedrad.packings.contact import STEPS_PER_CONTACT
from bedrad.packings.flow import plan_flow
from bedrad.packings.flow_plan import JITTER, LATTICE_SPACING, Channel, FlowPlan
from bedrad.packings.flow_planning import LONGEST_WAY
from bedrad.packings.flow_script import NEAR, REFRESH, fill_data, flow_script, restart_every

TUBE = bedrad.Tube(2.4e-3)
D = 6e-4
SIZES = [(6e-4, 0.7), (4e-4, 0.3)]


def planned(**changes: Any) -> FlowPlan:
    arguments: dict[str, Any] = {"diameter": D, "velocity": 0.1} | changes
    return plan_flow(arguments.pop("wall", TUBE), **arguments)


class TestPlan:
    @pytest.mark.parametrize(
        "changes", [{}, {"diameter": None, "sizes": SIZES}, {"channel": Channel(hopper_width=1.0)}]
    )
    def test_the_spheres_start_inside_the_channel_without_touching(self, changes: dict[str, Any]) -> None:
        plan = planned(**changes)
        sites, largest = plan.sites, plan.largest
        assert len(sites) == plan.spheres
        worst = JITTER * largest
        nearest = cKDTree(sites).query(sites, k=2)[0][:, 1].min()
        assert nearest == pytest.approx(LATTICE_SPACING * largest, rel=1e-12)
        room = np.array([plan.radius_at(z) for z in sites[:, 2]]) - np.hypot(sites[:, 0], sites[:, 1])
        assert room.min() >= 0.5 * largest + worst
        assert sites[:, 2].min() - worst > 0.5 * largest
        assert sites[:, 2].max() + worst + 0.5 * largest < plan.box_top

    def test_neighbours_on_the_lattice_cannot_touch_however_they_are_displaced(self) -> None:
        # the worst case is two neighbours that approach along their axis; across it they only move apart
        assert LATTICE_SPACING - 2.0 * JITTER > 1.0

    def test_the_volume_is_that_of_the_channel(self) -> None:
        plan = planned()
        heights = np.linspace(0.0, plan.level, 200_001)
        radii = np.array([plan.radius_at(z) for z in 0.5 * (heights[1:] + heights[:-1])])
        assert plan.volume == pytest.approx(float((math.pi * radii**2 * np.diff(heights)).sum()), rel=1e-6)
        assert plan.spheres == math.ceil(0.6 * plan.volume / (math.pi / 6.0 * D**3))

    def test_frames_lie_the_spacing_apart_after_the_flush(self) -> None:
        plan = planned(frames=5, flush=12.0, spacing=0.5)
        first, second, *_, last = plan.frame_numbers
        assert (second - first) * plan.time_step * 0.1 == pytest.approx(0.5 * D, rel=0.5 / plan.frame_steps)
        assert first - plan.fill_steps == 24 * plan.frame_steps
        assert last == plan.steps
        assert all(step % plan.frame_steps == 0 for step in plan.frame_numbers)

    def test_a_fast_start_takes_longer_to_forget(self) -> None:
        assert planned(velocity=0.02).flush == pytest.approx(20.0, abs=0.5)
        assert planned(velocity=0.2).flush == pytest.approx(20.0 + 6.0 * 0.04 / 9.81 / D)

    def test_flows_of_one_shape_have_one_set_of_dimensionless_numbers(self) -> None:
        first = planned()
        scale, g = 7.0 / 3.0, 1.62
        other = plan_flow(
            bedrad.Tube(TUBE.radius * scale), D * scale, 0.1 * math.sqrt(scale * g / 9.81), density=1300.0, gravity=g
        )
        for name in ("spheres", "frame_steps", "fill_steps", "flush_steps"):
            assert getattr(first, name) == getattr(other, name)

    def test_hertz_contacts_set_their_own_time_step(self) -> None:
        soft, stiff = (planned(youngs_modulus=modulus) for modulus in (1e6, 3.2e7))
        # t ~ E^-2/5
        assert soft.time_step / stiff.time_step == pytest.approx(4.0, rel=1e-9)
        assert "hertz/material 1000000.0 0.85 0.3 tangential mindlin NULL 1.0 0.4" in flow_script(soft)

    def test_it_is_printable(self) -> None:
        text = str(planned(diameter=None, sizes=SIZES))
        assert "0.0004 to 0.0006 m, mean 0.00054 m" in text
        assert "belt over the lowest 3 d at 0.1 m/s" in text
        orifice = str(planned(velocity=None, channel=Channel(orifice=3e-3)))
        assert "Beverloo" in orifice

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"wall": bedrad.Plate()}, "in a Tube only"),
            ({"diameter": 5e-3}, "does not fit into a tube"),
            ({"velocity": -0.1}, "velocity is -0.1; expected a positive"),
            ({"velocity": math.inf}, "velocity is inf"),
            ({"velocity": None}, "neither was given"),
            ({"channel": Channel(orifice=3e-3)}, "both were given"),
            ({"velocity": None, "channel": Channel(orifice=1e-3)}, "more than two of the largest diameters"),
            ({"velocity": None, "channel": Channel(orifice=5e-3)}, "less than the tube's 0.0048 m"),
            (
                {"velocity": None, "wall": bedrad.Tube(6e-3), "channel": Channel(orifice=2e-3, window=(10.0, 27.0))},
                "window ends 27 diameters above a funnel that is 4.81 high",
            ),
            ({"frames": 1}, "frames is 1; expected an integer from 2 to"),
            ({"frames": 2.5}, "frames is 2.5"),
            ({"spacing": 0.0}, "spacing is 0.0"),
            ({"flush": -1.0}, "flush is -1.0"),
            ({"stiffness": 100.0, "youngs_modulus": 1e7}, "both given"),
            ({"poisson_ratio": 0.5}, "poisson_ratio is 0.5"),
            ({"restitution": 1.0}, "restitution is 1.0"),
            ({"sizes": SIZES}, "both given"),
        ],
    )
    def test_what_does_not_fit_is_refused(self, changes: dict[str, Any], message: str) -> None:
        with pytest.raises(ValueError, match=re.escape(message)):
            planned(**changes)

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"window": (10.0, 28.0)}, "window is 10 to 28 diameters above the belt; expected a range within the tube"),
            ({"window": (5.0, 5.0)}, "window is 5 to 5"),
            ({"window": (-1.0, 5.0)}, "window is -1.0"),
            ({"tube_length": 0.0}, "tube_length is 0.0"),
            ({"belt": math.nan}, "belt is nan"),
            ({"hopper_width": 0.9}, "hopper_width is 0.9"),
            ({"hopper_angle": 180.0}, "hopper_angle is 180.0"),
            ({"hopper_level": 0.0}, "hopper_level is 0.0"),
            ({"orifice": 0.0}, "orifice is 0.0"),
        ],
    )
    def test_a_channel_that_cannot_be_is_refused(self, changes: dict[str, Any], message: str) -> None:
        with pytest.raises(ValueError, match=re.escape(message)):
            Channel(**changes)


class TestLimits:
    """What no run can be made of is refused, at once and in little memory."""

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"velocity": 1e300}, "at 1e+300 m/s a sphere goes"),
            ({"velocity": 3.0}, "at 3 m/s a sphere goes"),
            ({"velocity": 1e-300}, "the run takes"),
            ({"velocity": 1e-7}, "the run takes"),
            ({"flush": 1e300}, "the run takes"),
            ({"spacing": 1e-300}, "the run takes"),
            ({"frames": 10**12}, "frames is 1000000000000; expected an integer from 2 to 1000000"),
            ({"stiffness": 1e-12}, "stiffer contacts are shorter"),
            ({"youngs_modulus": 1e300}, "of such magnitude"),
            ({"diameter": 1e-9}, "spheres; expected at most 10000000"),
            ({"channel": Channel(tube_length=1e12)}, "spheres; expected at most 10000000"),
            ({"wall": bedrad.Tube(1e200), "diameter": 1e199}, "of such magnitude"),
            # without a hopper nothing is wide enough for the lattice, however high it grows
            ({"wall": bedrad.Tube(3.3e-4), "channel": Channel(hopper_width=1.0)}, "too narrow to fill"),
        ],
    )
    def test_size_length_and_speed(self, changes: dict[str, Any], message: str) -> None:
        with pytest.raises(ValueError, match=re.escape(message)):
            planned(**changes)

    def test_what_is_near_a_wall_is_looked_for_before_it_gets_there(self) -> None:
        assert LONGEST_WAY / STEPS_PER_CONTACT * REFRESH < NEAR

    def test_frames_that_spheres_pass_unseen_are_refused(self) -> None:
        # the window ends 27 - 22 = 5 diameters below the top, and begins 13 above the foot
        assert planned(spacing=5.0).protocol.spacing == 5.0
        with pytest.raises(ValueError, match=re.escape("spacing is 5.1 diameters, and the window ends 5 from an end")):
            planned(spacing=5.1)
        with pytest.raises(ValueError, match=re.escape("the window ends 3 from an end")):
            planned(spacing=3.1, channel=Channel(window=(0.0, 12.0)))


class TestScript:
    def test_it_fills_flushes_and_samples(self) -> None:
        plan = planned(frames=4)
        script = flow_script(plan)
        stops = [int(text) for text in re.findall(r"^run\s+(\d+) upto", script, re.MULTILINE)]
        assert stops == [plan.fill_steps, plan.fill_steps + plan.flush_steps, plan.steps]
        assert re.findall(r"^variable\s+speed equal (\S+)", script, re.MULTILINE) == ["0.0", "0.1"]
        assert f"dump            frames all custom {plan.frame_steps} frame.*.dump" in script

    def test_a_run_that_goes_on_does_not_do_again_what_is_done(self) -> None:
        plan = planned(frames=4)
        after_fill = flow_script(plan, plan.fill_steps + 7)
        assert f"read_restart    flow.restart.{plan.fill_steps + 7}" in after_fill
        assert "read_data" not in after_fill
        assert "rest.dump" not in after_fill
        last = flow_script(plan, plan.steps - 1)
        assert re.findall(r"^run\s+(\d+) upto", last, re.MULTILINE) == [str(plan.steps)]
        # the walls and the belt are no part of a restart file
        for text in (after_fill, last):
            assert text.count("wall/gran/region") == 3
            assert "variable        speed equal 0.1" in text

    def test_walls_of_the_granular_style_have_their_own_friction(self) -> None:
        script = flow_script(planned(wall_friction=0.15))
        assert len(re.findall(r"wall/gran/region granular .* 0\.15 damping", script)) == 3
        assert re.search(r"pair_style\s+gran/hooke/history .* 0\.4 1", script)

    def test_a_channel_without_hopper_has_one_wall(self) -> None:
        script = flow_script(planned(channel=Channel(hopper_width=1.0)))
        assert script.count("wall/gran/region") == 1
        assert "cone" not in script

    def test_an_orifice_is_closed_while_the_channel_fills(self) -> None:
        script = flow_script(planned(velocity=None, channel=Channel(orifice=3e-3)))
        closed, opened = script.index("region above\n"), script.index("unfix           floor\n")
        assert closed < script.index("write_dump") < opened
        assert "region funnel\n" in script
        assert "addforce" not in script

    def test_restart_files_and_frames_fall_on_one_step(self) -> None:
        plan = planned()
        assert restart_every(plan) % plan.frame_steps == 0
        assert plan.steps / restart_every(plan) >= 20

    def test_the_start_follows_from_the_seed(self) -> None:
        plan = planned(diameter=None, sizes=SIZES)
        assert fill_data(plan, 3) == fill_data(plan, 3)
        assert fill_data(plan, 3) != fill_data(plan, 4)
        rows = [line.split() for line in fill_data(plan, 3).split("Atoms # sphere\n\n")[1].splitlines()]
        sizes = np.array([float(row[2]) for row in rows])
        assert [int((sizes == d).sum()) for d, _ in SIZES] == plan.counts
        # shuffled: the second size is spread over the height as the first is
        heights = np.array([float(row[6]) for row in rows])
        small, error = heights[sizes == 4e-4], heights.std() / math.sqrt(plan.counts[1])
        assert abs(small.mean() - heights.mean()) < 4.0 * error  # false alarm: 1 seed in 16,000

    def test_two_plans_differ_in_their_input(self) -> None:
        plan = planned()
        assert flow_script(dataclasses.replace(plan, velocity=0.11)) != flow_script(plan)
