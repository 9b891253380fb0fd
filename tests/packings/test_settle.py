"""Settled beds: the contacts that were asked for, weight on the floor, the same bed for the same seed, failures."""

from __future__ import annotations

import dataclasses
import math
import os
import re
import signal
import tempfile
from pathlib import Path

import numpy as np
import pytest

import bedrad
from bedrad import EngineFailedError, Packing, Plate, Rod, Tube
from bedrad.packings import settle as settle_module
from bedrad.packings.contact import STEPS_PER_CONTACT
from bedrad.packings.grains import Grains
from bedrad.packings.lammps import run_lammps
from bedrad.packings.pouring import Column
from bedrad.packings.settle import AT_REST, plan_settle, settle, settle_script
from bedrad.packings.settle_plan import DATA, SettlePlan, plan_settling

D = 6e-4
TUBE = Tube(1.5e-3)
HEIGHT = 5e-3
GRAINS = Grains(3800.0, 0.4, None, 0.85, None, 9.81)


@pytest.fixture(autouse=True)
def temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of its own for temporary files, to see that nothing stays in it."""
    folder = tmp_path / "tmp"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture(scope="module")
def bed() -> Packing:
    return settle(TUBE, D, HEIGHT, seed=3)


def planned(grains: Grains = GRAINS, tube: Tube = TUBE, diameters: tuple[float, ...] = (D,)) -> SettlePlan:
    centers = np.array([[0.0, 0.0, 0.01 + 2 * D * i] for i in range(len(diameters))])
    return plan_settling(tube, Column(centers, np.array(diameters), 0.02), grains)


def number(script: str, pattern: str) -> float:
    (found,) = re.findall(pattern + r"\s+([\d.e+-]+)", script)
    return float(found)


class TestScript:
    def test_it_holds_the_numbers_of_the_plan(self) -> None:
        plan = planned()
        script = settle_script(plan)
        assert number(script, "timestep") == plan.time_step == plan.contact_duration / STEPS_PER_CONTACT
        assert number(script, "gravity all gravity") == 9.81
        assert number(script, "cylinder z 0 0") == TUBE.radius
        assert number(script, r"average all ave/time \d+ \d+ \d+ v_moving\nvariable .*\nfix .* v_rest <") == AT_REST
        kn, kt, rate, tangential_rate, friction, flag = re.findall(r"pair_style\s+gran/hooke/history (.*)", script)[
            0
        ].split()
        assert (float(kn), float(kt)) == (plan.stiffness, pytest.approx(2 / 7 * plan.stiffness, rel=1e-15))
        assert float(tangential_rate) == float(rate) / 2
        assert (float(friction), flag) == (0.4, "1")
        # the damped half period of the spring and the rate belong together: exp(-rate t / 2) is the restitution
        assert math.exp(-float(rate) * plan.contact_duration / 2) == pytest.approx(0.85, rel=1e-12)

    def test_the_wall_has_the_same_springs_and_its_own_friction(self) -> None:
        script = settle_script(planned(dataclasses.replace(GRAINS, wall_friction=0.1)))
        pair = re.findall(r"pair_style\s+gran/hooke/history (.*)", script)[0].split()
        (words,) = re.findall(r"wall/gran/region granular (.*) region", script)
        kn, e, kt, share, friction = re.fullmatch(
            r"hooke (\S+) (\S+) tangential linear_history (\S+) (\S+) (\S+) damping coeff_restitution", words
        ).groups()  # type: ignore[union-attr]
        assert (kn, kt) == (pair[0], pair[1])
        assert (float(e), float(share), float(friction), float(pair[4])) == (0.85, 0.5, 0.1, 0.4)

    def test_a_mixture_takes_its_damping_from_the_restitution(self) -> None:
        script = settle_script(planned(diameters=(D, D / 2)))
        assert "pair_style      granular\n" in script
        assert len(re.findall(r" 0\.85 tangential .* damping coeff_restitution", script)) == 2

    def test_the_smallest_spheres_set_the_time_step_the_largest_the_stiffness(self) -> None:
        both, small, large = (planned(diameters=sizes) for sizes in ((D, D / 2), (D / 2,), (D,)))
        assert both.stiffness == pytest.approx(large.stiffness, rel=1e-12)
        ratio = both.contact_duration / small.contact_duration
        assert ratio == pytest.approx(math.sqrt(small.stiffness / both.stiffness), rel=1e-12)

    @pytest.mark.parametrize("stiffness", [None, 3.0, 1e5])
    def test_steps_are_whole_checks(self, stiffness: float | None) -> None:
        plan = planned(dataclasses.replace(GRAINS, stiffness=stiffness))
        assert plan.check_every % 10 == 0
        assert plan.fall_steps % plan.check_every == plan.settle_steps % plan.check_every == 0
        assert plan.fall_steps * plan.time_step >= plan.fall_time
        assert (plan.fall_steps + plan.settle_steps) * plan.time_step >= plan.time_limit

    def test_beds_of_one_shape_have_one_set_of_dimensionless_numbers(self) -> None:
        # lengths, density and gravity change; what the steps see does not
        first = plan_settle(TUBE, D, HEIGHT)
        other = plan_settle(Tube(3.5e-3), D * 7 / 3, HEIGHT * 7 / 3, density=1300.0, gravity=1.62)
        for name in ("spheres", "check_every", "fall_steps", "settle_steps"):
            assert getattr(first, name) == getattr(other, name)
        for plan in (first, other):
            weight = plan.density * math.pi / 6 * plan.mean**3 * plan.gravity
            assert plan.energy_unit == pytest.approx(plan.spheres * weight * plan.mean, rel=1e-12)
        ratio = [p.time_step * math.sqrt(p.gravity / p.mean) for p in (first, other)]
        assert ratio[0] == pytest.approx(ratio[1], rel=1e-12)

    def test_it_is_printable(self) -> None:
        text = str(plan_settle(TUBE, None, HEIGHT, sizes=[(D, 0.5), (D / 2, 0.5)]))
        assert "0.0003 to 0.0006 m, 0.00045 m in the mean" in text
        assert "time step" in text


def launched(
    folder: Path,
    plan: SettlePlan,
    column: Column,
    velocities: list[str],
    steps: int,
    fine: int = 1,
    changes: tuple[tuple[str, str], ...] = (),
) -> np.ndarray:
    """Velocities and spins after some steps of a few spheres under the contacts and walls of the script itself."""
    script = settle_script(plan)
    script = script[: script.index("compute  ")]
    script = re.sub(r"timestep .*", f"timestep        {plan.time_step / fine!r}", script)
    for old, new in changes:
        assert script.count(old) == 1
        script = script.replace(old, new)
    sets = [f"set atom {i} {text}" for i, text in enumerate(velocities, start=1)]
    columns = "id vx vy vz omegax omegay omegaz"
    end = [f"run {steps * fine}", f"write_dump all custom end.dump {columns} modify sort id format float %.17g"]
    (folder / DATA).write_text(column.data_file(plan.density, 5 * D))
    run_lammps(script + "\n".join([*sets, *end]) + "\n", folder)
    rows = (folder / "end.dump").read_text().splitlines()[9:]
    return np.array([[float(word) for word in row.split()[1:]] for row in rows])


@pytest.mark.dem
class TestContactsInLammps:
    """Collisions with the commands that the script generator wrote."""

    SPEED = 0.05

    @pytest.mark.parametrize("restitution", [0.85, 0.4])
    @pytest.mark.parametrize("sizes", [(D, D), (D, D / 2)], ids=["equal", "unlike"])
    @pytest.mark.parametrize(("fine", "off"), [(1, 0.03), (20, 0.003)])
    def test_two_spheres(
        self, tmp_path: Path, restitution: float, sizes: tuple[float, float], fine: int, off: float
    ) -> None:
        grains = dataclasses.replace(GRAINS, restitution=restitution, stiffness=100.0, gravity=1e-15)
        apart = 0.51 * (sizes[0] + sizes[1])
        column = Column(np.array([[0.0, 0.0, 0.01], [0.0, 0.0, 0.01 + apart]]), np.array(sizes), 0.02)
        plan = plan_settling(TUBE, column, grains)
        ends = launched(tmp_path, plan, column, [f"vz {self.SPEED}", f"vz {-self.SPEED}"], 10 * STEPS_PER_CONTACT, fine)
        assert (ends[1, 2] - ends[0, 2]) / (2 * self.SPEED) == pytest.approx(restitution, abs=off)
        masses = np.array(sizes) ** 3
        momentum = masses @ ends[:, 2]
        assert momentum == pytest.approx(self.SPEED * (masses[0] - masses[1]), abs=1e-12 * self.SPEED * masses[0])

    @pytest.mark.parametrize("where", ["floor", "mantle"])
    @pytest.mark.parametrize(("fine", "off"), [(1, 0.02), (20, 0.002)])
    def test_sphere_and_wall(self, tmp_path: Path, where: str, fine: int, off: float) -> None:
        grains = dataclasses.replace(GRAINS, stiffness=100.0, gravity=1e-15)
        gap = 0.51 * D
        center = [0.0, 0.0, gap] if where == "floor" else [TUBE.radius - gap, 0.0, 0.01]
        column = Column(np.array([center]), np.array([D]), 0.02)
        plan = plan_settling(TUBE, column, grains)
        start = f"vz {-self.SPEED}" if where == "floor" else f"vx {self.SPEED}"
        (end,) = launched(tmp_path, plan, column, [start], 10 * STEPS_PER_CONTACT, fine)
        back = end[2] if where == "floor" else -end[0]
        assert back / self.SPEED == pytest.approx(0.85, abs=off)

    @pytest.mark.parametrize("where", ["floor", "mantle"])
    @pytest.mark.parametrize("speed", [0.02, 0.2], ids=["steep", "grazing"])
    def test_a_sliding_impact_loses_friction_times_the_normal_impulse(
        self, tmp_path: Path, where: str, speed: float
    ) -> None:
        friction = 0.05
        grains = dataclasses.replace(GRAINS, wall_friction=friction, stiffness=100.0, gravity=1e-15)
        center = [0.0, 0.0, 0.51 * D] if where == "floor" else [TUBE.radius - 0.51 * D, 0.0, 0.01]
        column = Column(np.array([center]), np.array([D]), 0.02)
        plan = plan_settling(TUBE, column, grains)
        start = f"vx {speed} vz {-self.SPEED}" if where == "floor" else f"vx {self.SPEED} vz {speed}"
        (end,) = launched(tmp_path, plan, column, [start], 10 * STEPS_PER_CONTACT, fine=10)
        along, around = (end[0], end[4]) if where == "floor" else (end[2], end[4])
        # rigid sphere: the surface slides from the first moment to the last
        lost = friction * (1 + 0.85) * self.SPEED
        assert 3.5 * lost < speed
        assert speed - along == pytest.approx(lost, rel=0.02)
        assert abs(around) * D / 2 == pytest.approx(2.5 * lost, rel=0.02)

    @pytest.mark.parametrize("friction", [0.1, 0.4, 1.0])
    @pytest.mark.parametrize("angle", [20, 50, 76, 85])
    def test_no_impact_on_the_wall_gains_energy(self, tmp_path: Path, friction: float, angle: float) -> None:
        grains = dataclasses.replace(GRAINS, wall_friction=friction, stiffness=100.0, gravity=1e-15)
        column = Column(np.array([[0.0, 0.0, 0.51 * D]]), np.array([D]), 0.02)
        plan = plan_settling(TUBE, column, grains)
        along = self.SPEED * math.tan(math.radians(angle))
        (end,) = launched(tmp_path, plan, column, [f"vx {along} vz {-self.SPEED}"], 10 * STEPS_PER_CONTACT)
        before = self.SPEED**2 + along**2
        after = (end[:3] ** 2).sum() + 0.4 * (D / 2) ** 2 * (end[3:] ** 2).sum()
        assert after < before

    @pytest.mark.parametrize("kind", ["mantle", "pair", "mantle of a mixture", "pair of a mixture"])
    def test_friction_holds_a_sphere_that_cannot_roll(self, tmp_path: Path, kind: str) -> None:
        # a load of 0.2 of the normal force against a friction of 0.4: without tangential springs it would creep at
        # the speed load / (rate m), 2 mm/s
        sizes = (D, D / 2) if "mixture" in kind else (D, D)
        grains = dataclasses.replace(GRAINS, stiffness=100.0)
        if kind.startswith("mantle"):
            centers = [[TUBE.radius - 0.49999 * D, 0.0, 0.01], [0.0, 0.0, 0.015]]
            held, pull = 0, "vector 1 0 -0.2"
        else:
            centers = [[0.0, 0.0, 0.01], [0.0, 0.0, 0.01 + 0.49999 * sum(sizes)]]
            held, pull = 1, "vector 0.2 0 -1"
        column = Column(np.array(centers), np.array(sizes), 0.02)
        changes = (
            ("all nve/sphere", "moving nve"),
            ("vector 0 0 -1", pull),
            ("fix             motion", f"group           moving id {held + 1}\nfix             motion"),
        )
        plan = plan_settling(TUBE, column, grains)
        ends = launched(tmp_path, plan, column, [], 600 * STEPS_PER_CONTACT, changes=changes)
        assert np.abs(ends[held, :3]).max() < 2e-5

    def test_a_sliding_sphere_ends_up_rolling_at_five_sevenths(self, tmp_path: Path) -> None:
        grains = dataclasses.replace(GRAINS, friction=0.0, wall_friction=0.4, stiffness=100.0)
        weight = 3800 * math.pi / 6 * D**3 * 9.81
        column = Column(np.array([[0.0, 0.0, D / 2 - weight / 100.0]]), np.array([D]), 0.02)
        plan = plan_settling(TUBE, column, grains)
        speed = 0.01
        until_rolling = 2 * speed / (7 * 0.4 * 9.81)
        steps = round(3 * until_rolling / plan.time_step)
        half = round(0.5 * until_rolling / plan.time_step)
        (sliding,) = launched(tmp_path, plan, column, [f"vx {speed}"], half)
        assert sliding[0] == pytest.approx(speed - 0.4 * 9.81 * half * plan.time_step, rel=0.02)
        (rolling,) = launched(tmp_path, plan, column, [f"vx {speed}"], steps)
        assert rolling[0] == pytest.approx(5 / 7 * speed, rel=0.01)


def forces(bed: Packing) -> tuple[float, float, float]:
    """Weight, and the normal forces on floor and mantle from the overlaps. [N]"""
    c, r, stiffness = bed.centers, bed.radii, float(bed.provenance["normal_stiffness_N_per_m"])
    weight = 3800 * 9.81 * 4 / 3 * math.pi * (r**3).sum()
    floor = stiffness * np.maximum(r - c[:, 2], 0).sum()
    mantle = stiffness * np.maximum(np.hypot(c[:, 0], c[:, 1]) + r - TUBE.radius, 0).sum()
    return float(weight), float(floor), float(mantle)


@pytest.mark.dem
class TestBeds:
    def test_the_bed_is_at_rest_tall_enough_and_well_described(self, bed: Packing) -> None:
        facts = dict(bed.provenance)
        assert (bed.wall, bed.period, len(bed)) == (TUBE, None, facts["spheres"])
        assert set(bed.radii) == {D / 2}
        assert 0 <= facts["kinetic_energy_mgd"] < AT_REST  # type: ignore[operator]
        assert facts["height_m"] >= HEIGHT  # type: ignore[operator]
        assert facts["height_m"] == pytest.approx(2 * bed.centers[:, 2].mean(), rel=1e-12)
        assert facts["time_step_s"] * STEPS_PER_CONTACT == pytest.approx(facts["contact_duration_s"], rel=1e-12)  # type: ignore[operator]
        expected = {"engine": "LAMMPS", "seed": 3, "friction": 0.4, "wall_friction": 0.4, "restitution": 0.85}
        assert {key: facts[key] for key in expected} == expected
        assert re.fullmatch(r"[0-9a-f]{64}", str(facts["input_sha256"]))
        assert all(isinstance(value, (str, int, float)) for value in facts.values())

    def test_overlaps_are_those_of_the_positions(self, bed: Packing) -> None:
        c, facts = bed.centers, bed.provenance
        apart = np.linalg.norm(c[:, None] - c[None], axis=-1)
        between = (D - apart)[np.triu_indices(len(c), 1)]
        assert facts["largest_pair_overlap_d"] == pytest.approx(between.max() / D, rel=1e-9)
        assert facts["mean_pair_overlap_d"] == pytest.approx(between[between > 0].mean() / D, rel=1e-9)
        beyond = np.hypot(c[:, 0], c[:, 1]) + D / 2 - TUBE.radius
        assert facts["largest_wall_overlap_d"] == pytest.approx(beyond.max() / D, rel=1e-9)
        assert facts["mean_wall_overlap_d"] == pytest.approx(beyond[beyond > 0].mean() / D, rel=1e-9)
        assert 0 < facts["largest_pair_overlap_d"] < 0.02  # type: ignore[operator]

    def test_the_wall_carries_no_more_than_its_friction(self, bed: Packing) -> None:
        # vertical balance: weight = floor + wall friction, at most 0.4 of the normal forces on the wall (Coulomb);
        # it may also point down, where the bed sprang back after the fall
        weight, floor, wall = forces(bed)
        assert abs(weight - floor) <= 0.4 * wall

    def test_a_smooth_wall_leaves_all_the_weight_on_the_floor(self) -> None:
        # what is left of the motion, 1e-6 m g d a sphere, shakes the floor by a percent or so
        weight, floor, wall = forces(settle(TUBE, D, HEIGHT, wall_friction=0.0, seed=2))
        assert floor == pytest.approx(weight, rel=0.03)
        assert wall > 0.5 * weight

    def test_same_seed_same_bed_to_the_last_bit(self, bed: Packing) -> None:
        again = settle(TUBE, D, HEIGHT, seed=3)
        assert again.centers.tobytes() == bed.centers.tobytes()
        assert again.provenance["input_sha256"] == bed.provenance["input_sha256"]
        other = settle(TUBE, D, HEIGHT, seed=4)
        assert not np.array_equal(other.centers, bed.centers)

    def test_density_and_gravity_change_nothing_but_the_clock(self, bed: Packing) -> None:
        # powers of four scale all forces and times without a rounding
        heavy = settle(TUBE, D, HEIGHT, seed=3, density=4 * 3800.0, gravity=4 * 9.81)
        assert heavy.centers.tobytes() == bed.centers.tobytes()
        assert heavy.provenance["time_step_s"] == float(bed.provenance["time_step_s"]) / 2

    def test_a_mixture_keeps_its_sizes(self, temporary_folder: Path) -> None:
        sizes = [(D, 0.5), (0.75 * D, 0.5)]
        mixed = settle(TUBE, None, 3e-3, seed=1, sizes=sizes)
        values, counts = np.unique(mixed.radii, return_counts=True)
        assert values.tolist() == [0.375 * D, D / 2]
        assert abs(counts[0] - counts[1]) <= 1
        assert mixed.provenance["sizes"] == f"{D!r} m: 0.5; {0.75 * D!r} m: 0.5"
        assert float(mixed.provenance["kinetic_energy_mgd"]) < AT_REST
        assert list(temporary_folder.iterdir()) == []

    def test_two_ranks_settle_too(self) -> None:
        assert float(settle(TUBE, D, 2e-3, ranks=2).provenance["kinetic_energy_mgd"]) < AT_REST

    def test_progress_rises_to_one_and_nothing_stays(self, temporary_folder: Path) -> None:
        seen: list[tuple[float, str]] = []
        settle(TUBE, D, 2e-3, progress=lambda share, text: seen.append((share, text)))
        shares = [share for share, _ in seen]
        assert shares == sorted(shares)
        assert 0 <= shares[0] < 0.3
        assert shares[-1] == 1.0
        assert seen[0][1] == "falling"
        assert seen[-1][1].startswith("at rest")
        assert list(temporary_folder.iterdir()) == []

    def test_a_work_folder_is_kept(self, tmp_path: Path) -> None:
        packing = settle(TUBE, D, 2e-3, work_dir=tmp_path / "run")
        assert {"in.lammps", "column.data", "log.lammps", "settled.dump"} <= {
            p.name for p in (tmp_path / "run").iterdir()
        }
        assert bedrad.read(tmp_path / "run" / "settled.dump", TUBE).centers.tobytes() == packing.centers.tobytes()

    def test_a_bed_that_moves_is_a_failure(self, temporary_folder: Path) -> None:
        with pytest.raises(
            EngineFailedError, match=r"not at rest after 0\.0\d+ s.*kinetic energy is \S+ m g d a sphere"
        ):
            settle(TUBE, D, 2e-3, time_limit=1e-3)
        assert list(temporary_folder.iterdir()) == []

    def test_overlaps_beyond_the_limit_are_a_failure(self) -> None:
        with pytest.raises(EngineFailedError, match=r"no valid packing: .*; a larger stiffness than .* N/m"):
            settle(TUBE, D, 2e-3, max_overlap=1e-5)

    def test_a_bed_lower_than_asked_for_is_said(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(settle_module, "SOLID_FRACTION", 0.4)
        with pytest.warns(UserWarning, match=r"the bed is 0\.001\d* m tall, lower than the 0\.002 m asked for"):
            settle(TUBE, D, 2e-3)


class TestRefusals:
    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ({"wall": Rod(1e-3)}, r"wall is Rod\(.*; spheres are settled in a Tube only"),
            ({"wall": Plate()}, "wall is Plate"),
            ({"diameter": 4e-3}, r"a sphere of 0\.004 m does not fit into a tube of 0\.003 m diameter"),
            ({"diameter": -D}, r"diameter is -0\.0006; expected a positive number"),
            ({"diameter": math.nan}, "diameter is nan; expected a positive number"),
            ({"diameter": D, "sizes": [(D, 1.0)]}, "diameter .* and sizes were both given"),
            ({"sizes": [(D, 0.5), (D / 2, 0.4)]}, r"the number fractions add up to 0\.9; expected 1"),
            ({"sizes": [(D, 0.5), (D, 0.5)]}, "a diameter comes twice"),
            ({"sizes": [(D, 1.5), (D / 2, -0.5)]}, r"sizes: number fraction is -0\.5"),
            ({"sizes": [(0.0, 1.0)]}, r"sizes: diameter is 0\.0"),
            ({"sizes": []}, "the number fractions add up to 0"),
            ({"height": 0.0}, r"height is 0\.0; expected a positive number"),
            ({"height": math.inf}, "height is inf; expected"),
            ({"seed": -1}, "seed is -1; expected an integer that is not negative"),
            ({"seed": 1.5}, r"seed is 1\.5; expected an integer"),
            ({"density": 0.0}, r"density is 0\.0; expected a positive number"),
            ({"gravity": -9.81}, r"gravity is -9\.81; expected a positive number"),
            ({"friction": -0.1}, r"friction is -0\.1; expected a number from 0 to 10000"),
            ({"wall_friction": math.nan}, "wall_friction is nan; expected"),
            ({"restitution": 1.0}, r"restitution is 1\.0; expected a number between 0 and 1"),
            ({"restitution": 0.0}, r"restitution is 0\.0"),
            ({"stiffness": 0.0}, r"stiffness is 0\.0; expected a positive number"),
            ({"time_limit": 0.0}, r"time_limit is 0\.0; expected a positive number of seconds"),
        ],
    )
    def test_arguments(self, arguments: dict[str, object], message: str) -> None:
        given = {"wall": TUBE, "height": 2e-3} | arguments
        for function in (settle, plan_settle):
            with pytest.raises(ValueError, match=message):
                function(**given)  # type: ignore[operator]


def fake(folder: Path, body: str) -> Path:
    path = folder / "fake-lmp"
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o755)
    return path


class TestEngineFailures:
    def test_the_log_is_quoted_and_nothing_stays(self, tmp_path: Path, temporary_folder: Path) -> None:
        body = "echo 'ERROR: Lost atoms: original 5 current 4' > log.lammps; exit 1"
        with pytest.raises(EngineFailedError, match=r"exit code 1[\s\S]*ERROR: Lost atoms: original 5 current 4"):
            settle(TUBE, D, 2e-3, executable=fake(tmp_path, body))
        assert list(temporary_folder.iterdir()) == []

    def test_spheres_that_vanished(self, tmp_path: Path) -> None:
        dump = "ITEM: TIMESTEP\n9\nITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS id x y z radius\n1 0 0 0.0003 0.0003\n"
        log = "Step v_moving v_spinning v_rest\n9 0 0 0\n"
        body = f"cat > settled.dump <<'END'\n{dump}END\ncat > log.lammps <<'END'\n{log}END\n"
        with pytest.raises(EngineFailedError, match=r"LAMMPS left 1 of \d\d spheres in settled\.dump"):
            settle(TUBE, D, 2e-3, executable=fake(tmp_path, body))

    def test_a_sphere_through_the_floor(self, tmp_path: Path) -> None:
        dump = "ITEM: TIMESTEP\n9\nITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS id x y z radius\n1 0 0 0.0002 0.0003\n"
        log = "Step v_moving v_spinning v_rest\n9 0 0 0\n"
        body = f"cat > settled.dump <<'END'\n{dump}END\ncat > log.lammps <<'END'\n{log}END\n"
        with pytest.raises(EngineFailedError, match=r"sphere 0 reaches 0\.3333 of its radius through the floor"):
            settle(TUBE, D, 1e-6, executable=fake(tmp_path, body))

    def test_ctrl_c_removes_the_temporary_folder(self, tmp_path: Path, temporary_folder: Path) -> None:
        body = "printf 'Step v_moving v_spinning\\n0 0 0\\n' > log.lammps; exec sleep 60"

        def interrupt(_: float, __: str) -> None:
            assert list(temporary_folder.iterdir()) != []
            os.kill(os.getpid(), signal.SIGINT)

        with pytest.raises(KeyboardInterrupt):
            settle(TUBE, D, 2e-3, executable=fake(tmp_path, body), progress=interrupt)
        assert list(temporary_folder.iterdir()) == []
