"""What is watched while a hostile file is read: time, memory, files that are opened, and code that is run."""

from __future__ import annotations

import os
import resource
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

__all__ = ["LARGEST_MEMORY", "LONGEST", "Guard", "TooLongError"]

LONGEST = 5.0
"""What a case may take. [s of the processor]"""

LARGEST_MEMORY = 1 << 30
"""What a case may take beyond what the process has anyway. [bytes]"""

_HARD_LIMIT = 3 << 30
"""What the system lets the process have beyond that, so that a bomb does no harm to the machine. [bytes]"""

_NEVER = (
    *(
        "exec",
        "pickle.find_class",
        "os.system",
        "os.exec",
        "os.fork",
        "os.posix_spawn",
        "subprocess.Popen",
        "os.startfile",
    ),
    *("socket.connect", "socket.bind", "socket.getaddrinfo", "urllib.Request", "ctypes.dlopen", "ctypes.dlsym"),
)
"""What no reader does, by the names that Python's audit hooks have for it."""

_BY_MODULES = ("exec", "ctypes.dlopen", "ctypes.dlsym")
"""What modules do where they are imported."""

_CHANGES = ("os.remove", "os.rename", "os.mkdir", "os.rmdir", "os.symlink", "os.link", "os.truncate", "shutil.rmtree")


class TooLongError(BaseException):
    """A case took too long; no reader catches it."""


class Guard:
    """Watches this process; there is one, as an audit hook cannot be taken off.

    Parameters
    ----------
    folder : pathlib.Path
        The only folder in which files are opened, made or removed while it watches.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = str(folder.resolve()) + os.sep
        self._watching = False
        self.seen: list[str] = []
        sys.addaudithook(self._hook)
        signal.signal(signal.SIGPROF, self._too_long)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (used + _HARD_LIMIT, hard))
        self._base = _peak(reset=True)

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Watch what happens inside; TooLongError after `LONGEST`."""
        self.seen = []
        self._watching = True
        signal.setitimer(signal.ITIMER_PROF, LONGEST)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            self._watching = False

    def memory(self) -> int:
        """The most that was held since this was last asked for, beyond what is held anyway. [bytes]"""
        grown = _peak() - self._base
        if grown > LARGEST_MEMORY // 8:
            _peak(reset=True)
        return grown

    def _too_long(self, *_: object) -> None:
        if self._watching:
            raise TooLongError

    def _hook(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self._watching:
            return
        if event == "open":
            path, mode, flags = arguments
            writes = isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))
            if (
                isinstance(path, (str, bytes, os.PathLike))
                and not self._inside(path)
                and not _is_of_python(path, writes)
                and not _starts_the_reader()
            ):
                self.seen.append(f"opened {os.fspath(path)!r} ({mode})")
        elif event in _CHANGES and not _loads_a_module() and not _starts_the_reader():
            if not all(self._inside(each) for each in arguments[:1] if isinstance(each, (str, bytes, os.PathLike))):
                self.seen.append(f"{event} {arguments[0]!r}")
        elif event in _NEVER and not (event in _BY_MODULES and _loads_a_module()) and not _starts_the_reader():
            self.seen.append(f"{event} {str(arguments)[:200]}")

    def _inside(self, path: str | bytes | os.PathLike[Any]) -> bool:
        place = os.path.realpath(os.fsdecode(path)) + os.sep
        return place.startswith(self._folder)


def _is_of_python(path: str | bytes | os.PathLike[Any], writes: bool) -> bool:
    """Whether a file is one of the program itself, which it may read at any time."""
    name = os.path.realpath(os.fsdecode(path))
    if "/__pycache__" in name:
        # compiled modules and kernels
        return True
    source = str(Path(__file__).resolve().parents[1])
    return not writes and name.startswith(
        (sys.prefix, sys.base_prefix, source + "/src", source + "/benchmarks", "/proc/")
    )


def _loads_a_module() -> bool:
    """Whether a module is being imported, or the words of a command are taken apart, which run code of their own."""
    frame = sys._getframe(2)
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib") or "/cyclopts/" in frame.f_code.co_filename:
            return True
        frame = frame.f_back  # type: ignore[assignment]
    return False


def _starts_the_reader() -> bool:
    """Whether the process that reads HDF5 files is being started, as the one before died of a file."""
    frame = sys._getframe(2)
    while frame is not None:
        if frame.f_code.co_name == "_start" and frame.f_code.co_filename.endswith("hdf5_reader.py"):
            return True
        frame = frame.f_back  # type: ignore[assignment]
    return False


def _peak(*, reset: bool = False) -> int:
    """The most memory that the process held since the last reset. [bytes]"""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    if reset:
        Path("/proc/self/clear_refs").write_text("5")
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return peak
