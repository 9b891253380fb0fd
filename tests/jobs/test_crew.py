from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bedrad.jobs.crew import Alone, LocalCrew, Lost
from jobs import crew_tasks


def test_a_crew_of_one_answers_in_order():
    assert list(Alone().run(crew_tasks.double, "x", [1, 2])) == [(0, ("x", 2)), (1, ("x", 4))]


def test_local_workers_answer_every_task_whatever_happens_to_them(tmp_path):
    with LocalCrew(2) as crew:
        assert (crew.size, crew.threads) == (2, 1)
        assert dict(crew.run(crew_tasks.double, "x", range(20))) == {k: ("x", 2 * k) for k in range(20)}
        # one that is killed is replaced, and its task done again
        assert dict(crew.run(crew_tasks.die_once, str(tmp_path), range(6))) == {k: k for k in range(6)}
        # what it raises is an answer
        assert dict(crew.run(crew_tasks.fail, None, ["a"])) == {0: Lost("KeyError: 'a'")}
        processes = [worker.process for worker in crew._workers]
    assert not any(process.is_alive() for process in processes)


def test_a_task_that_kills_every_worker_is_given_up():
    with LocalCrew(1) as crew:
        found = dict(crew.run(crew_tasks.die_always, None, range(3)))
    assert (found[0], found[2]) == (0, 2)
    assert found[1] == Lost("its worker was ended by the signal SIGKILL, 3 times; too little memory?")


def test_no_workers_are_refused():
    with pytest.raises(ValueError, match="workers is 0; expected at least 1"):
        LocalCrew(0)


def test_workers_end_with_a_parent_that_was_killed(tmp_path):
    code = (
        "from bedrad.jobs.crew import LocalCrew; from jobs import crew_tasks\n"
        "if __name__ == '__main__':\n"
        f"    with LocalCrew(1) as crew: list(crew.run(crew_tasks.wait_for, {str(tmp_path)!r}, [0]))\n"
    )
    script = tmp_path / "script.py"
    script.write_text(code)
    tests = str(Path(__file__).parents[1])
    parent = subprocess.Popen([sys.executable, script], env=os.environ | {"PYTHONPATH": tests})
    assert _comes(lambda: list(tmp_path.glob("pid_*")))
    (mark,) = tmp_path.glob("pid_*")
    parent.kill()
    parent.wait()
    # it tidies up as after Ctrl-C, and is gone
    assert _comes((tmp_path / "tidied").exists)
    assert _comes(lambda: not Path(f"/proc/{mark.name.removeprefix('pid_')}").exists())


def _comes(true):
    """Whether something comes true within a time that only a failure takes."""
    for _ in range(600):
        if true():
            return True
        time.sleep(0.05)
    return False
