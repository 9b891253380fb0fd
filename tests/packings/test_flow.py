"""Flows by LAMMPS: what comes out, what goes on where it was cut off, what fails, and how it says so."""

from __future__ import annotations

import itertools
import math
import os
import pickle
import re
import shutil
import stat
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bedrad
from bedrad import EngineFailedError
from bedrad.packings.flow import Flow, plan_flow
from bedrad.packings.flow_plan import Channel
from bedrad.packings.flow_script import REST, frame_name
from bedrad.packings.lammps import LOG, find_lammps

pytestmark = pytest.mark.dem

TUBE = bedrad.Tube(1.5e-3)
SMALL: dict[str, Any] = {
    "diameter": 6e-4, "velocity": 0.1, "frames": 6, "flush": 4.0,
    "channel": Channel(tube_length=14.0, window=(4.0, 9.0)),
}  # fmt: skip


def run(**changes: Any) -> Flow:
    with warnings.catch_warnings():
        # so short a run is short of independent structures
        warnings.simplefilter("ignore", UserWarning)
        return bedrad.flow(TUBE, **(SMALL | changes))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("flow")


@pytest.fixture(scope="module")
def found(folder: Path) -> Flow:
    return run(work_dir=folder)


def lammps_that_ends(folder: Path, at: str) -> Path:
    """A LAMMPS that ends with an error before the command that begins with `at`."""
    path = folder / "ending-lmp"
    path.write_text(f"#!/bin/sh\nsed -i 's/^{at}.*$/quit 3/' in.lammps\nexec {find_lammps()} \"$@\"\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


class TestFlow:
    def test_it_gives_frames_at_about_the_velocity_asked_for(self, found: Flow) -> None:
        assert len(found) == len(list(found)) == 6
        m = found.measures
        # the belt slips by 1 to 16 %, and so short a run has not come to rest from its start
        assert 0.9 < m.velocity / 0.1 < 1.25
        first = found[0]
        assert first.wall == TUBE
        assert first.period is None
        assert first.provenance["mean_velocity_m_per_s"] == m.velocity
        assert first.provenance["wall_friction"] == 0.4
        assert first.centers[:, 2].min() >= 3.0 * 6e-4
        low, high = found.window.axial
        assert (low, high) == pytest.approx((7.0 * 6e-4, 12.0 * 6e-4))
        assert "velocity" in str(found)

    def test_mass_is_conserved(self, found: Flow, folder: Path) -> None:
        # what crosses a height between the first frame and the last is what the discharge says
        from bedrad.packings.flow_frames import read_frame

        frames = [read_frame(folder / frame_name(step)) for step in found.plan.frame_numbers]
        heights = np.linspace(*found.window.axial, 41)
        crossed = np.zeros(len(heights))
        for first, second in itertools.pairwise(frames):
            _, before, after = np.intersect1d(first.numbers, second.numbers, return_indices=True)
            up, down = first.centers[before, 2, None], second.centers[after, 2, None]
            crossed += ((up >= heights) & (down < heights)).sum(axis=0) - ((up < heights) & (down >= heights)).sum(
                axis=0
            )
        time = (frames[-1].step - frames[0].step) * found.plan.time_step
        flux = crossed.mean() * 3800.0 * math.pi / 6.0 * 6e-4**3 / time
        m = found.measures
        error = m.discharge * math.hypot(m.velocity_error / m.velocity, m.solid_fraction_error / m.solid_fraction)
        assert abs(flux - m.discharge) < 4.0 * error

    def test_spheres_stay_inside_the_tube(self, found: Flow) -> None:
        for packing in found:
            # contacts are soft: the overlap with the wall stays far below the limit of a packing
            assert (packing.radii - packing.depths).max() < 0.05 * 6e-4

    def test_the_wall_holds_and_presses(self, found: Flow) -> None:
        m = found.measures
        assert m.wall_pressure > 0.0
        # Coulomb's law bounds the mean as it bounds every contact
        assert abs(m.wall_shear) <= 0.4 * m.wall_pressure * (1.0 + 1e-9)

    def test_same_seed_same_flow(self, found: Flow) -> None:
        again = run()
        assert np.array_equal(again[-1].centers, found[-1].centers)
        assert again.measures.velocity == found.measures.velocity
        assert not np.array_equal(run(seed=2, frames=2)[0].centers[:5], found[0].centers[:5])

    def test_packings_travel(self, found: Flow, tmp_path: Path) -> None:
        packing = found[2]
        bedrad.write(packing, tmp_path / "bed.h5")
        back = bedrad.read(tmp_path / "bed.h5")
        assert np.array_equal(back.centers, packing.centers)
        assert dict(back.provenance) == dict(packing.provenance)
        assert len(pickle.loads(pickle.dumps(packing))) == len(packing)

    def test_two_ranks_give_the_same_kind_of_flow(self, found: Flow) -> None:
        # two ranks add forces in another order, so that the flow is another one of the same kind
        other = run(ranks=2, frames=2, flush=1.0)
        assert 0.5 < other.measures.velocity / 0.1 < 1.5
        assert other.measures.rest_solid_fraction == pytest.approx(found.measures.rest_solid_fraction, rel=0.05)

    def test_hertz_contacts_and_mixtures_flow_too(self) -> None:
        for changes in ({"youngs_modulus": 2e6}, {"diameter": None, "sizes": [(6e-4, 0.7), (5e-4, 0.3)]}):
            other = run(frames=2, flush=1.0, **changes)
            assert 0.5 < other.measures.velocity / 0.1 < 1.5
            assert len(np.unique(other[0].radii)) == (2 if "sizes" in changes else 1)

    def test_it_tells_how_far_it_is(self) -> None:
        told: list[tuple[float, str]] = []
        run(frames=2, flush=1.0, progress=lambda share, text: told.append((share, text)))
        shares = [share for share, _ in told]
        assert shares == sorted(shares)
        assert told[-1][0] == 1.0
        assert {"filling", "flushing"} <= {text.split(":")[0] for _, text in told}

    def test_a_short_run_is_said_to_be_one(self) -> None:
        with pytest.warns(UserWarning, match="short of independent structures"):
            bedrad.flow(TUBE, **(SMALL | {"frames": 2, "flush": 1.0}))


class TestInterrupted:
    def test_a_run_that_ended_in_the_flush_goes_on(self, found: Flow, tmp_path: Path) -> None:
        work = tmp_path / "work"
        with pytest.raises(EngineFailedError, match="exit code 3"):
            run(work_dir=work, executable=lammps_that_ends(tmp_path, "dump "))
        assert (work / LOG).exists()
        restarts = list(work.glob("flow.restart.*"))
        assert restarts
        resumed = run(work_dir=work)
        step = int(resumed[0].provenance["resumed_at_step"])
        assert 0 < step <= found.plan.fill_steps + found.plan.flush_steps
        assert len(resumed) == len(found)
        assert not list(work.glob("flow.restart.*"))
        # who reads the frames later is told too
        assert run(work_dir=work, executable=tmp_path / "nothing")[0].provenance["resumed_at_step"] == step
        # the same flow but for rounding, which chaos makes another one of the same kind
        m, n = found.measures, resumed.measures
        assert abs(m.velocity - n.velocity) < 5.0 * math.hypot(m.velocity_error, n.velocity_error)

    def test_a_run_that_ended_while_filling_goes_on_too(self, tmp_path: Path) -> None:
        work = tmp_path / "work"
        with pytest.raises(EngineFailedError):
            run(work_dir=work, executable=lammps_that_ends(tmp_path, "write_dump"))
        resumed = run(work_dir=work)
        assert int(resumed[0].provenance["resumed_at_step"]) <= plan_flow(TUBE, **SMALL).fill_steps
        assert (work / REST).exists()

    def test_a_restart_file_that_was_cut_off_is_passed_over(self, tmp_path: Path) -> None:
        work = tmp_path / "work"
        with pytest.raises(EngineFailedError):
            run(work_dir=work, executable=lammps_that_ends(tmp_path, "dump "))
        newest = max(work.glob("flow.restart.*"), key=lambda path: int(path.suffix[1:]))
        os.truncate(newest, newest.stat().st_size // 2)
        resumed = run(work_dir=work)
        step = resumed[0].provenance.get("resumed_at_step")
        assert step is None or int(step) < int(newest.suffix[1:])
        assert run(work_dir=work)[0].provenance.get("resumed_at_step") == step
        assert len(resumed) == 6

    def test_a_lammps_that_cannot_start_costs_no_restart_file(self, tmp_path: Path) -> None:
        work = tmp_path / "work"
        with pytest.raises(EngineFailedError):
            run(work_dir=work, executable=lammps_that_ends(tmp_path, "dump "))
        restarts = sorted(work.glob("flow.restart.*"))
        assert len(restarts) > 1
        with pytest.raises(EngineFailedError, match="cannot be started"):
            run(work_dir=work, executable=tmp_path / "nothing")
        assert sorted(work.glob("flow.restart.*")) == restarts

    @pytest.mark.parametrize("broken", ["rest", "frame"])
    def test_a_run_that_ended_with_a_broken_file_is_no_finished_one(
        self, found: Flow, folder: Path, tmp_path: Path, broken: str
    ) -> None:
        work = tmp_path / "work"
        shutil.copytree(folder, work)
        name = REST if broken == "rest" else frame_name(found.plan.frame_numbers[2])
        whole = (work / name).read_bytes()
        (work / name).write_bytes(whole[: len(whole) // 2])
        run(work_dir=work)
        assert (work / name).read_bytes() == whole

    def test_it_goes_on_only_from_where_nothing_is_missing(self, found: Flow, tmp_path: Path) -> None:
        work = tmp_path / "work"
        with pytest.raises(EngineFailedError):
            run(work_dir=work, executable=lammps_that_ends(tmp_path, "dump "))
        steps = [int(path.suffix[1:]) for path in work.glob("flow.restart.*")]
        assert max(steps) > found.plan.fill_steps
        (work / REST).unlink()
        again = run(work_dir=work)
        assert again[0].provenance.get("resumed_at_step", 0) < found.plan.fill_steps
        assert again.measures.rest_solid_fraction == pytest.approx(found.measures.rest_solid_fraction, rel=1e-3)
        assert not list(work.glob("flow.restart.*"))

    def test_a_finished_run_is_only_read(self, found: Flow, folder: Path, tmp_path: Path) -> None:
        again = run(work_dir=folder, executable=tmp_path / "nothing")
        assert np.array_equal(again[3].centers, found[3].centers)
        assert again[0].provenance["engine_version"] == found[0].provenance["engine_version"] != "unknown"

    def test_a_folder_of_another_run_is_refused(self, found: Flow, folder: Path) -> None:
        with pytest.raises(ValueError, match="holds a flow with other parameters"):
            run(work_dir=folder, velocity=0.11)

    def test_a_crash_leaves_its_log_and_names_the_cause(self, tmp_path: Path) -> None:
        work = tmp_path / "work"
        with pytest.raises(EngineFailedError, match=re.escape("the last lines of its log")) as caught:
            run(work_dir=work, executable=lammps_that_ends(tmp_path, "region          window"))
        assert "quit 3" in str(caught.value)
        assert (work / LOG).read_text()


def test_an_orifice_empties_the_tube() -> None:
    found = run(
        velocity=None, frames=4, flush=3.0,
        channel=Channel(tube_length=14.0, window=(6.0, 11.0), orifice=2.7e-3),
    )  # fmt: skip
    m = found.measures
    assert m.discharge > 0.0
    assert m.beverloo_discharge > 0.0
    assert found[0].provenance["protocol"] == "a hopper feeds a tube that an orifice empties; what leaves falls back"
