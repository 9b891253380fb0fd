"""The command that writes the report of a results file: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from bedrad.command_options import Output, compiling_told, list_files

__all__ = ["report"]


def report(
    results: Path,
    /,
    *,
    output: Output = None,
    open_: Annotated[bool, Parameter(name="--open", negative=())] = False,
) -> None:
    """Write what a results file holds as one HTML page: tables, figures, the bed in three dimensions, its provenance.

    The page is a single file that loads nothing from anywhere.

    Parameters
    ----------
    results
        The results file of a job (HDF5).
    output
        The page; beside the results file, with .html for its suffix, if not given.
    open_
        Open the page in the browser.
    """
    from bedrad.jobs.results import Results, check_writable
    from bedrad.report.page import write_page

    path = results.with_suffix(".html") if output is None else output
    check_page(path, results)
    check_writable(path)
    with compiling_told():
        write_page(Results(results), path)
    list_files([path])
    if open_:
        open_in_browser(path)


def check_page(path: Path, source: Path) -> None:
    """Refuse a page that is none by its suffix, or would take the place of its source; ValueError."""
    if path.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"{path}: suffix {path.suffix!r}; a page is written as .html")
    if path.resolve() == source.resolve():
        raise ValueError(f"{path}: is what the page is made from; name another file")


def open_in_browser(path: Path) -> None:
    """Open a page; EngineFailedError where no browser does."""
    import webbrowser

    from bedrad.errors import EngineFailedError

    if not webbrowser.open(path.resolve().as_uri()):
        raise EngineFailedError(f"no browser opened {path}; it can be opened by hand")
