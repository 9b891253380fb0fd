"""Lines of text files: against Python's own, with every way to go through them, and what must not take long."""

from __future__ import annotations

import gzip
import io
import zlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bedrad import BadFileError, Tube, read
from bedrad.packings.files import lines as file_lines
from bedrad.packings.files import rows as file_rows
from bedrad.packings.files import text
from bedrad.packings.files.lines import Lines, open_lines
from bedrad.packings.files.text import open_bytes, shown

NOWHERE = Path("bed.txt")
TEXTS = st.lists(st.sampled_from(["", " ", "a", "STOP", "STOP it", "long " * 20, "\t"]), max_size=30)
STEPS = st.lists(st.tuples(st.sampled_from(["next", "filled", "take", "skip", "peek", "back"]), st.integers(1, 9)))


def lines_of(whole: str) -> Lines:
    return Lines(NOWHERE, io.BytesIO(whole.encode()))


@pytest.mark.parametrize("block", [1, 7, 64, 1 << 20])
@given(texts=TEXTS, ended=st.booleans(), steps=STEPS)
def test_every_way_through_a_file(block: int, texts: list[str], ended: bool, steps: list[tuple[str, int]]) -> None:
    whole = "\n".join(texts) + ("\n" if ended and texts else "")
    wanted = whole.removesuffix("\n").split("\n") if whole else []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(file_lines, "_BLOCK", block)
        lines = lines_of(whole)
        marks = [lines.mark()]
        for step, count in steps:
            at = lines.number
            left = wanted[at:]
            stop = next((k for k, line in enumerate(left) if line.startswith("STOP")), len(left))
            if step == "next":
                assert lines.next() == (left[0] if left else None)
            elif step == "filled":
                assert lines.next_filled() == next((line for line in left if line.strip()), None)
            elif step == "peek":
                assert lines.peek() == (left[0] if left else None)
                assert lines.number == at
            elif step == "take":
                taken = [line.decode() for line in lines.take(count, b"STOP")]
                assert taken == left[: len(taken)]
                assert len(taken) <= min(count, stop)
                assert taken or stop == 0
            elif step == "skip":
                assert lines.skip(count, b"STOP") == min(count, stop)
            else:
                lines.go_to(marks[count % len(marks)])
            marks.append(lines.mark())


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_line_ends_of_every_kind(tmp_path: Path, end: str, mark: str) -> None:
    path = tmp_path / "bed.csv"
    rows = ["x [m],y [m],z [m],radius [m]", "0,0,0,0.001", "# between", "0,0,1,0.002"]
    path.write_bytes((mark + end.join(rows) + end).encode())
    packing = read(path, Tube(1.0))
    assert packing.centers[:, 2].tolist() == [0.0, 1.0]
    path.write_bytes((mark + end.join([*rows, "0,0,2,wide"])).encode())
    with pytest.raises(BadFileError, match="line 5: radius is 'wide'"):
        read(path, Tube(1.0))


def test_what_utf_8_means_to_numpy(tmp_path: Path) -> None:
    # the second byte of the letter is white space in another encoding, and would make the row longer by a field
    path = tmp_path / "bed.xyz"
    path.write_text("1\nProperties=species:S:1:pos:R:3:radius:R:1\n\u00e09 1 2 3 0.5\n", encoding="utf-8")
    assert read(path, Tube(9.0)).centers.tolist() == [[1.0, 2.0, 3.0]]


@pytest.mark.parametrize("order", ["utf-16-le", "utf-16-be"])
def test_utf_16_is_named(tmp_path: Path, order: str) -> None:
    path = tmp_path / "bed.csv"
    path.write_bytes("\ufeffx [m],y [m],z [m]\n".encode(order))
    with pytest.raises(BadFileError, match=r"bed\.csv: a text in UTF-16; save it as UTF-8"):
        read(path, Tube(1.0))


def bomb(unit: bytes, start: bytes = b"", size: int = 20_000_000) -> bytes:
    """A small gzip file of a start and many times the unit."""
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    chunk = unit * ((1 << 20) // len(unit))
    return b"".join(
        [packer.compress(start), *(packer.compress(chunk) for _ in range(size // len(chunk))), packer.flush()]
    )


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.csv.gz", bomb(b"\0", b"x [m],y [m],z [m]\n"), "the gzip file unpacks to"),
        (
            "a.txt.gz",
            bomb(b"0 0 0 1\n"),
            "the gzip file unpacks to",
        ),
        ("a.txt.gz", bomb(b"\n"), "the gzip file unpacks to"),
        ("a.xyz.gz", bomb(b"0\n\n"), "no rows of spheres among the last 300000 lines"),
        ("a.yade.gz", bomb(b"#+\n", b"#format x_y_z_r\n"), "no rows of spheres among the last 300000 lines"),
        ("a.xyzr.gz", bomb(b"#\n", b"0 0 0 1\n"), "no row of numbers among the last 100000 lines"),
        (
            "a.vtk.gz",
            bomb(b"0 ", b"# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 99999999 int\n"),
            "the gz",
        ),
        (
            "a.vtp.gz",
            bomb(
                b" ",
                b'<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="9"><Points><DataArray type="Float64" '
                b'format="appended" offset="99999999999999"/></Points></Piece></PolyData><AppendedData>_',
            ),
            "the gzip file unpacks to",
        ),
    ],
)
def test_a_gzip_bomb_is_not_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, data: bytes, message: str
) -> None:
    monkeypatch.setattr(text, "_HARMLESS", 1 << 20)
    monkeypatch.setattr(file_rows, "_MOST_WITHOUT", 100_000)
    assert len(data) < 100_000
    (tmp_path / name).write_bytes(data)
    with pytest.raises(BadFileError, match=rf"a\.\w+\.gz.*{message}"):
        read(tmp_path / name, Tube(1.0))


def test_a_regular_bed_is_no_bomb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "_HARMLESS", 1 << 16)
    # a lattice with columns of zeros, as packed as dumps are
    rows = [
        f"{i} 1 {i % 97 * 1e-3:.6g} {i // 97 % 89 * 1e-3:.6g} {i // 8633 * 1e-3:.6g} 0 0 0 0 0 0 0.0005\n"
        for i in range(40_000)
    ]
    whole = "".join(rows).encode()
    path = tmp_path / "bed.dump.gz"
    path.write_bytes(gzip.compress(whole))
    with open_lines(path) as lines:
        assert lines.skip(10**18) == 40_000
    with open_bytes(path) as stream:
        assert stream.seek(len(whole) - 5) == len(whole) - 5
        assert stream.read() == whole[-5:]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.csv", "x" + " " * 4000 + "y,y,z\n1,2,3\n"),
        ("a.csv", "a" + "_a" * 4000 + "-,x,y\n1,2,3\n"),
        ("a.lmp", "t\n\n1 atoms\n\nAtoms # a" + " " * 400_000 + "b\n\n1 1\n"),
        ("a.csv", "# provenance: {\n" + "#+x\n" * 200_000 + "x [m],y [m],z [m]\n"),
        ("a.xyz", "1\n\nX 0 0 0\n" * 50_000 + "1\n"),
        ("a.dump", "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS x y z\n0 0 0\n" * 20_000 + "end"),
    ],
)
def test_what_once_took_the_square_of_its_length(tmp_path: Path, name: str, content: str) -> None:
    # each takes well below a second, and took minutes
    (tmp_path / name).write_text(content)
    with pytest.raises(BadFileError, match=rf"{name}[:,] "):
        read(tmp_path / name, Tube(1.0))


def test_texts_in_messages_are_short() -> None:
    assert shown("a 'b'\n") == "\"a 'b'\\n\""
    assert shown("x" * 10**6) == f"'{'x' * 60}'..."


@pytest.mark.parametrize("suffix", ["csv", "txt", "xyz", "dump", "lmp", "data", "restart", "yade", "vtk", "dat"])
def test_a_field_of_a_million_signs_is_one_short_line(tmp_path: Path, suffix: str) -> None:
    for content in ("1 2 3 " + "9x" * 450_000 + "\n", "x" * 900_000 + "\n", "[" * 900_000):
        (tmp_path / f"a.{suffix}").write_text(content)
        with pytest.raises(BadFileError) as caught:
            read(tmp_path / f"a.{suffix}", Tube(1.0), diameter=1.0)
        assert len(str(caught.value)) < 1000
        assert "\n" not in str(caught.value)
