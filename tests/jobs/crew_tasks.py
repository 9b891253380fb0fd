"""What the workers of the tests do; in a module of its own, which loads fast where it is unpickled."""

from __future__ import annotations

import os
import signal
from pathlib import Path


def double(common, task):
    return common, 2 * task


def die_once(folder, task):
    """Kill the worker the first time that the task 3 is tried."""
    mark = Path(folder) / "tried"
    if task == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def die_always(common, task):
    """Kill every worker that tries the task 1."""
    if task == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def fail(common, task):
    raise KeyError(task)


def wait_for(folder, task):
    """Say where we are, and wait to be ended."""
    import time

    (Path(folder) / f"pid_{os.getpid()}").touch()
    try:
        time.sleep(60)
    finally:
        (Path(folder) / "tidied").touch()
