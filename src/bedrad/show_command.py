"""The command that shows a bed in three dimensions: words to calls, as in `bedrad.cli`."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from bedrad.bed_options import ReadOptions
from bedrad.command_options import compiling_told, list_files
from bedrad.report_command import open_in_browser

if TYPE_CHECKING:
    from bedrad.report.pictures import Scene

__all__ = ["show"]


def show(
    file: Path,
    /,
    *,
    read_options: ReadOptions | None = None,
    layers: int | None = None,
    save: Path | None = None,
    vtp: Path | None = None,
) -> None:
    """Show a bed in three dimensions, cut open and coloured by its layers: in the browser, or in files.

    Parameters
    ----------
    file
        The packing: a file of any format of docs/formats.md, or the results of a job.
    layers
        Number of layers: the first one radius deep, the others one diameter; those of the results, or 3, if not given.
    save
        Write the picture to this file and open nothing: .png for a still one, .html for one that turns.
    vtp
        Write files for ParaView and open nothing: VTP_spheres.vtp with radius, id, layer, contact and view factor of
        each sphere, and VTP_wall.vtp.
    """
    import bedrad
    from bedrad.report.pictures import make_scene
    from bedrad.report.pictures_vtp import known_of, vtp_paths, write_vtp_files

    if save is not None and save.suffix.lower() not in (".png", ".html", ".htm"):
        raise ValueError(f"{save}: suffix {save.suffix!r}; a picture is written as .png or .html")
    targets = [] if save is None else [save]
    _check_targets(file, targets if vtp is None else [*targets, *vtp_paths(vtp)])
    bed = (read_options or ReadOptions()).read_packing(file)
    known = known_of(file)
    edges = known.edges if layers is None else bedrad.layer_edges(bed, layers)
    scene = make_scene(bed, edges, known.name)
    if vtp is not None:
        list_files(write_vtp_files(bed, scene.edges, known, vtp))
    if save is not None or vtp is None:
        _picture(scene, save)


def _check_targets(source: Path, targets: list[Path]) -> None:
    """Refuse what cannot be written, before anything is read: ValueError for its name, OSError for its place."""
    from bedrad.jobs.results import check_writable

    for path in targets:
        if path.resolve() == source.resolve():
            raise ValueError(f"{path}: is the bed itself; name another file")
        check_writable(path)


def _picture(scene: Scene, save: Path | None) -> None:
    """Write the picture where it is wanted, or into the folder for passing files and open it."""
    from bedrad.report.pictures import save_picture
    from bedrad.report.pictures_viewer import write_viewer

    path = save
    if path is None:
        path = Path(tempfile.mkdtemp(prefix="bedrad-")) / "bed.html"
    with compiling_told():
        if path.suffix.lower() == ".png":
            save_picture(scene, path)
        else:
            write_viewer(scene, path)
    list_files([path])
    if save is None:
        open_in_browser(path)
