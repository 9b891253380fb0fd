"""VTK's XML files of LIGGGHTS and of VTK itself, whole and broken."""

from __future__ import annotations

import base64
import gzip
import shutil
import struct
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from bedrad import BadFileError, Tube, read
from bedrad.packings.files.contents import Contents
from bedrad.packings.files.vtk_xml import looks_like_vtk_xml, read_vtk_xml
from packings.file_mutations import mutated
from packings.vtk_samples import DATA, SMALL, plain, put


def appended(*arrays: bytes, encoding: str = "raw", offset: int | None = None, count: int = 2) -> bytes:
    """Points, radii: what the counts before them say is in the arrays."""
    offsets = (0, len(arrays[0]) if offset is None else offset)
    text = f"""<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64"><PolyData>
<Piece NumberOfPoints="{count}"><Points>
<DataArray type="Float64" Name="P" NumberOfComponents="3" format="appended" offset="{offsets[0]}"/></Points><PointData>
<DataArray type="Float64" Name="radius" format="appended" offset="{offsets[1]}"/></PointData></Piece></PolyData>
<AppendedData encoding="{encoding}">
  _"""
    return text.encode() + b"".join(arrays) + b"</AppendedData></VTKFile>"


POINTS = struct.pack("<Q6d", 48, 0, 0, 2, 0, 0, -1)
RADII = struct.pack("<Q2d", 16, 0.5, 0.25)


def packed(*numbers: float, block: int = 16, compressor: str = "vtkZLibDataCompressor") -> str:
    """SMALL with its radii in packed blocks of inline base64: header and data each a run of their own."""
    data = struct.pack(f"<{len(numbers)}d", *numbers)
    blocks = [zlib.compress(data[at : at + block]) for at in range(0, len(data), block)]
    header = struct.pack(f"<{3 + len(blocks)}I", len(blocks), block, len(data) % block, *map(len, blocks))
    text = base64.b64encode(header) + base64.b64encode(b"".join(blocks))
    return SMALL.replace('ascii">0.5 0.25', f'binary">\n {text.decode()} \n').replace(
        '"LittleEndian"', f'"LittleEndian" compressor="{compressor}"'
    )


def check_small(held: Contents) -> None:
    assert held.centers.tolist() == [[0, 0, -1], [0, 0, 2]]
    assert held.radii is not None
    assert held.radii.tolist() == [0.25, 0.5]


@pytest.mark.parametrize(
    ("name", "kind", "single"),
    [
        ("poly2000.vtp", "PolyData", True),
        ("grid2000.vtu", "UnstructuredGrid", True),
        ("parallel2000.pvtp", "PPolyData", True),
        ("parallelgrid2000.pvtu", "PUnstructuredGrid", True),
        ("vtk_text.vtp", "PolyData", False),
        ("vtk_base64.vtp", "PolyData", False),
        ("vtk_base64_lzma.vtu", "UnstructuredGrid", False),
        ("vtk_appended_raw_zlib.vtp", "PolyData", False),
        ("vtk_appended_base64_zlib.vtu", "UnstructuredGrid", False),
    ],
)
def test_files_of_programs(name: str, kind: str, single: bool) -> None:
    held, dump = read_vtk_xml(DATA / name), plain()
    # LIGGGHTS keeps the points of its VTK files in single precision
    expected = dump.centers.astype(np.float32) if single else dump.centers
    assert held.centers.tolist() == expected.tolist()
    assert held.radii is not None
    assert dump.radii is not None
    assert held.radii.tolist() == dump.radii.tolist()
    assert held.ids.tolist() == list(range(1, 13))
    assert held.provenance == {"file": name, "format": f"VTK {kind}"} | (
        {"coordinates": "single precision"} if single else {}
    )
    assert not held.states_unit


def test_content_comes_before_suffix(tmp_path: Path) -> None:
    shutil.copy(DATA / "poly2000.vtp", tmp_path / "bed.csv")
    assert len(read(tmp_path / "bed.csv", Tube(0.004))) == 12
    for name in ("poly2000.vtp", "vtk_appended_raw_zlib.vtp"):
        path = put(tmp_path, gzip.compress((DATA / name).read_bytes()), "bed.vtp.gz")
        assert read(path, Tube(0.004)).centers.tolist() == read(DATA / name, Tube(0.004)).centers.tolist()
    assert not looks_like_vtk_xml(b"<html>")


@pytest.mark.parametrize("array", ["FORCE_CHAIN_LENGTH", "FORCE_CHAIN_FN_MAG"])
def test_contacts_of_mfix_are_no_spheres(tmp_path: Path, array: str) -> None:
    with pytest.raises(BadFileError, match=f"the points are contacts .array '{array.lower()}'., not spheres"):
        read_vtk_xml(
            put(
                tmp_path,
                SMALL.replace('Name="v" NumberOfComponents="3" format="ascii">not read', f'Name="{array}">1 2'),
            )
        )


OTHER_WORDS = [
    SMALL,
    SMALL.replace(' format="ascii"', ""),
    SMALL.replace('"2" NumberOfVerts', '"   2 "  NumberOfVerts').replace("\n", "\r\n"),
    SMALL.replace('"radius" format="ascii">0.5 0.25', '"Diameter">1 0.5'),
    SMALL.replace(
        '"radius" format="ascii">0.5 0.25', '"diameter">7 7</DataArray><DataArray type="Float32" Name="Radius">0.5 0.25'
    ),
    SMALL.replace("UTF-8", "")
    .replace('<?xml version="1.0"?>', '<?xml version="1.0" encoding="UTF-16"?>')
    .encode("utf-16"),
    SMALL.encode("utf-8-sig"),
    # a point that another piece owns
    SMALL.replace('NumberOfPoints="2"', 'NumberOfPoints="3"')
    .replace("9 4<", "9 4 7<")
    .replace("0.5 0.25<", '0.5 0.25 1</DataArray><DataArray type="UInt8" Name="vtkGhostType">0 0 1<')
    .replace("0 0 -1<", "0 0 -1 5 5 5<"),
    # two pieces and an empty one
    SMALL.replace('NumberOfPoints="2"', 'NumberOfPoints="1"')
    .replace("9 4<", "9<")
    .replace("0.5 0.25<", "0.5<")
    .replace("0 0 2\n0 0 -1<", "0 0 2<")
    .replace(
        "</PolyData>",
        """<Piece NumberOfPoints="0"/><Piece NumberOfPoints="1">
<Points><DataArray type="Float64"> 0 0 -1</DataArray></Points>
<PointData><DataArray type="Int64" Name="id">4</DataArray>
<DataArray type="Float64" Name="radius">.25</DataArray></PointData>
</Piece></PolyData>""",
    ),
    appended(POINTS, RADII).replace(b"<PointData>", b'<PointData><DataArray type="UInt8" Name="ID">9 4</DataArray>'),
    appended(POINTS, RADII, b"more that nothing declares"),
    appended(base64.b64encode(POINTS), base64.b64encode(RADII), encoding="base64"),
    packed(0.5, 0.25),
    packed(0.5, 0.25, block=8),
    packed(0.5, 0.25, block=10),
    packed(0.5, 0.25, block=1000),
]


@pytest.mark.parametrize("number", range(len(OTHER_WORDS)))
def test_the_same_spheres_in_other_words(tmp_path: Path, number: int) -> None:
    content = OTHER_WORDS[number]
    assert number == 0 or content != SMALL
    held = read_vtk_xml(put(tmp_path, content))
    if held.ids is None:
        # without ids in the order of the file
        assert held.centers[:, 2].tolist() == [2, -1]
    else:
        assert held.ids.tolist() == [4, 9]
        check_small(held)


def test_ids_that_do_not_tell_spheres_apart_are_left(tmp_path: Path) -> None:
    for ids in ("3 3", "16777217 4", "1.5 2", "nan 1"):
        path = put(
            tmp_path, SMALL.replace('"Int32" Name="id" format="ascii">9 4', f'"Float32" Name="Particle_ID">{ids}')
        )
        assert read_vtk_xml(path).ids is None


def test_without_sizes(tmp_path: Path) -> None:
    path = put(tmp_path, SMALL.replace('"radius"', '"mass"'))
    with pytest.raises(BadFileError, match=r"bed\.vtp.* no .*radius or diameter"):
        read(path, Tube(1.0))
    assert read(path, Tube(1.0), diameter=0.5).radii.tolist() == [0.25, 0.25]
    with pytest.raises(BadFileError, match="4 lines or polygons and no point array radius or diameter"):
        read_vtk_xml(
            put(tmp_path, SMALL.replace('"radius"', '"mass"').replace('Verts="0"', 'Polys="3" NumberOfLines="1"'))
        )


def broken(old: str, new: str) -> str:
    assert SMALL.count(old) == 1, old
    return SMALL.replace(old, new)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            broken('"PolyData" version', '"ImageData" version'),
            ", line 2: a file of the type 'ImageData'; expected PolyData",
        ),
        (broken('type="PolyData" ', ""), ", line 2: the element VTKFile has no attribute 'type'"),
        (broken("LittleEndian", "MiddleEndian"), ": byte_order is 'MiddleEndian'; expected LittleEndian or BigEndian"),
        (
            broken("byte_order=", 'header_type="UInt8" byte_order='),
            ": header_type is 'UInt8'; expected UInt32 or UInt64",
        ),
        (broken('Points="2"', 'Points="3"'), ", line 6: array 'id': 2 numbers; expected 3"),
        (broken('Points="2"', 'Points="1"'), ", line 6: array 'id': more than 1 numbers; expected 1"),
        (broken('NumberOfPoints="2" ', ""), ", line 4: the element Piece has no attribute 'NumberOfPoints'"),
        (
            broken('Points="2"', 'Points="-2"'),
            ", line 4: NumberOfPoints of the element Piece is '-2'; expected a count",
        ),
        (broken("0.5 0.25", "0.5 big"), ", line 7: array 'radius': 'big'; expected a number"),
        (broken("0.5 0.25", "0.5"), ", line 7: array 'radius': 1 numbers; expected 2"),
        (broken("0 0 2\n", "0 0 nan\n"), r": point 0 is \(0\.0, 0\.0, nan\); expected finite numbers"),
        (broken("9 4<", "9 4.5<"), r", line 6: array 'id': 4\.5; expected integers of 32 bits"),
        (broken("9 4<", "9 9<"), ", points 0 and 1: both have the id 9"),
        (
            broken('"Float64" Name="radius"', '"Float99" Name="radius"'),
            ", line 7: array 'radius' has the type 'Float99'",
        ),
        (broken('"radius" format="ascii"', '"radius" format="hex"'), ", line 7: array 'radius' has the format 'hex'"),
        (
            broken('"radius"', '"radius" NumberOfComponents="2"'),
            ", line 7: array 'radius' has 2 numbers a point; expected 1",
        ),
        (
            broken('NumberOfComponents="3" format="ascii">0', 'NumberOfComponents="2">0'),
            ", line 11: array '' has 2 numbers a",
        ),
        (
            broken('"radius" format="ascii"', '"radius" format="appended"'),
            ", line 7: the element DataArray has no attribute 'o",
        ),
        (
            broken('"radius" format="ascii"', '"radius" format="appended" offset="0"'),
            ".*: the file has no AppendedData",
        ),
        (broken('"radius" format="ascii">0.5 0.25', '"radius" format="binary">EAA*AAA='), ".*'radius': damaged base64"),
        (broken('"radius" format="ascii">0.5 0.25', '"radius" format="binary">é'), ".*'radius': not base64"),
        (
            broken('"radius" format="ascii">0.5 0.25', '"radius" format="binary">EAAAAAAA'),
            ".*'radius': cut off: 2 bytes of 16",
        ),
        (
            broken('"radius" format="ascii">0.5 0.25', '"radius" format="binary">DAAAAAAA'),
            ".*'radius': 12 bytes; .* need 16",
        ),
        (
            broken("<Points>", "<Places>").replace("</Points>", "</Places>"),
            ": piece 0 has 2 points but no element Points",
        ),
        (broken("</Piece>", ""), ", line 15: broken XML .mismatched tag"),
        (SMALL[:500], r", line \d+: broken XML .unclosed token|no element found"),
        (
            broken('<?xml version="1.0"?>', "<VTKFiles/>"),
            ", line 1: the file begins with the element 'VTKFiles'; expected",
        ),
        (broken("?>\n", '?>\n<!DOCTYPE a [<!ENTITY b "c">]>\n'), ", line 2: a document type declaration"),
        (broken('"1.0"?>', '"1.0" encoding="utf-99"?>'), ".*XML"),
        (broken("<PolyData>", "<a>" * 70), ", line 3: more than 64 elements inside each other"),
    ],
)
def test_refusals(tmp_path: Path, content: str, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.vtp{message}"):
        read_vtk_xml(put(tmp_path, content))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (appended(POINTS, RADII)[:-40], r"'radius': cut off: \d+ bytes of 16"),
        (appended(POINTS, RADII, offset=10**9), "'radius': cut off: 0 bytes of 8 are there"),
        (appended(POINTS, RADII, offset=1), r"'radius': \d+ bytes; the points of the piece need 16"),
        (appended(POINTS, RADII, count=3), "'P': 48 bytes; the points of the piece need 72"),
        (appended(POINTS, struct.pack("<Q", 2**63) + RADII), r"'radius': 9223372036854775808 bytes; .* need 16"),
        (appended(POINTS, RADII, encoding="hex"), "encoding of AppendedData is 'hex'; expected raw or base64"),
        (appended(POINTS, RADII, encoding="base64"), "'P': (cut off|damaged base64)"),
        (appended(POINTS, RADII).replace(b"_", b""), "no underscore at the beginning of AppendedData"),
        (packed(0.5, 0.25, 0.125), "'radius': 24 bytes; the points of the piece need 16"),
        (packed(0.5, 0.25, compressor="vtkLZ4DataCompressor"), "packed with 'vtkLZ4DataCompressor', which is not read"),
        (packed(0.5, 0.25, compressor="vtkLZMADataCompressor"), "'radius': block 0 is damaged"),
    ],
)
def test_refusals_of_binary(tmp_path: Path, content: bytes | str, message: str) -> None:
    with pytest.raises(BadFileError, match=rf"bed\.vtp.*{message}"):
        read_vtk_xml(put(tmp_path, content))


def test_files_that_are_refused_by_name() -> None:
    with pytest.raises(
        BadFileError, match=r"vtk_lz4\.vtp: .*'vtkLZ4DataCompressor', which is not read; write the file"
    ):
        read(DATA / "vtk_lz4.vtp", Tube(0.004))
    with pytest.raises(
        BadFileError, match=r"polyboundingBox_2000\.vtr, line 2: a rectilinear grid, as the bounding box is"
    ):
        read(DATA / "polyboundingBox_2000.vtr", Tube(0.004))


def small_block(size: int, claimed: int, last: int = 0, blocks: int = 1) -> str:
    """SMALL with radii that unpack to `size` zeros and claim to be of other sizes."""
    data = zlib.compress(bytes(size))
    text = base64.b64encode(struct.pack("<4I", blocks, claimed, last, len(data)) + data).decode()
    return SMALL.replace('ascii">0.5 0.25', f'binary">{text}').replace(
        '"1.0" byte', '"1.0" compressor="vtkZLibDataCompressor" byte'
    )


def claiming(compressor: str, kind: str, size: int, ratio: int) -> str:
    """SMALL with a million points that claim to be packed so well."""
    data = base64.b64encode(struct.pack("<4I", 1, size, 0, size // ratio) + bytes(size // ratio)).decode()
    text = SMALL.replace('"1.0" byte', f'"1.0" compressor="{compressor}" byte').replace(
        'Points="2"', 'Points="1000000"'
    )
    text = (
        text.replace('Name="id"', 'Name="no"')
        .replace('Name="radius"', 'Name="no"')
        .replace('"Float64" Num', f'"{kind}" Num')
    )
    return text.replace('ascii">0 0 2\n0 0 -1', f'binary">{data}')


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (small_block(10**7, 16), "block 0 does not unpack to the 16 bytes that it declares"),
        (small_block(8, 16), "block 0 does not unpack to the 16 bytes"),
        (small_block(16, 0, blocks=2), "2 blocks of 0 bytes"),
        (small_block(16, 8, last=16), "the last block has 16 bytes, the others 8"),
        (small_block(16, 2**31 + 1), "blocks of 2147483649 bytes; expected at most 2147483648"),
        (small_block(16, 16, blocks=0), "'radius': 0 bytes; the points of the piece need 16"),
        # points differ from each other: so many of them do not fit into so few bytes
        (
            small_block(10, 10)
            .replace('Points="2"', 'Points="1000000"')
            .replace(
                'format="ascii">0 0 2\n0 0 -1',
                f"""format="binary">{
                    base64.b64encode(
                        struct.pack("<4I", 1, 24 * 10**6, 0, 23334) + zlib.compress(bytes(24 * 10**6))
                    ).decode()
                }""",
            )
            .replace("9 4<", "9 " * 10**6 + "<"),
            "array '': 23334 bytes claim to be 24000000, packed; expected at most 1:100",
        ),
        # bytes that grow to numbers of eight, and a packing that makes next to nothing of a repetition
        (claiming("vtkZLibDataCompressor", "Int8", 3 * 10**6, 20), "to be 3000000, packed; expected at most 1:100"),
        (claiming("vtkLZMADataCompressor", "Float64", 24 * 10**6, 200), "to be 24000000, packed; expected at most"),
        (
            appended(struct.pack("<Q", 24 * 10**16) + bytes(99), b"", count=10**16),
            "array 'P': cut off: 124 bytes of 24",
        ),
        (
            SMALL.replace('Points="2"', 'Points="99999999999999999"'),
            "array 'id': 2 numbers; expected 99999999999999999",
        ),
        (
            appended(POINTS, RADII).replace(
                b"</PolyData>",
                9
                * (
                    b'<Piece NumberOfPoints="2"><Points><DataArray type="Float64" '
                    b'format="appended" offset="0"/></Points></Piece>'
                )
                + b"</PolyData>",
            ),
            "shares its appended data with another array",
        ),
    ],
)
def test_claims_take_no_memory(tmp_path: Path, content: str | bytes, message: str) -> None:
    path = put(tmp_path, content)
    size = path.stat().st_size
    tracemalloc.start()
    try:
        with pytest.raises(BadFileError, match=message):
            read_vtk_xml(path)
        assert tracemalloc.get_traced_memory()[1] < 4e6 + 20 * size
    finally:
        tracemalloc.stop()


SAMPLES = [
    SMALL.encode(),
    appended(base64.b64encode(POINTS), base64.b64encode(RADII), encoding="base64"),
    packed(0.5, 0.25, block=8).encode(),
    *(
        (DATA / name).read_bytes()
        for name in ("poly2000.vtp", "mfix_0000.vtp", "mfix.pvd", "parallel2000.pvtp", "vtk_appended_raw_zlib.vtp")
    ),
]


@settings(max_examples=250)
@given(mutated(SAMPLES))
def test_damaged_files_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.vtp"
    path.write_bytes(data)
    try:
        held = read_vtk_xml(path)
    except BadFileError as error:
        assert str(path.parent) in str(error)  # noqa: PT017
    else:
        assert np.isfinite(held.centers).all()
        assert held.radii is None or held.radii.shape == held.centers.shape[:1]
