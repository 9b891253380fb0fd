"""Files that are whole and still hostile: HDF5 and npz that claim, point and hide, XML entities, nested brackets."""

from __future__ import annotations

import io
import pickle
import struct
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np

__all__ = ["NAMES", "edited_hdf5", "hostile_npz", "hostile_toml", "hostile_xml"]

NAMES = (
    *("", " ", ".", "..", "/", "/etc/passwd", "/dev/zero", "../outside/canary.vtp", "../../outside/canary.vtp"),
    *(
        "..\\outside\\canary.vtp",
        "C:\\Windows\\x.vtp",
        "\\\\host\\share\\x.vtp",
        "file:///etc/passwd",
        "a\0b",
        "link.vtp",
    ),
    *(
        "%2e%2e/outside/canary.vtp",
        "sub/../../outside/canary.vtp",
        "~/x.vtp",
        "$HOME/x.vtp",
        "x" * 5000,
        "*.vtp",
        "con",
    ),
    *("fifo", "folder", "self.pvd", "\u202e.vtp", "\udcff"[:0] + "é.vtp"),
)
"""Names of files that lead elsewhere, or nowhere."""


class _Runs:
    """What a pickle would do, if anything opened it: make the folder `ran` beside the canary."""

    def __init__(self, marker: Path) -> None:
        self._marker = marker

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return Path.mkdir, (self._marker,)


def edited_hdf5(rng: Random, data: bytes, outside: Path) -> bytes:
    """An HDF5 file after one to three edits of its structure, by the library itself."""
    stream = io.BytesIO(data)
    try:
        with h5py.File(stream, "r+") as file:
            for _ in range(rng.choice((1, 1, 1, 2, 3))):
                places: list[str] = []
                file.visit(places.append)
                if places:
                    _edit(rng, file, rng.choice(places), outside)
    except (OSError, ValueError, TypeError, RuntimeError, KeyError, OverflowError):
        # what the library itself does not write is no file; what it wrote before is one
        pass
    return stream.getvalue()


def _edit(rng: Random, file: h5py.File, place: str, outside: Path) -> None:
    kind = rng.random()
    item = file.get(place)
    if kind < 0.35 and item is not None:
        _edit_attribute(rng, item, file)
        return
    if isinstance(item, h5py.Group) and rng.random() < 0.5:
        _fill_group(rng, item)
        return
    parent, name = item.parent if item is not None else file, place.rpartition("/")[2]
    held = np.asarray(item) if isinstance(item, h5py.Dataset) and item.size and item.size < 10_000 else None
    attributes = dict(item.attrs) if item is not None else {}
    del parent[name]
    if rng.random() < 0.1:
        return
    _put(rng, parent, name, held, outside)
    if name in parent and parent.get(name, getlink=True).__class__ is h5py.HardLink:
        for key, value in attributes.items():
            parent[name].attrs[key] = value


def _edit_attribute(rng: Random, item: Any, file: h5py.File) -> None:
    names = list(item.attrs)
    name = rng.choice(names) if names and rng.random() < 0.9 else rng.choice(("units", "digest", "period", "wall"))
    if name in item.attrs:
        del item.attrs[name]
    values: tuple[Any, ...] = (
        *(1, 0, -1, 2.5, float("nan"), float("inf"), 1e308, 5e-324, 2**63 - 1, True, "", "m", "tube", "rod", "plate"),
        *("a\nb\x1b[31m", "x" * 60_000, b"\xff\xfe", np.zeros((0,)), np.zeros((2, 2)), np.array([1.0, 2.0, 3.0]), 1j),
        *(h5py.Empty("f"), h5py.Empty("S4"), file.ref, np.array(["a", "b"], dtype=h5py.string_dtype()), np.float16(1)),
        *(
            np.array([(1, 2.0)], dtype=[("a", "i4"), ("b", "f8")]),
            np.longdouble(1),
            np.void(b"abc"),
            np.uint64(2**64 - 1),
        ),
        *("{" * 2000, "[" * 20_000, '{"a": 1e999}', '{"a": ' + "9" * 5000 + "}", "1" * 5000),
    )
    if rng.random() < 0.95:
        item.attrs[name] = rng.choice(values)


def _fill_group(rng: Random, group: h5py.Group) -> None:
    kind = rng.randrange(5)
    if kind == 0:
        # every level twice the one before: a walk through all of it never ends
        below = group.create_group("deep")
        for _ in range(rng.choice((3, 30, 60))):
            above, below = below, below.create_group("a")
            above["b"] = below
    elif kind == 1:
        group["itself"] = group
    elif kind == 2:
        for name in list(group)[:1]:
            for number in range(rng.choice((2, 20, 200))):
                group[f"{name}{number}"] = group[name]
    elif kind == 3:
        group.create_dataset(rng.choice(("a\nb", "x" * 1000, "..", "é\x1b")), data=1.0)
    else:
        for name in list(group)[:1]:
            for number in range(rng.choice((1, 5, 100))):
                group.create_dataset(f"{name}_{number}", (600_000, 3), dtype="f8", chunks=(1000, 3))


def _put(rng: Random, parent: h5py.Group, name: str, held: Any, outside: Path) -> None:
    """Put something else where a dataset or group was."""
    if rng.random() < 0.4:
        _put_pointer(rng, parent, name, outside)
    else:
        _put_values(rng, parent, name, held)


def _put_pointer(rng: Random, parent: h5py.Group, name: str, outside: Path) -> None:
    """Put something that leads elsewhere."""
    kind = rng.randrange(4)
    if kind == 0:
        parent[name] = h5py.SoftLink(rng.choice(("/", ".", name, "/nowhere", "/packing/centers", "../..")))
    elif kind == 1:
        target = rng.choice((str(outside / "canary.h5"), "../outside/canary.h5", "/dev/zero", "bed.h5", ""))
        parent[name] = h5py.ExternalLink(target, rng.choice(("/packing", "/packing/centers", "/", "/nowhere")))
    elif kind == 2:
        where = rng.choice(("/etc/passwd", str(outside / "canary.h5"), "nowhere"))
        parent.create_dataset(name, (5, 3), dtype="f8", external=[(where, 0, 120)])
    else:
        layout = h5py.VirtualLayout((5, 3), dtype="f8")
        layout[:] = h5py.VirtualSource(str(outside / "canary.h5"), "/packing/centers", shape=(5, 3))
        parent.create_virtual_dataset(name, layout)


def _put_values(rng: Random, parent: h5py.Group, name: str, held: Any) -> None:
    """Put other numbers, other kinds of them, or more than there are."""
    shape: Any = rng.choice(((), (0,), (0, 3), (1,), (1, 3), (5, 3), (3, 5), (5,), (2, 3, 4), (1,) * 20, None))
    kind = rng.randrange(8)
    if kind == 0 and held is not None:
        types = ("f2", "f4", "f8", ">f8", "i1", "i8", "u8", "c16", "S8", "?", np.longdouble, h5py.string_dtype())
        parent.create_dataset(name, data=held.astype(rng.choice(types), casting="unsafe"))
    elif kind == 1:
        types = (h5py.ref_dtype, h5py.regionref_dtype, h5py.vlen_dtype("f8"), "V16", h5py.enum_dtype({"a": 1}), "f8")
        parent.create_dataset(name, (5,), dtype=rng.choice((*types, np.dtype(("f8", (3,))), np.dtype([("pos", "f8")]))))
    elif kind == 2:
        count = rng.choice((100_000, 690_000, 10**7, 10**9, 2**40, 2**61))
        parent.create_dataset(name, rng.choice(((count, 3), (count,))), dtype="f8", chunks=True)
    elif kind == 3 and rng.random() < 0.1:
        values = np.zeros((rng.choice((50_000, 300_000)), 3))
        parent.create_dataset(name, data=values, chunks=True, **rng.choice(_FILTERS))
    elif kind == 4 and held is not None and held.ndim and held.dtype.kind in "fiu":
        parent.create_dataset(name, data=held, chunks=True, **rng.choice(_FILTERS))
    elif kind == 5:
        parent.create_group(name)
    elif kind == 6:
        parent[name] = np.dtype("f8")
    else:
        values = None if shape is None else np.full(shape, rng.choice((0.0, -1.0, 1e308, 5e-324, float("nan"), 1e-3)))
        parent.create_dataset(name, data=h5py.Empty("f8") if shape is None else values)


_FILTERS: tuple[dict[str, Any], ...] = (
    {"compression": "gzip", "compression_opts": 9},
    {"compression": "lzf"},
    {"shuffle": True, "fletcher32": True},
    {"compression": "gzip", "shuffle": True, "fletcher32": True},
    {"scaleoffset": 2},
)


def hostile_npz(rng: Random, data: bytes, outside: Path) -> bytes:
    """An npz file with arrays that are lies, pickles or not there."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        entries = [(info.filename, archive.read(info)) for info in archive.infolist()]
    count = rng.choice((1, 1, 2))
    for _ in range(count):
        place = rng.randrange(len(entries))
        entries[place] = _npz_entry(rng, *entries[place], outside)
    if rng.random() < 0.1:
        entries.append(rng.choice(entries))
    stream = io.BytesIO()
    method = rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2))
    with warnings.catch_warnings(), zipfile.ZipFile(stream, "w", method) as archive:
        # a name that comes twice is meant
        warnings.simplefilter("ignore")
        for name, content in entries:
            archive.writestr(zipfile.ZipInfo(name), content, method)
    return stream.getvalue()


def _npz_entry(rng: Random, name: str, content: bytes, outside: Path) -> tuple[str, bytes]:
    kind = rng.randrange(7)
    if kind == 0:
        names = ("../x.npy", "/etc/x.npy", "a/b.npy", ".npy", "radii.npy", "d.npy", "meta.npy", "positions", "x" * 300)
        return rng.choice(names), content
    if kind == 1:
        held = io.BytesIO()
        np.lib.format.write_array(held, np.array([_Runs(outside / "ran")], dtype=object), allow_pickle=True)
        return name, held.getvalue()
    if kind == 2:
        return name, pickle.dumps(_Runs(outside / "ran"))
    if kind == 3:
        shape = rng.choice(
            ("(1000000000, 3)", "(0, 3)", "(10,)", "(-1, 3)", "(" * 90 + ")" * 90, "(10**9,)", "(1e3,)", "()")
        )
        types = (
            "'<f8'",
            "'|O'",
            "'|S0'",
            "'<U9'",
            "[('a', '<f8')]",
            "'|V0'",
            "'>i2'",
            "'m8[s]'",
            "'<c16'",
            "None",
            "'x'",
        )
        order = rng.choice(("True", "False", "1"))
        text = f"{{'descr': {rng.choice(types)}, 'fortran_order': {order}, 'shape': {shape}, }}"
        return name, _header(rng, text.encode()) + content[-240:]
    if kind == 4:
        texts = (b"-" * 5000 + b"1", b"__import__('os').system('id')", b"{" * 3000, b"{'descr': 1}", b"\xff" * 100, b"")
        return name, _header(rng, rng.choice(texts)) + content[-240:]
    if kind == 5 and rng.random() < 0.05:
        held = io.BytesIO()
        np.lib.format.write_array(held, np.zeros((rng.choice((10_000, 600_000)), 3), rng.choice(("f8", "i1"))))
        return name, held.getvalue()
    text = rng.choice(
        ("{" * 50_000, "null", "[]", '{"format": "spheropack-1"}', '{"format": "spheropack-1", "container": 1}')
    )
    held = io.BytesIO()
    np.lib.format.write_array(held, np.array(text))
    return "meta.npy", held.getvalue()


def _header(rng: Random, text: bytes) -> bytes:
    version = rng.choice(((1, 0), (2, 0), (3, 0), (9, 9)))
    form = "<H" if version == (1, 0) else "<I"
    length = rng.choice((len(text), len(text), len(text) + 7, 0, 65535))
    return b"\x93NUMPY" + bytes(version) + struct.pack(form, length) + text


def hostile_xml(rng: Random, data: bytes) -> bytes:
    """A VTK file with entities, a document type, other names of files, or deep and many elements."""
    kind = rng.randrange(8)
    laughs = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 12))
    types = (
        f'<!DOCTYPE VTKFile [<!ENTITY a0 "lol">{laughs}]>',
        '<!DOCTYPE VTKFile [<!ENTITY x SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE VTKFile SYSTEM "http://localhost:9/x.dtd">',
        '<!DOCTYPE VTKFile [<!ENTITY % x SYSTEM "file:///etc/passwd"> %x;]>',
    )
    head, tag, rest = data.partition(b"<VTKFile")
    if kind == 0:
        return head + rng.choice(types).encode() + tag + rest.replace(b">", b">&a11;&x;", 1)
    if kind in (1, 2, 3):
        names = data.split(b'"')
        places = [k for k in range(1, len(names), 2) if names[k - 1].rstrip().endswith((b"file=", b"Source="))]
        if places:
            name = rng.choice(NAMES).replace("&", "").replace("<", "").replace('"', "")
            names[rng.choice(places)] = name.encode("utf-8", "replace")
        return b'"'.join(names)
    if kind == 4:
        return data.replace(b"<Piece", b"<a>" * rng.choice((10, 70, 2000)) + b"<Piece", 1)
    if kind == 5:
        piece = data[data.find(b"<Piece") : data.rfind(b"</Piece>") + 8]
        return data.replace(piece, piece * rng.choice((2, 10, 50)), 1) if piece else data
    if kind == 6:
        return (
            b'<?xml version="1.0" encoding="' + rng.choice((b"utf-16", b"rot13", b"x", b"utf-7")) + b'"?>' + tag + rest
        )
    return data.replace(b'format="ascii"', b'format="' + rng.choice((b"binary", b"appended", b"x")) + b'"')


def hostile_toml(rng: Random, data: bytes) -> bytes:
    """A job with other paths, deep nesting, or keys and values of odd kinds."""
    text = data.decode("utf-8", "replace")
    kind = rng.choice((0, 1, 2, 5)) if rng.random() < 0.9 else rng.randrange(7)
    path = rng.choice((*NAMES, "~root/.ssh/id", "bed.h5", "folder", "beds/*.h5", "/**/*", "/dev/*", "\n"))
    quoted = '"' + path.replace("\\", "\\\\").replace('"', "").replace("\0", "\\u0000").replace("\n", "\\n") + '"'
    if kind in (0, 1, 2):
        key = rng.choice(("path", "wall", "name", "output"))
        lines = [line for line in text.splitlines() if not line.startswith(key)]
        value = rng.choice((quoted, f"[{quoted}]", f"[{quoted}, {quoted}]", "[]", "{}", "1", "true", "1979-05-27"))
        lines.insert(next((k + 1 for k, line in enumerate(lines) if line == "[packing.file]"), 0), f"{key} = {value}")
        return "\n".join(lines).encode("utf-8", "replace")
    if kind == 3:
        many = rng.choice((10, 500, 5000, 50_000))
        return f"{text}\na = {rng.choice(('[', '{a=')) * many}".encode()
    if kind == 4:
        return (".".join(["a"] * rng.choice((10, 500, 3000))) + " = 1\n" + text).encode()
    if kind == 5:
        values = (
            "1" * 5000,
            "1e999",
            "nan",
            "-inf",
            "0x" + "f" * 400,
            '"""\\u0000"""',
            "[[[[1]]]]",
            "9223372036854775808",
        )
        lines = text.splitlines()
        place = rng.randrange(len(lines))
        key = lines[place].partition("=")[0]
        lines[place] = f"{key}= {rng.choice(values)}"
        return "\n".join(lines).encode()
    many = rng.choice((10, 200, 2000))
    return (text + "\n".join(f"[a{k}]\nb = {{c = {k}}}" for k in range(many))).encode()
