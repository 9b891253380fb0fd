"""Reading HDF5 files of strangers in a process that may die: the library crashes on some that are broken.

The process is started when the first file is read, and kept for those that follow. It hands over what it read, so that
the library never sees the file here. A crash, a bomb or an endless loop is one `BadFileError`.
"""

from __future__ import annotations

import atexit
import builtins
import os
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from collections import OrderedDict
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, BinaryIO, cast

from bedrad.errors import BadFileError, EngineFailedError
from bedrad.packings.files.hdf5_child import CALLS, READY
from bedrad.packings.files.hdf5_pipe import contents_of_message, receive, send

__all__ = ["Reader", "ask", "check_survives", "note_written", "start_command"]

_START = (
    # the package of the readers would load all of them, and SciPy with them: ten times what is needed here
    "import sys; sys.path[:] = sys.argv[2:]; import types; "
    "files = types.ModuleType('bedrad.packings.files'); files.__path__ = [sys.argv[1]]; "
    "sys.modules[files.__name__] = files; from bedrad.packings.files.hdf5_child import serve; serve()"
)

_FEW_THREADS = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Linear algebra is not needed there, and every thread of it would take memory and time to start."""

_GRACE = 2.0
"""How long the process may take to end when asked to, before it is killed. [s]"""

_OUTSIDE = ("SIGKILL", "SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT")
"""Signals that no library ends with."""

_MOST_KNOWN = 10_000
"""Files that are remembered, the latest."""


def start_command() -> list[str]:
    """What starts the process that reads.

    Raises
    ------
    EngineFailedError
        If there is no Python to start, as in a program that has it built in.
    """
    if not sys.executable or getattr(sys, "frozen", False):
        raise EngineFailedError(
            "the process that reads HDF5 files cannot be started: sys.executable names no Python, as where it is built "
            "into a program"
        )
    return [sys.executable, "-P", "-S", "-c", _START, str(Path(__file__).parent), *_module_folders()]


class Reader:
    """A process that reads, for all threads of this one: one file after the other, as the library does anyway.

    Parameters
    ----------
    command : callable
        Returns what starts it, by default `start_command`.
    """

    def __init__(self, command: Callable[[], Sequence[str]] = start_command) -> None:
        self._command = command
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def number(self) -> int | None:
        """Number of the process; None while there is none."""
        return None if self._process is None else self._process.pid

    def ask(self, call: str, path: Path, *arguments: Any) -> Any:
        """Have a function called on a file, one of those in `hdf5_child.CALLS`.

        Raises
        ------
        BadFileError
            If the function raises it, or the process dies of the file.
        EngineFailedError
            If the process cannot be started.
        """
        request = {"call": call, "path": os.fspath(path), "arguments": arguments, "folder": _folder()}
        with self._lock:
            process = self._started()
            try:
                send(cast(BinaryIO, process.stdin), request)
                answer, arrays = receive(cast(BinaryIO, process.stdout))
            except (EOFError, OSError):
                raise BadFileError(f"{path}: {_cause(self._end())}") from None
            except BaseException:
                # it is somewhere in an answer that nobody waits for any more
                process.kill()
                self._end()
                raise
        for kind, text in answer["warnings"]:
            warnings.warn(text, getattr(builtins, kind), stacklevel=2)
        if "bad" in answer:
            raise BadFileError(answer["bad"])
        if "failed" in answer:
            raise RuntimeError(f"{path}: the process that reads HDF5 files failed\n{answer['failed']}")
        return contents_of_message(answer["contents"], arrays) if "contents" in answer else answer["value"]

    def close(self) -> None:
        """End the process; the next file starts another."""
        with self._lock:
            self._end()

    def leave_nothing(self) -> None:
        """End the process when Python ends, without waiting for a thread that still has a file read."""
        if self._lock.acquire(timeout=_GRACE):
            self._end()
            self._lock.release()
        elif self._process is not None:
            self._process.kill()

    def leave(self) -> None:
        """Forget the process, which belongs to the one that this was forked from, and a lock that may be held there."""
        self._lock = threading.Lock()
        process, self._process = self._process, None
        if process is not None:
            for stream in (process.stdin, process.stdout):
                with suppress(OSError):
                    cast(BinaryIO, stream).close()
            # it is not this process's to wait for
            process.returncode = 0

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is not None and self._process.poll() is not None:
            # ended from outside, between two files
            self._end()
        if self._process is None:
            self._process = self._start()
        return self._process

    def _start(self) -> subprocess.Popen[bytes]:
        with _notebook() as told:
            try:
                process = subprocess.Popen(  # noqa: S603 - Python itself, and no word of a file
                    list(self._command()),
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=told,
                    bufsize=0,
                    env=os.environ | _FEW_THREADS,
                    # Ctrl-C is for this process, which then ends that one
                    start_new_session=True,
                )
            except OSError as error:
                raise EngineFailedError(f"the process that reads HDF5 files cannot be started: {error}") from error
            try:
                answer, _ = receive(cast(BinaryIO, process.stdout))
                if answer == READY:
                    return process
            except (EOFError, ValueError):
                pass
            except BaseException:
                _finish(process)
                raise
            _finish(process)
            told.seek(0)
            last = told.read().decode(errors="replace").strip()[-2000:]
        raise EngineFailedError(f"the process that reads HDF5 files did not start: {last}")

    def _end(self) -> int:
        """End the process, if there is one; what it ended with."""
        process, self._process = self._process, None
        return 0 if process is None else _finish(process)


def _notebook() -> IO[bytes]:
    """Where a process may write why it does not start; nowhere, where no file can be made or the disk is full."""
    try:
        return tempfile.TemporaryFile()
    except OSError:
        return Path(os.devnull).open("r+b", buffering=0)


def _finish(process: subprocess.Popen[bytes]) -> int:
    """Close the pipes to a process, which ends of it, and wait for it."""
    for stream in (process.stdin, process.stdout):
        with suppress(OSError):
            cast(BinaryIO, stream).close()
    try:
        return process.wait(_GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait()


def _folder() -> str | None:
    """Where relative paths begin; None where that was removed."""
    try:
        return str(Path.cwd())
    except OSError:
        return None


def _module_folders() -> list[str]:
    """Where this process finds modules, in its order, the folder it runs in left out."""
    own = str(Path(__file__).resolve().parents[3])
    places = [str(Path(place).resolve()) for place in sys.path if place]
    # in front it would hide modules of Python behind those that are installed beside this package
    return places if own in places else [own, *places]


def _cause(code: int) -> str:
    """What a process died of, from its exit code."""
    if code >= 0:
        return f"the HDF5 library ended with code {code} while it read the file; the file is broken"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = "unknown"
    if name == "SIGXCPU":
        return "reading took far longer than a file of its size should; the file is broken"
    if name in _OUTSIDE:
        return f"the process that reads HDF5 files was ended with signal {-code} ({name}), from outside or for memory"
    return f"the HDF5 library ended with signal {-code} ({name}) while it read the file; the file is broken"


_READER = Reader()
atexit.register(_READER.leave_nothing)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_READER.leave)

_known: OrderedDict[tuple[int, ...], bool] = OrderedDict()
"""Files as they were, and whether this process wrote them; the others came through a survey."""


def ask(call: str, path: Path, *arguments: Any) -> Any:
    """Call a function of `hdf5_child.CALLS` on a file: in a process that may die, or here if the file was written here.

    Raises
    ------
    BadFileError
        If the function raises it, or the process dies of the file.
    EngineFailedError
        If the process cannot be started.
    """
    if _known.get(_mark(path) or (), False):
        return CALLS[call](path, *arguments)
    return _READER.ask(call, path, *arguments)


def check_survives(path: Path) -> str | None:
    """Have a results file read in a process that may die, unless it is as it was when that was last done, or written.

    Returns
    -------
    str or None
        What is wrong with it, if something is; else it may be opened here.

    Raises
    ------
    BadFileError
        If the process dies of it.
    """
    mark = _mark(path)
    if mark is None or mark in _known:
        return None
    problem = cast("str | None", _READER.ask("survey", path))
    if problem is None:
        _remember(mark, False)
    return problem


def note_written(path: Path) -> None:
    """Remember that this process wrote a file, which it may rename, but not change."""
    mark = _mark(path)
    if mark is not None:
        _remember(mark, True)


def _remember(mark: tuple[int, ...], written: bool) -> None:
    _known[mark] = written
    while len(_known) > _MOST_KNOWN:
        _known.popitem(last=False)


def _mark(path: Path) -> tuple[int, ...] | None:
    """What tells whether a file is still the same; None if there is none."""
    try:
        held = path.stat()
    except OSError:
        return None
    return held.st_dev, held.st_ino, held.st_size, held.st_mtime_ns
