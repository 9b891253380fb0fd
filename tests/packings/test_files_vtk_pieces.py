"""VTK's parallel files and collections, whose pieces are files beside them."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from bedrad import BadFileError, Tube, read
from bedrad.packings.files import read_frames
from bedrad.packings.files.vtk_xml import iterate_vtk_xml, read_vtk_xml
from packings.vtk_samples import DATA, SMALL, collection, plain, put


def test_a_trajectory_in_the_form_of_mfix() -> None:
    dump = plain()
    first, second = iterate_vtk_xml(DATA / "mfix.pvd")
    assert first.centers.tolist() == dump.centers.astype(np.float32).tolist()
    assert second.centers.tolist() == (dump.centers + np.array([0, 0, -1e-4])).astype(np.float32).tolist()
    assert first.radii is not None
    assert dump.radii is not None
    # the file has the diameters in single precision
    assert first.radii.tolist() == (np.float32(2 * dump.radii).astype(float) / 2).tolist()
    assert second.provenance == {
        "file": "mfix.pvd",
        "format": "VTK collection",
        "frame": 1,
        "time": 0.005,
        "coordinates": "single precision",
    }
    assert read_vtk_xml(DATA / "mfix.pvd", 0).centers.tolist() == first.centers.tolist()
    assert read_vtk_xml(DATA / "mfix.pvd", -1).centers.tolist() == second.centers.tolist()
    assert [len(packing) for packing in read_frames(DATA / "mfix.pvd", Tube(0.004))] == [12, 12]
    for frame in (2, -3):
        with pytest.raises(BadFileError, match=f"frame {frame} was asked for; the file has 2, counted from 0"):
            read_vtk_xml(DATA / "mfix.pvd", frame)


def parallel(*names: str, kind: str = "PPolyData") -> str:
    pieces = "".join(f'<Piece Source="{name}"/>' for name in names)
    return f'<VTKFile type="{kind}" byte_order="BigEndian"><{kind}>{pieces}</{kind}></VTKFile>'


@pytest.mark.parametrize("form", [parallel, collection])
@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["../bed.vtp"], r"whole\.xml: names the file '\.\./bed\.vtp'; expected one in the folder of this file"),
        (["a/../../bed.vtp"], "expected one in the folder of this file"),
        (["..\\bed.vtp"], "expected one in the folder of this file"),
        (["/etc/passwd"], "names the file '/etc/passwd'; expected one in the folder"),
        (["C:\\bed.vtp"], "expected one in the folder of this file"),
        (["link.vtp"], "names the file 'link.vtp'; expected one in the folder of this file"),
        ([" "], "names the file ''; expected one in the folder"),
        (["missing.vtp"], r"missing\.vtp: no such file"),
        (["."], "names the file '.'; expected one in the folder|is a folder"),
        (["bad.vtp"], r"bad\.vtp, line 1: broken XML"),
        (
            ["whole.xml"],
            "whole.xml: (holds PPolyData; whole.xml expects PolyData|the file 'whole.xml' is a collection too)",
        ),
    ],
)
def test_files_beside_it_that_are_refused(tmp_path: Path, form: object, names: list[str], message: str) -> None:
    outside = put(tmp_path, SMALL)
    folder = tmp_path / "folder"
    folder.mkdir()
    put(folder, "<", "bad.vtp")
    (folder / "link.vtp").symlink_to(outside)
    path = put(folder, form(*names), "whole.xml")  # type: ignore[operator]
    with pytest.raises(BadFileError, match=message):
        read_vtk_xml(path, 0)


def test_pieces_that_do_not_fit_together(tmp_path: Path) -> None:
    put(tmp_path, SMALL, "a.vtp")
    put(tmp_path, SMALL.replace('"radius"', '"mass"').replace("9 4", "1 2"), "b.vtp")
    put(tmp_path, SMALL.replace('"radius"', '"diameter"').replace("9 4", "1 2"), "c.vtp")
    for names, message in (
        (("a.vtp", "a.vtp"), r"bed\.pvtp: names the file 'a\.vtp' twice"),
        (("a.vtp", "./a.vtp"), r"bed\.pvtp: names the file '\./a\.vtp' twice"),
        (("a.vtp", "b.vtp"), r"b\.vtp, piece 0: no point array radius or diameter, which .*a\.vtp, piece 0 has"),
        (("a.vtp", "c.vtp"), r"a\.vtp, piece 0: some pieces have radii and others diameters"),
    ):
        with pytest.raises(BadFileError, match=message):
            read_vtk_xml(put(tmp_path, parallel(*names), "bed.pvtp"))
    with pytest.raises(BadFileError, match=r"a\.vtp: holds PolyData; bed\.pvtu expects UnstructuredGrid"):
        read_vtk_xml(put(tmp_path, parallel("a.vtp", kind="PUnstructuredGrid"), "bed.pvtu"))
    with pytest.raises(BadFileError, match="a collection of no files"):
        read_vtk_xml(put(tmp_path, collection(), "bed.pvd"))
    with pytest.raises(BadFileError, match="timestep is 'x'; expected a finite number"):
        read_vtk_xml(put(tmp_path, collection("a.vtp", times="x"), "bed.pvd"))


def test_a_time_in_several_parts_and_folders(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    put(tmp_path, SMALL, "a.vtp")
    put(tmp_path / "deep", SMALL.replace("9 4", "1 2").replace("0 0 2", "0 0 5"), "b.vtp")
    put(tmp_path / "deep", parallel("b.vtp"), "b.pvtp")
    path = put(tmp_path, collection("a.vtp", "deep/b.pvtp", "deep\\b.vtp", times="003"), "bed.pvd")
    first, second = iterate_vtk_xml(path)
    assert first.ids.tolist() == [1, 2, 4, 9]
    assert first.centers[:, 2].tolist() == [5, -1, -1, 2]
    assert (len(second.centers), second.provenance["time"]) == (2, 3.0)


@pytest.mark.parametrize("name", ["a&#10;b.vtp", "&#x9b;31m.vtp", "x" * 501])
def test_names_that_cannot_be_shown_are_not_followed(tmp_path: Path, name: str) -> None:
    (tmp_path / "a.pvd").write_text(collection(name))
    with pytest.raises(BadFileError, match=r"a\.pvd: names the file '.{1,100}'; expected one in the folder") as caught:
        read(tmp_path / "a.pvd", Tube(1.0))
    assert str(caught.value).isprintable()


def test_a_pipe_among_the_pieces_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "b.vtp")
    (tmp_path / "a.pvd").write_text(collection("b.vtp"))
    with pytest.raises(BadFileError, match=r"b\.vtp: a pipe or device; expected a file"):
        read(tmp_path / "a.pvd", Tube(1.0))
