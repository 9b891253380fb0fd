from __future__ import annotations

import errno
import os
import subprocess
import sys

import pytest

from bedrad.jobs.locking import remove_leftovers, results_lock


def test_a_lock_is_held_by_one_at_a_time_and_leaves_nothing(tmp_path):
    path = tmp_path / "r.h5"
    with results_lock(path):
        with pytest.raises(OSError, match="another bedrad run is writing these results") as caught, results_lock(path):
            pytest.fail("both hold it")
        assert caught.value.errno == errno.EBUSY
        assert caught.value.filename == str(path)
        # another file is another matter
        with results_lock(tmp_path / "other.h5"):
            pass
    with results_lock(path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_an_error_inside_is_passed_on(tmp_path):
    def fail():
        with results_lock(tmp_path / "r.h5"):
            raise FileNotFoundError("inside")

    with pytest.raises(FileNotFoundError, match="inside"):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_the_lock_of_a_process_that_was_killed_is_free(tmp_path):
    code = (
        "import os, signal, sys; from pathlib import Path; from bedrad.jobs.locking import results_lock\n"
        "with results_lock(Path(sys.argv[1])): os.kill(os.getpid(), signal.SIGKILL)"
    )
    subprocess.run([sys.executable, "-c", code, tmp_path / "r.h5"], check=False)
    assert [file.name for file in tmp_path.iterdir()] == [".r.h5.lock"]
    with results_lock(tmp_path / "r.h5"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_lock_whose_file_was_removed_between_is_not_believed(tmp_path, monkeypatch):
    """The holder before removes the file after we opened it and before we lock it."""
    path, real, opened = tmp_path / "r.h5", os.fstat, []

    def remove_first(handle):
        if not opened:
            opened.append(handle)
            (tmp_path / ".r.h5.lock").unlink()
        return real(handle)

    monkeypatch.setattr("bedrad.jobs.locking.os.fstat", remove_first)
    with results_lock(path):
        monkeypatch.undo()
        assert (tmp_path / ".r.h5.lock").exists()
        with pytest.raises(OSError, match="another bedrad run"), results_lock(path):
            pytest.fail("both hold it")


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with (
        pytest.raises(FileNotFoundError, match=r"cannot write: .*nowhere/r\.h5"),
        results_lock(tmp_path / "nowhere/r.h5"),
    ):
        pytest.fail("the block must not run")


def test_only_what_killed_runs_left_of_this_file_is_removed(tmp_path):
    names = [".r.h5.0123abcd.part", ".r.h5.0123abcd.part2", ".r.h5x.0123abcd.part", ".r.h5.0123abcg.part", "r.h5"]
    for name in names:
        (tmp_path / name).touch()
    remove_leftovers(tmp_path / "r.h5")
    assert {file.name for file in tmp_path.iterdir()} == set(names[1:])


def test_a_file_system_without_locks_is_told(tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("bedrad.jobs.locking.fcntl.flock", refuse)
    with pytest.warns(UserWarning, match="has no locks"), results_lock(tmp_path / "r.h5"):
        pass
