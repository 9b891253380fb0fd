"""Who does the units of work: this process, or processes that it starts; a cluster is in `cluster.py`."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any, Protocol, TypeVar

__all__ = ["Alone", "Crew", "LocalCrew", "Lost"]

Common = TypeVar("Common")
Task = TypeVar("Task")
Answer = TypeVar("Answer")

_STRIKES = 3
"""How often the worker of a task may be killed before the task is taken for the cause."""

_GRACE = 5.0
"""How long a worker may take to end when asked to, before it is killed. [s]"""


@dataclass(frozen=True)
class Lost:
    """In place of the answer to a task that no worker lived to give."""

    error: str


class Crew(Protocol):
    """Workers that a function is called on, one task after the other, each by whoever is free."""

    @property
    def size(self) -> int:
        """Number of workers."""

    @property
    def threads(self) -> int | None:
        """Threads that each of them may use; None for all processors."""

    def run(
        self, function: Callable[[Common, Task], Answer], common: Common, tasks: Iterable[Task]
    ) -> Iterator[tuple[int, Answer | Lost]]:
        """Yield the number of each task and the answer to it, in the order in which they come.

        Parameters
        ----------
        function : callable
            A function of a module; what it raises is an answer of the kind `Lost`.
        common : object
            Its first argument, for all tasks.
        tasks : iterable
            Its second arguments; taken when a worker is free.
        """


class Alone:
    """One worker, this process, with all processors for its rays."""

    size = 1
    threads = None

    def run(
        self, function: Callable[[Common, Task], Answer], common: Common, tasks: Iterable[Task]
    ) -> Iterator[tuple[int, Answer | Lost]]:
        """As `Crew` has it, in the order of the tasks."""
        for number, task in enumerate(tasks):
            yield number, function(common, task)


@dataclass(eq=False)
class _Worker:
    """A process, the end of the pipe to it, and the task that it has."""

    process: Any
    pipe: Connection
    number: int | None = None
    task: Any = None

    @classmethod
    def start(cls, load: str) -> _Worker:
        # a fresh interpreter: a copy of this one could hold locks of threads that the copy lacks
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs, load), daemon=True, name="bedrad worker")
        process.start()
        theirs.close()
        return cls(process, ours)

    def give(self, number: int, task: Any, message: Any) -> None:
        self.number, self.task = number, task
        # one that is dead is found by its end
        with suppress(OSError):
            self.pipe.send(message)

    def take(self) -> Any:
        """Take the answer; None if the worker died before it gave one."""
        try:
            return self.pipe.recv() if self.pipe.poll() else None
        except (EOFError, OSError):
            return None

    def end(self) -> None:
        # one that waits ends by itself when the pipe does
        self.pipe.close()
        if self.number is not None:
            self.process.terminate()
        self.process.join(_GRACE)
        if self.process.exitcode is None:
            self.process.kill()
            self.process.join()


class LocalCrew:
    """Processes on this machine; one that dies is replaced, and its task given to another.

    Parameters
    ----------
    count : int
        Number of processes.
    load : str, optional
        A module that they load while this process still gets ready.
    """

    def __init__(self, count: int, load: str = "") -> None:
        if count < 1:
            raise ValueError(f"workers is {count}; expected at least 1")
        self.size = count
        self.threads = 1
        self._load = load
        self._workers: list[_Worker] = []

    def __enter__(self) -> LocalCrew:
        try:
            for _ in range(self.size):
                self._workers.append(_Worker.start(self._load))
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        while self._workers:
            self._workers.pop().end()

    def run(
        self, function: Callable[[Common, Task], Answer], common: Common, tasks: Iterable[Task]
    ) -> Iterator[tuple[int, Answer | Lost]]:
        """As `Crew` has it."""
        waiting = enumerate(tasks)
        again: deque[tuple[int, Task]] = deque()
        strikes: dict[int, int] = {}
        while True:
            for worker in self._workers:
                if worker.number is None and (following := again.popleft() if again else next(waiting, None)):
                    worker.give(*following, (function, common, following[1]))
            busy = {worker.process.sentinel: worker for worker in self._workers if worker.number is not None}
            if not busy:
                return
            pipes = {worker.pipe: worker for worker in busy.values()}
            for ready in dict.fromkeys((pipes | busy)[end] for end in wait([*pipes, *busy])):
                number, task = ready.number, ready.task
                assert number is not None  # noqa: S101 - it is busy
                answer = ready.take()
                ready.number = ready.task = None
                if answer is not None:
                    yield number, answer[0]
                    continue
                how = self._replace(ready)
                strikes[number] = strikes.get(number, 0) + 1
                if strikes[number] < _STRIKES:
                    again.append((number, task))
                else:
                    yield number, Lost(f"its worker {how}, {_STRIKES} times; too little memory?")

    def _replace(self, worker: _Worker) -> str:
        """Put a new worker in the place of a dead one; how that ended."""
        worker.end()
        self._workers[self._workers.index(worker)] = _Worker.start(self._load)
        code = worker.process.exitcode or 0
        return (
            f"was ended by the signal {signal.Signals(-code).name}" if code < 0 else f"ended with the exit code {code}"
        )


def _serve(pipe: Connection, load: str) -> None:
    """Answer tasks until there are no more."""
    # Ctrl-C reaches the whole group: the parent decides, and ends us by SIGTERM
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _interrupt)
    threading.Thread(target=_follow_parent, daemon=True).start()
    with suppress(EOFError, OSError, KeyboardInterrupt):
        if load:
            importlib.import_module(load)
        while True:
            function, common, task = pipe.recv()
            answer: Any
            try:
                answer = function(common, task)
            except Exception as error:
                answer = Lost(f"{type(error).__name__}: {error}")
            pipe.send((answer,))


def _interrupt(*_: object) -> None:
    """End as by Ctrl-C, so that LAMMPS and temporary folders go too."""
    raise KeyboardInterrupt


def _follow_parent() -> None:
    """End with the parent, even where that is killed and cannot say so."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        parent.join(_GRACE)
