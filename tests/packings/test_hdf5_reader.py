"""HDF5 files are read in a process that may die: what becomes of its files, its errors, its threads and its ends."""

from __future__ import annotations

import io
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np
import pytest

from bedrad import BadFileError, EngineFailedError, Packing, Plate, Rod, Tube, read, write
from bedrad.jobs.results import Results, check_record_file
from bedrad.packings.files import hdf5_access, hdf5_reader
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.hdf5_pipe import contents_of_message, message_of_contents, receive, send
from bedrad.packings.files.hdf5_reader import Reader, ask, start_command

SPHERES = [[0.0, 0.0, 0.1 * k] for k in range(5)]

MISBEHAVE = """
import os, signal, time, sys
import numpy as np
from bedrad.packings.files import hdf5_child, hdf5_access

hdf5_child._TIME = 0.2

def opened(path):
    hdf5_access.before_opening(path)
    return path.read_bytes()

def die(path, number): os.kill(os.getpid(), number)
def leave(path): os._exit(3)
def hang(path):
    opened(path)
    while True: pass
def swell(path):
    opened(path)
    return len(np.ones(1 << 30))
def slip(path): return 1 / 0
def warn(path):
    np.float64(1e308) * 10
    return "done"
def age(path):
    import warnings
    class Old(DeprecationWarning): pass
    warnings.warn("old", Old)
    return "done"
def sleep(path):
    time.sleep(60)
def mumble(path): return {b"key": 1}
def say(path):
    os.write(1, b"noise"); print("noise", flush=True)
    return os.getcwd()

calls = (die, leave, hang, swell, slip, warn, age, sleep, mumble, say)
hdf5_child.serve({f.__name__: f for f in calls} | hdf5_child.CALLS)
"""


def misbehaving() -> list[str]:
    command = start_command()
    start = command[4].replace("from bedrad.packings.files.hdf5_child import serve; serve()", "exec(misbehave)")
    return [*command[:4], f"import sys; misbehave = sys.argv.pop(); {start}", *command[5:], MISBEHAVE]


@pytest.fixture(scope="module")
def reader() -> Iterator[Reader]:
    made = Reader(misbehaving)
    yield made
    made.close()


@pytest.fixture
def bed(tmp_path: Path) -> Path:
    """A bed that this process has not written as it is."""
    return bed_at(tmp_path / "bed.h5")


def bed_at(path: Path, count: int = 5, **more: object) -> Path:
    centers = np.c_[np.zeros((count, 2)), 0.1 * np.arange(count)]
    write(Packing(centers, 0.05, Tube(1.0), **more), path)  # type: ignore[arg-type]
    os.utime(path, (1.0, 1.0))
    return path


def alive(number: int) -> bool:
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_for(what: Callable[[], bool]) -> bool:
    end = time.monotonic() + 10
    while not what() and time.monotonic() < end:
        time.sleep(0.01)
    return what()


def break_kind_of_text(path: Path, name: bytes) -> None:
    """Make the kind of a text of variable length one that does not exist, on which the library (2.0.0) crashes."""
    data = bytearray(path.read_bytes())
    # names are filled up to eight bytes; the type stands behind
    known = name + bytes(8 - len(name) % 8) + b"\x19\x01"
    data[data.index(known) + len(known) - 1] = 0xFF
    path.write_bytes(data)
    os.utime(path, (2.0, 2.0))


# What a file does to the process that reads it


@pytest.mark.parametrize(
    ("call", "arguments", "message"),
    [
        ("die", (signal.SIGSEGV,), r"the HDF5 library ended with signal 11 \(SIGSEGV\) while it read the file; the"),
        ("die", (signal.SIGABRT,), r"the HDF5 library ended with signal 6 \(SIGABRT\)"),
        (
            "die",
            (signal.SIGKILL,),
            r"the process that reads HDF5 files was ended with signal 9 \(SIGKILL\), from outside or for memory",
        ),
        ("leave", (), "the HDF5 library ended with code 3"),
        ("hang", (), "reading took far longer than a file of its size should"),
        ("swell", (), "needs far more memory than a file of its size should"),
    ],
)
def test_whatever_the_process_dies_of_is_one_error_and_the_next_file_is_read(
    reader: Reader, bed: Path, call: str, arguments: tuple[int, ...], message: str
) -> None:
    with pytest.raises(BadFileError, match=rf"^{bed}: {message}"):
        reader.ask(call, bed, *arguments)
    assert isinstance(reader.ask("read_spheres", bed), Contents)


def test_a_text_of_no_known_kind_is_refused_before_the_library_crashes(bed: Path) -> None:
    number = hdf5_reader._READER.number
    for name in (b"wall", b"units"):
        broken = bed_at(bed.with_name("broken.h5"))
        break_kind_of_text(broken, name)
        with pytest.raises(BadFileError, match=rf"broken\.h5: .*attribute '{name.decode()}' is a list of var"):
            read(broken)
    # and no process died of it
    assert number in (None, hdf5_reader._READER.number)


def results_at(path: Path) -> Results:
    results = Results(path)

    def fill(group: h5py.Group) -> None:
        group["numbers"] = np.arange(3.0)
        group["numbers"].attrs["long_name"] = "some numbers"

    results.write_stage("statistics", "digest", fill, keep=(), attributes={"job": "{}", "inputs": "{}"})
    return results


@pytest.mark.parametrize("name", [b"digest", b"long_name"])
def test_a_results_file_on_which_the_library_crashes_is_one_error(tmp_path: Path, name: bytes) -> None:
    results = results_at(tmp_path / "results.h5")
    break_kind_of_text(results.path, name)
    for action in (results.digests, results.attributes, lambda: results.read("statistics")):
        # later versions of the library may say what is wrong instead
        with pytest.raises(
            BadFileError, match=r"results\.h5: (the HDF5 library ended with signal 11|not a bedrad res)"
        ):
            action()
    with pytest.raises(BadFileError, match=r"results\.h5: holds something else than one 'packing' record"):
        check_record_file(results.path, "packing")


def test_a_file_is_looked_at_too_that_only_its_version_makes_crash(tmp_path: Path) -> None:
    path = tmp_path / "other.h5"
    with h5py.File(path, "w") as file:
        file.attrs["schema_version"] = "a text, and no job beside it"
    break_kind_of_text(path, b"schema_version")
    with pytest.raises(BadFileError, match=r"other\.h5: (the HDF5 library ended with signal 11|not a bedrad res)"):
        Results(path).digests()


def test_a_text_that_claims_gigabytes_needs_none(bed: Path) -> None:
    data = bytearray(bed.read_bytes())
    # length, heap and number of the text in it, behind its name, its type and its shape
    place = data.index(struct_of_text(data), data.index(b"wall\0"))
    data[place : place + 4] = (0x7FFFFFFF).to_bytes(4, "little")
    bed.write_bytes(data)
    script = (
        "import resource, bedrad\n"
        f"try: bedrad.read({str(bed)!r})\n"
        "except bedrad.BadFileError as error: print(error)\n"
        "from bedrad.packings.files import hdf5_reader\n"
        "hdf5_reader._READER.close()\n"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, flush=True)"
    )
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    message, most = told.splitlines()
    assert "bed.h5: damaged or cut-off HDF5 file" in message
    assert int(most) < 1 << 20


def struct_of_text(data: bytearray) -> bytes:
    """How the file tells of the text "tube": four bytes of length, and the place of the heap."""
    return (4).to_bytes(4, "little") + data.index(b"GCOL").to_bytes(8, "little")


# What goes through the pipe


@pytest.mark.parametrize("wall", [Tube(1 / 3), Rod(0.1), Plate(), None])
@pytest.mark.parametrize("period", [None, 0.1, (0.1, 1 / 3)])
def test_contents_come_through_bit_for_bit(wall: object, period: object) -> None:
    held = Contents(
        centers=np.asarray(SPHERES)[:, ::-1],
        radii=np.full(5, 1 / 30),
        wall=wall,  # type: ignore[arg-type]
        period=period,  # type: ignore[arg-type]
        provenance={"text": "ä\ud800\n", "number": 1 / 3, "whole": 2**63 - 1, "none": float("inf"), "one": 1.0},
        max_overlap=1 / 7,
        ids=np.arange(5),
        states_unit=True,
    )
    ours, theirs = os.pipe()
    with os.fdopen(ours, "rb", 0) as out, os.fdopen(theirs, "wb") as into:
        message, arrays = message_of_contents(held)
        send(into, message, arrays)
        told, given = receive(out)
    back = contents_of_message(told, given)
    for name in ("centers", "radii", "ids"):
        np.testing.assert_array_equal(getattr(back, name), getattr(held, name))
    for name in ("wall", "period", "provenance", "max_overlap", "states_unit"):
        assert getattr(back, name) == getattr(held, name)
    assert {k: type(v) for k, v in back.provenance.items()} == {k: type(v) for k, v in held.provenance.items()}


def test_only_numbers_come_through() -> None:
    ours, theirs = os.pipe()
    with os.fdopen(ours, "rb", 0) as out, os.fdopen(theirs, "wb") as into:
        send(into, {}, [np.array(["a"])])
        with pytest.raises(ValueError, match="an array of <U1"):
            receive(out)


def test_what_libraries_print_does_not_come_between(reader: Reader, bed: Path) -> None:
    assert reader.ask("say", bed) == str(Path.cwd())


def test_warnings_and_slips_of_the_process_show_here(reader: Reader, bed: Path) -> None:
    with pytest.warns(RuntimeWarning, match="overflow"):
        assert reader.ask("warn", bed) == "done"
    with pytest.warns(DeprecationWarning, match="old"):
        assert reader.ask("age", bed) == "done"
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        reader.ask("slip", bed)
    with pytest.raises(RuntimeError, match="keys must be str"):
        reader.ask("mumble", bed)
    assert reader.ask("say", bed)


def test_a_relative_path_is_read_where_this_process_is(bed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(read(bed)) == 5
    monkeypatch.chdir(bed.parent)
    assert len(read("bed.h5")) == 5
    (bed.parent / "inner").mkdir()
    monkeypatch.chdir("inner")
    with pytest.raises(BadFileError, match=r"^bed\.h5: no such file"):
        read("bed.h5")


def test_a_relative_path_leads_nowhere_where_the_folder_is_gone(bed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(bed.parent)
    assert isinstance(ask("read_spheres", Path("bed.h5")), Contents)
    gone = bed.parent / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    # the process is still in the folder of the file that it read before
    with pytest.raises(BadFileError, match=r"^bed\.h5: cannot be read: the folder in which its path begins: No such"):
        ask("read_spheres", Path("bed.h5"))
    assert isinstance(ask("read_spheres", bed), Contents)


def test_a_file_that_is_all_hole_is_one_error() -> None:
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as folder:
        path = bed_at(Path(folder) / "bed.h5")
        try:
            os.truncate(path, 1 << 62)
        except OSError:
            pytest.skip("no file of this size on this disk")
        with pytest.raises(BadFileError, match=r"bed\.h5: (damaged or cut-off HDF5 file|cannot be read)"):
            ask("read_spheres", path)


def test_holes_are_not_gone_through(bed: Path) -> None:
    try:
        os.truncate(bed, 1 << 34)
    except OSError:
        pytest.skip("no file of this size on this disk")
    begin = time.process_time()
    hdf5_access._check_heaps(bed)
    assert time.process_time() - begin < 1.0
    with bed.open("r+b") as file:
        file.seek(1 << 33)
        file.write(b"GCOL\x01\0\0\0" + (1 << 20).to_bytes(8, "little"))
    with pytest.raises(BadFileError, match="a heap of texts with a false size"):
        hdf5_access._check_heaps(bed)


def test_what_a_bare_stream_does_not_take_at_once_is_sent_after() -> None:
    class Narrow(io.BytesIO):
        def write(self, data: object) -> int:
            return super().write(memoryview(data)[:7])  # type: ignore[arg-type]

    stream = Narrow()
    send(stream, {"text": "a" * 50}, [np.arange(9.0)])
    stream.seek(0)
    message, arrays = receive(stream)
    assert message == {"text": "a" * 50}
    np.testing.assert_array_equal(arrays[0], np.arange(9.0))


# Which files are read where


def test_only_files_that_were_written_here_and_are_as_they_were_are_read_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    class Deaf(Reader):
        def ask(self, call: str, path: Path, *arguments: object) -> object:
            asked.append(f"{call} {path.name}")
            return None

    monkeypatch.setattr(hdf5_reader, "_READER", Deaf())
    path = tmp_path / "bed.h5"
    write(Packing(SPHERES, 0.05, Tube(1.0)), path)
    assert len(read(path)) == 5
    results = results_at(tmp_path / "results.h5")
    assert results.digests() == {"statistics": "digest"}
    assert asked == []
    # whoever copies one, or changes its time only, may have changed more
    (tmp_path / "copy.h5").write_bytes(results.path.read_bytes())
    Results(tmp_path / "copy.h5").digests()
    Results(tmp_path / "copy.h5").attributes()
    assert asked == ["survey copy.h5"]
    os.utime(path, (1.0, 1.0))
    ask("read_spheres", path)
    assert asked == ["survey copy.h5", "read_spheres bed.h5"]


# The life of the process


def test_threads_share_one(tmp_path: Path, reader: Reader) -> None:
    paths = [bed_at(tmp_path / f"{count}.h5", count) for count in range(1, 9)]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda path: len(reader.ask("read_spheres", path).radii), paths * 5))
    assert found == [*range(1, 9)] * 5


def test_it_ends_with_its_parent_however_that_ends(bed: Path) -> None:
    for ending in ("", "os.kill(os.getpid(), 9)"):
        script = (
            f"import os, bedrad; bedrad.read({str(bed)!r})\n"
            "from bedrad.packings.files import hdf5_reader\n"
            f"print(hdf5_reader._READER.number, flush=True)\n{ending}"
        )
        told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
        assert told.stderr == ""
        number = int(told.stdout)
        assert wait_for(lambda number=number: not alive(number))  # type: ignore[misc]


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_a_forked_process_has_one_of_its_own(bed: Path) -> None:
    read(bed)
    number = hdf5_reader._READER.number
    ours, theirs = os.pipe()
    child = os.fork()
    if not child:
        read(bed)
        os.write(theirs, str(hdf5_reader._READER.number).encode())
        hdf5_reader._READER.close()
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
    with os.fdopen(ours) as out:
        os.close(theirs)
        assert int(out.read()) != number
    assert len(read(bed)) == 5
    assert hdf5_reader._READER.number == number


def test_one_that_was_ended_between_two_files_is_started_again(bed: Path) -> None:
    read(bed)
    number = hdf5_reader._READER.number
    assert number is not None
    os.kill(number, signal.SIGTERM)
    assert wait_for(lambda: not alive(number))
    assert len(read(bed)) == 5
    assert hdf5_reader._READER.number != number


def test_ctrl_c_while_it_reads_ends_it(bed: Path) -> None:
    made = Reader(misbehaving)
    made.ask("say", bed)
    number = made.number
    assert number is not None
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        made.ask("sleep", bed)
    timer.join()
    assert not alive(number)
    assert isinstance(made.ask("read_spheres", bed), Contents)
    made.close()


@pytest.mark.parametrize("ending", ["", "os.kill(os.getpid(), 9)"])
def test_it_ends_with_its_parent_even_while_it_reads(bed: Path, ending: str) -> None:
    script = (
        "import os, threading, time\n"
        "from pathlib import Path\n"
        "from bedrad.packings.files.hdf5_reader import _READER as reader\n"
        f"reader._command = lambda: {misbehaving()!r}\n"
        f"path = Path({str(bed)!r})\n"
        "reader.ask('say', path)\n"
        "threading.Thread(target=reader.ask, args=('sleep', path), daemon=True).start()\n"
        "time.sleep(0.2)\n"
        f"print(reader.number, flush=True)\n{ending}"
    )
    command = [sys.executable, "-c", script]
    told = subprocess.run(command, capture_output=True, text=True, check=False, timeout=30).stdout
    assert wait_for(lambda: not alive(int(told)))


def test_the_limit_of_time_holds_where_its_signal_was_blocked(bed: Path) -> None:
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGXCPU})
    made = Reader(misbehaving)
    try:
        with pytest.raises(BadFileError, match="reading took far longer"):
            made.ask("hang", bed)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        made.close()


def test_it_starts_where_no_file_can_be_made(bed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full() -> None:
        raise FileNotFoundError(2, "No usable temporary directory found")

    monkeypatch.setattr(hdf5_reader.tempfile, "TemporaryFile", full)
    made = Reader()
    assert isinstance(made.ask("read_spheres", bed), Contents)
    made.close()


@pytest.mark.parametrize("executable", ["", None])
def test_a_program_with_python_built_in_is_told_so(
    bed: Path, monkeypatch: pytest.MonkeyPatch, executable: str | None
) -> None:
    monkeypatch.setattr(sys, "executable", executable)
    with pytest.raises(EngineFailedError, match=r"sys\.executable names no Python"):
        Reader().ask("read_spheres", bed)


def test_it_starts_from_a_folder_with_a_sign_that_parts_paths(bed: Path) -> None:
    home = bed.parent / f"one{os.pathsep}two"
    own = Path(hdf5_reader.__file__).resolve().parents[2]
    shutil.copytree(own, home / own.name, ignore=shutil.ignore_patterns("__pycache__"))
    script = f"import sys; sys.path.insert(0, {str(home)!r}); import bedrad; print(len(bedrad.read({str(bed)!r})))"
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (told.stdout, told.stderr) == ("5\n", "")


def test_installed_modules_hide_none_of_python(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    own = str(Path(hdf5_reader.__file__).resolve().parents[3])
    for known, found in (([str(tmp_path), "", own], [str(tmp_path), own]), ([str(tmp_path)], [own, str(tmp_path)])):
        monkeypatch.setattr(sys, "path", known)
        assert hdf5_reader._module_folders() == found


def test_one_that_does_not_start_is_no_fault_of_the_file(bed: Path) -> None:
    for command, message in (
        ([sys.executable, "-c", "raise SystemExit('no h5py')"], "did not start: no h5py"),
        (["/nowhere/python"], "cannot be started: .*nowhere"),
    ):
        with pytest.raises(EngineFailedError, match=message):
            Reader(lambda command=command: command).ask("read_spheres", bed)  # type: ignore[misc]
