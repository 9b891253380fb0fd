"""What the tests of the command line share."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings

import bedrad
from bedrad import cli
from bedrad.packings import lammps
from jobs.small_job import ring_bed

# the same examples every time, so that a change fails for what it changed; and no timing is a test: in a fresh clone
# the first text takes seconds, while the tables of characters are made
settings.register_profile("repeatable", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("repeatable")


@pytest.fixture
def bed(tmp_path):
    """A bed in a file of its own."""
    bedrad.write(ring_bed(), tmp_path / "bed.h5")
    return tmp_path / "bed.h5"


@pytest.fixture
def call(capsys):
    """Run the command line in this process: exit code, output, lines of the error stream."""

    def run(*words):
        code = cli.main([str(word) for word in words])
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        return code, out, [line for line in err.splitlines() if line.strip()]

    return run


@pytest.fixture
def refused(call):
    """Run the command line, which must fail with the code and one line of error; that line."""

    def run(code, *words):
        found, out, err = call(*words)
        assert (found, out) == (code, "")
        assert len(err) == 1, err
        assert err[0].startswith("bedrad: ")
        return err[0].removeprefix("bedrad: ")

    return run


@pytest.fixture
def no_lammps(monkeypatch):
    def fail(*_, **__):
        pytest.fail("LAMMPS was looked for")

    monkeypatch.setattr(lammps, "find_lammps", fail)
