"""Units of work on a Dask cluster (extra `cluster`)."""

from __future__ import annotations

import errno
import itertools
import json
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from bedrad.errors import BadFileError, MissingExtraError
from bedrad.jobs.crew import Lost

__all__ = ["ClusterCrew"]

Common = TypeVar("Common")
Task = TypeVar("Task")
Answer = TypeVar("Answer")

_CONNECT = 20.0
"""How long the scheduler may take to answer. [s]"""

_SECONDS_A_BATCH = 2.0
"""How long the tasks that travel together should take: the scheduler takes some milliseconds for each batch, and what
a lost worker had is done again."""

_LARGEST_BATCH = 64
_AHEAD = 3
"""Batches at the scheduler for each thread of the cluster, so that none is idle, and no more, so that 10^5 units are no
burden to it."""


class ClusterCrew:
    """Workers of a Dask cluster; the units of one that is lost are done by another.

    Parameters
    ----------
    address : str
        Address of the scheduler, such as ``tcp://host:8786``, or the path of its scheduler file.

    Raises
    ------
    MissingExtraError
        If Dask is not installed.
    BadFileError
        If the file is not there, or no scheduler file.
    OSError
        If there is no such scheduler.
    """

    threads = 1

    def __init__(self, address: str) -> None:
        try:
            import distributed
        except ImportError:
            raise MissingExtraError("dask.distributed", "cluster") from None
        self._address = address
        place = _of_file(Path(address)) if ":" not in address or Path(address).is_file() else address
        try:
            self._client: Any = distributed.Client(place, timeout=_CONNECT, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = " ".join(str(error).split())[:200]
            raise OSError(errno.ECONNREFUSED, f"no Dask scheduler answers: {reason}", address) from None

    @property
    def size(self) -> int:
        """Threads of all workers that are there now, one if there is none."""
        return max(1, int(sum(self._client.nthreads().values())))

    def __enter__(self) -> ClusterCrew:
        if not self._client.nthreads():
            warnings.warn(f"{self._address}: the cluster has no workers yet; waiting for them", stacklevel=2)
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def run(
        self, function: Callable[[Common, Task], Answer], common: Common, tasks: Iterable[Task]
    ) -> Iterator[tuple[int, Answer | Lost]]:
        """As `Crew` has it; several tasks travel together where they are short."""
        from distributed import as_completed

        waiting = enumerate(tasks)
        alone: deque[tuple[int, Task]] = deque()
        held: dict[Any, list[tuple[int, Task]]] = {}
        following = as_completed(loop=self._client.loop, with_results=True, raise_errors=False)
        judged: set[int] = set()
        batch_size, seconds, done = 1, 0.0, 0

        def send(batch: list[tuple[int, Task]]) -> None:
            future = self._client.submit(_batch, function, common, [task for _, task in batch], pure=False)
            held[future] = batch
            following.add(future)

        try:
            while True:
                for _ in range(_AHEAD * self.size - len(held)):
                    batch = list(itertools.islice(waiting, batch_size))
                    if not batch:
                        break
                    send(batch)
                if not held and alone:
                    send([alone.popleft()])
                if not held:
                    return
                future, answer = next(following)
                batch = held.pop(future)
                if future.status == "finished":
                    took, answers = answer
                    seconds, done = seconds + took, done + len(batch)
                    batch_size = int(min(max(_SECONDS_A_BATCH * done / max(seconds, 1e-6), 1), _LARGEST_BATCH))
                    yield from zip((number for number, _ in batch), answers, strict=True)
                elif future.status in ("cancelled", "lost"):
                    raise OSError(errno.ECONNRESET, "the Dask scheduler is gone", self._address)
                elif batch[0][0] in judged:
                    yield batch[0][0], Lost(_reason(answer))
                else:
                    # one of them, or of others that waited at the same worker, took worker after worker down; which
                    # one shows when each is alone in the cluster
                    alone.extend(batch)
                    judged.update(number for number, _ in batch)
        finally:
            self._client.cancel(list(held))


def _of_file(path: Path) -> str:
    """Address of the scheduler that wrote a scheduler file."""
    try:
        address = json.loads(path.read_bytes())["address"]
    except FileNotFoundError:
        raise BadFileError(f"{path}: no such scheduler file, and no address such as tcp://host:8786") from None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        raise BadFileError(f"{path}: not a scheduler file of Dask") from None
    return str(address)


def _batch(function: Callable[[Any, Any], Any], common: Any, tasks: list[Any]) -> tuple[float, list[Any]]:
    """Answer several tasks, on the worker; how long that took, and the answers."""
    begin = time.perf_counter()
    answers: list[Any] = []
    for task in tasks:
        try:
            answers.append(function(common, task))
        except Exception as error:
            answers.append(Lost(f"{type(error).__name__}: {error}"))
    return time.perf_counter() - begin, answers


def _reason(answer: Any) -> str:
    """What became of a task that has no answer: as_completed gives the error with its traceback."""
    error = answer[1] if isinstance(answer, tuple) and len(answer) > 1 else answer
    text = " ".join(str(error).split())
    return f"the cluster gave up on it: {type(error).__name__}: {text[:500]}"
