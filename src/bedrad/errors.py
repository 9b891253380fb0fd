"""The three errors bedrad adds to ``ValueError``: a bad file, a missing extra, a failed engine."""

from __future__ import annotations

__all__ = ["BadFileError", "EngineFailedError", "MissingExtraError"]


class BadFileError(ValueError):
    """A file cannot be read as what it should be; the message names the file and the line or field."""


class MissingExtraError(ImportError):
    """An optional dependency is not installed; the message names the command that installs it."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f'{what} is not installed; install it with: pip install "bedrad[{extra}]"')
        self.extra = extra


class EngineFailedError(RuntimeError):
    """An external engine (LAMMPS) ended with an error; the message carries the last lines of its log."""
