"""The three errors bedrad adds to ``ValueError``: a bad file, a missing extra, a failed engine."""

from __future__ import annotations

__all__ = ["BadFileError", "EngineFailedError", "MissingExtraError", "visible"]


def visible(text: str) -> str:
    """Return a text on one line, with Python's escapes for whatever cannot be printed."""
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else sign.encode("unicode_escape").decode() for sign in text)


class BadFileError(ValueError):
    """A file cannot be read as what it should be; the message names the file and the line or field.

    What stands in a file can stand in the message. Signs that steer a terminal, or that cannot be seen, are written as
    Python escapes them, but for the ends of lines, which part the problems of a job.
    """

    def __init__(self, *messages: object) -> None:
        super().__init__(*("\n".join(map(visible, str(message).split("\n"))) for message in messages))


class MissingExtraError(ImportError):
    """An optional dependency is not installed; the message names the command that installs it."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f'{what} is not installed; install it with: pip install "bedrad[{extra}]"')
        self.extra = extra


class EngineFailedError(RuntimeError):
    """An external engine (LAMMPS) ended with an error; the message carries the last lines of its log."""
