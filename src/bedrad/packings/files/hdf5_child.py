"""The process that reads HDF5 files: it may die of one, and takes nothing with it.

`hdf5_reader` starts it, without the package's own imports, which it does not need.
"""

from __future__ import annotations

import errno
import os
import select
import signal
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from bedrad.errors import BadFileError
from bedrad.packings.files import hdf5_access
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.edem_layout import edem_steps, is_edem, read_step
from bedrad.packings.files.hdf5_layout import read_spheres
from bedrad.packings.files.hdf5_pipe import message_of_contents, receive, send
from bedrad.packings.files.hdf5_survey import record_stages, survey

try:
    import fcntl
    import resource
except ImportError:  # where the system has no such limits
    fcntl = resource = None  # type: ignore[assignment]

__all__ = ["CALLS", "READY", "serve"]

CALLS: dict[str, Callable[..., Any]] = {
    "edem_steps": edem_steps,
    "is_edem": is_edem,
    "read_spheres": read_spheres,
    "read_step": read_step,
    "record_stages": record_stages,
    "survey": survey,
}
"""What can be asked for; each takes a path first, and then what JSON can hold."""

READY = {"ready": True}
"""What is sent first, when everything is loaded."""

_TIME, _TIME_A_BYTE = 4.0, 1e-6
"""What reading a file may take, and more for each of its bytes. [s of the processor]"""

_MEMORY, _MEMORY_A_BYTE = 1 << 29, 400
"""What reading a file may take, and more for each of its bytes: arrays may shrink a hundredfold. [bytes]"""

_LARGEST_LIMIT = 1 << 62
"""No system takes a limit of 2^63 and more."""


def serve(calls: dict[str, Callable[..., Any]] = CALLS) -> None:
    """Answer what comes through the standard input, until it ends."""
    # whatever the libraries print goes nowhere, and not between the answers
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    _limit_every_file()
    send(answers, READY)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):
        os.dup2(nowhere, number)
    while True:
        try:
            request, _ = receive(requests)
        except EOFError:
            return
        _answer(requests, answers, calls, request)


def _answer(
    requests: BinaryIO, answers: BinaryIO, calls: dict[str, Callable[..., Any]], request: dict[str, Any]
) -> None:
    """Do what is asked for, and send what came of it: the answer, the error, and the warnings on the way."""
    with warnings.catch_warnings(record=True) as caught, _ended_with_who_asks(requests):
        warnings.simplefilter("always")
        message, arrays = _outcome(calls, request)
    told = {"warnings": [[_builtin(warning.category), str(warning.message)] for warning in caught]}
    try:
        send(answers, message | told, arrays)
    except (TypeError, ValueError):
        # nothing was sent of what cannot be said in JSON
        send(answers, {"failed": traceback.format_exc()} | told)


@contextmanager
def _ended_with_who_asks(requests: BinaryIO) -> Iterator[None]:
    """Have the system end this process when nobody is left to ask it, even in an endless loop of the library."""
    if sys.platform == "win32":
        yield
        return
    flags = fcntl.fcntl(requests, fcntl.F_GETFL)
    # nothing is sent while an answer is waited for, so that the signal can only tell of the other end's end
    fcntl.fcntl(requests, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(requests, fcntl.F_SETFL, flags | os.O_ASYNC)
    try:
        if select.select([requests], [], [], 0)[0]:
            # it ended before
            os._exit(0)
        yield
    finally:
        fcntl.fcntl(requests, fcntl.F_SETFL, flags)


def _builtin(category: type[Warning]) -> str:
    """Name of the kind of a warning that every process knows: the kinds that are hidden by default stay hidden."""
    return next(kind.__name__ for kind in category.__mro__ if kind.__module__ == "builtins")


def _outcome(calls: dict[str, Callable[..., Any]], request: dict[str, Any]) -> tuple[dict[str, Any], list[Any]]:
    path = Path(request["path"])
    try:
        if not path.is_absolute():
            _enter(request["folder"], path)
        found = calls[request["call"]](path, *request["arguments"])
    except BadFileError as error:
        return {"bad": str(error)}, []
    except MemoryError:
        return {"bad": f"{path}: needs far more memory than a file of its size should"}, []
    except Exception:
        return {"failed": traceback.format_exc()}, []
    if isinstance(found, Contents):
        message, arrays = message_of_contents(found)
        return {"contents": message}, arrays
    return {"value": found}, []


def _enter(folder: str | None, path: Path) -> None:
    """Go where relative paths begin; BadFileError if that was removed, as this process may be elsewhere."""
    try:
        if folder is None:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
        os.chdir(folder)
    except OSError as error:
        reason = error.strerror or error
        raise BadFileError(f"{path}: cannot be read: the folder in which its path begins: {reason}") from None


def _limit_every_file() -> None:
    """Have every file that is opened limit what may happen from there on."""
    if resource is not None:
        # whoever started this process may have them ignored or blocked
        ends = (signal.SIGXCPU, signal.SIGIO)
        for number in ends:
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ends)
        resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
        hdf5_access.before_opening = _limit


def _limit(path: Path) -> None:
    """Limit the time and the memory of this process by the size of a file, from what it has used so far."""
    size = path.stat().st_size
    used = resource.getrusage(resource.RUSAGE_SELF)
    _lower(resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime + _TIME + _TIME_A_BYTE * size) + 1)
    held = _held()
    if held is not None:
        _lower(resource.RLIMIT_AS, held + _MEMORY + _MEMORY_A_BYTE * size)


def _lower(kind: int, most: int) -> None:
    hard = resource.getrlimit(kind)[1]
    # the holes of a file count in its size, which may be larger than any limit
    most = min(most, _LARGEST_LIMIT)
    resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _held() -> int | None:
    """Memory that this process has mapped, which is what the limit counts; None where the system does not say."""
    if not sys.platform.startswith("linux"):
        return None
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
