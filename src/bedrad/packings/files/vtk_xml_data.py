"""The numbers inside VTK's XML files: text, base64 or raw bytes, in either byte order, packed or not."""

from __future__ import annotations

import binascii
import io
import lzma
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from bedrad.errors import BadFileError
from bedrad.packings.files.vtk_points import Readable, number_array, take

__all__ = ["TYPES", "Layout", "TextNumbers", "from_appended", "from_base64", "make_layout"]

TYPES = {
    "Int8": "i1",
    "UInt8": "u1",
    "Int16": "i2",
    "UInt16": "u2",
    "Int32": "i4",
    "UInt32": "u4",
    "Int64": "i8",
    "UInt64": "u8",
    "Float32": "f4",
    "Float64": "f8",
    # bytes, the texts one after the other with a zero after each
    "String": "u1",
}
"""VTK's names of the types of numbers, and NumPy's without the byte order."""

_ORDERS = {"LittleEndian": "<", "BigEndian": ">"}
_HEADERS = {"UInt32": "u4", "UInt64": "u8"}
_Unpack = Callable[[bytearray, int], bytes]

_LZMA_MEMORY = 1 << 28
_MOST = 100
"""How often the packed size points may have, as numbers of eight bytes. Points of spheres differ from each other: they
shrink to a half or a third, the most regular ones, a lattice, to a tenth (zlib). So a small file cannot claim much
memory for points that it does not hold; the other arrays have one number a point."""
_LARGEST_BLOCK = 1 << 31
_CHUNK = 1 << 20
_LONGEST_NUMBER = 4096
_RUN = re.compile(rb"[^=]+=*")


@dataclass(frozen=True)
class Layout:
    """How a file writes its binary numbers.

    Parameters
    ----------
    order : str
        The byte order as NumPy writes it.
    header : numpy.dtype
        The type of the counts before the numbers.
    packing : callable or None
        Unpacks a block to at most so many bytes; None if nothing is packed.
    """

    order: str
    header: np.dtype[Any]
    packing: _Unpack | None


def make_layout(where: str, byte_order: str, header_type: str, compressor: str) -> Layout:
    """Build the layout from the attributes of the element ``VTKFile``.

    Raises
    ------
    BadFileError
        If one of them is unknown.
    """
    if byte_order not in _ORDERS:
        raise BadFileError(f"{where}: byte_order is {byte_order[:40]!r}; expected {' or '.join(_ORDERS)}")
    if header_type not in _HEADERS:
        raise BadFileError(f"{where}: header_type is {header_type[:40]!r}; expected {' or '.join(_HEADERS)}")
    if compressor and compressor not in _PACKINGS:
        raise BadFileError(
            f"{where}: the arrays are packed with {compressor[:40]!r}, which is not read; write the file with "
            f"{' or '.join(_PACKINGS)} or without a compressor"
        )
    order = _ORDERS[byte_order]
    return Layout(order, np.dtype(order + _HEADERS[header_type]), _PACKINGS.get(compressor))


class TextNumbers:
    """Collects numbers from pieces of text that may end anywhere.

    Parameters
    ----------
    where : str
        The file and the array, for messages.
    count : int or None
        How many numbers there must be; None takes what there is.
    """

    def __init__(self, where: str, count: int | None) -> None:
        self._where = where
        self._count = count
        self._parts: list[NDArray[np.float64]] = []
        self._have = 0
        self._texts: list[str] = []
        self._length = 0

    def add(self, text: str) -> None:
        """Take one more piece of text."""
        self._texts.append(text)
        self._length += len(text)
        if self._length > _CHUNK:
            whole = "".join(self._texts)
            gap = max(whole.rfind(sign) for sign in " \n\t\r")
            if len(whole) - gap > _LONGEST_NUMBER:
                raise BadFileError(f"{self._where}: a word of more than {_LONGEST_NUMBER} characters")
            self._texts, self._length = [whole[gap + 1 :]], len(whole) - gap - 1
            self._convert(whole[: gap + 1])

    def finish(self) -> NDArray[np.float64]:
        """Return all numbers."""
        self._convert("".join(self._texts))
        if self._count is not None and self._have != self._count:
            raise BadFileError(f"{self._where}: {self._have} numbers; expected {self._count}")
        return np.concatenate(self._parts) if self._parts else np.zeros(0)

    def _convert(self, text: str) -> None:
        words = text.split()
        self._have += len(words)
        if self._count is not None and self._have > self._count:
            raise BadFileError(f"{self._where}: more than {self._count} numbers; expected {self._count}")
        try:
            self._parts.append(number_array(words))
        except ValueError as error:
            bad = words[int(error.args[0])][:40]
            raise BadFileError(f"{self._where}: {bad!r}; expected a number") from None


def from_base64(layout: Layout, where: str, text: str, kind: str, count: int | None, *, distinct: bool) -> NDArray[Any]:
    """Read numbers from the base64 text inside an array; arguments and errors as for `from_appended`."""
    try:
        signs = "".join(text.split()).encode("ascii")
    except UnicodeEncodeError:
        raise BadFileError(f"{where}: not base64") from None
    return _numbers(layout, where, _Base64(where, io.BytesIO(signs)), kind, count, distinct)


def from_appended(
    layout: Layout, where: str, stream: BinaryIO, base64: bool, kind: str, count: int | None, *, distinct: bool
) -> NDArray[Any]:
    """Read numbers from the appended data, where the stream stands.

    Parameters
    ----------
    layout : Layout
        How the numbers are written.
    where : str
        The file and the array, for messages.
    stream : binary stream
        The file.
    base64 : bool
        Whether the data are base64, else raw bytes.
    kind : str
        One of `TYPES`.
    count : int or None
        How many numbers there must be; None takes what there is.
    distinct : bool
        Whether the numbers are no long repetition.

    Raises
    ------
    BadFileError
        If there are more or fewer, or the data are damaged.
    """
    return _numbers(layout, where, _Base64(where, stream) if base64 else stream, kind, count, distinct)


def _numbers(
    layout: Layout, where: str, source: Readable, kind: str, count: int | None, distinct: bool
) -> NDArray[Any]:
    form = np.dtype(layout.order + TYPES[kind])
    wanted = None if count is None else count * form.itemsize
    if layout.packing is None:
        data = _plain(layout, where, source, wanted)
    else:
        # numbers of one byte grow to eight where they are used
        data = _unpacked(layout, layout.packing, where, source, wanted, 8 // form.itemsize if distinct else 0)
    if len(data) % form.itemsize:
        raise BadFileError(f"{where}: {len(data)} bytes are no whole number of {kind}")
    return np.frombuffer(data, dtype=form)


def _plain(layout: Layout, where: str, source: Readable, wanted: int | None) -> bytearray:
    size = _counts(layout, where, source, 1)[0]
    _check_size(where, size, wanted)
    return _exactly(where, source, size)


def _unpacked(
    layout: Layout, unpack: _Unpack, where: str, source: Readable, wanted: int | None, grown: int
) -> bytearray:
    blocks = _counts(layout, where, source, 1)[0]
    if not blocks:
        _check_size(where, 0, wanted)
        return bytearray()
    block, last = _counts(layout, where, source, 2)
    if not block:
        raise BadFileError(f"{where}: {blocks} blocks of 0 bytes; expected a positive size")
    if block > _LARGEST_BLOCK:
        raise BadFileError(f"{where}: blocks of {block} bytes; expected at most {_LARGEST_BLOCK}")
    # a last block of the same size as the others is written as 0
    if last > block:
        raise BadFileError(f"{where}: the last block has {last} bytes, the others {block}; expected fewer")
    size = (blocks - 1) * block + (last or block)
    _check_size(where, size, wanted)
    packed = _counts(layout, where, source, blocks)
    if grown * size > _MOST * sum(packed):
        raise BadFileError(f"{where}: {sum(packed)} bytes claim to be {size}, packed; expected at most 1:{_MOST}")
    data = bytearray()
    for number, length in enumerate(packed):
        expected = block if number + 1 < blocks else last or block
        try:
            # one byte more than declared shows a block that would be larger
            part = unpack(_exactly(where, source, length), expected + 1)
        except (zlib.error, lzma.LZMAError, EOFError, MemoryError) as error:
            raise BadFileError(f"{where}: block {number} is damaged ({error})") from error
        if len(part) != expected:
            raise BadFileError(f"{where}: block {number} does not unpack to the {expected} bytes that it declares")
        data += part
    return data


def _check_size(where: str, size: int, wanted: int | None) -> None:
    if wanted is not None and size != wanted:
        raise BadFileError(f"{where}: {size} bytes; the points of the piece need {wanted}")


def _counts(layout: Layout, where: str, source: Readable, count: int) -> list[int]:
    data = _exactly(where, source, count * layout.header.itemsize)
    return [int(value) for value in np.frombuffer(data, dtype=layout.header)]


def _exactly(where: str, source: Readable, count: int) -> bytearray:
    data = take(source, count)
    if len(data) < count:
        raise BadFileError(f"{where}: cut off: {len(data)} bytes of {count} are there")
    return data


def _unpack_zlib(packed: bytearray, most: int) -> bytes:
    return zlib.decompressobj().decompress(packed, most)


def _unpack_lzma(packed: bytearray, most: int) -> bytes:
    return lzma.LZMADecompressor(memlimit=_LZMA_MEMORY).decompress(packed, most)


_PACKINGS = {
    "vtkZLibDataCompressor": _unpack_zlib,
    "vtkLZMADataCompressor": _unpack_lzma,
}


class _Base64:
    """Bytes out of base64 signs: one run, or several with their own padding, as VTK writes header and data."""

    def __init__(self, where: str, signs: BinaryIO) -> None:
        self._where = where
        self._signs = signs
        self._held = b""

    def read(self, size: int, /) -> bytes:
        """Return so many bytes, fewer only at the end of the signs."""
        while len(self._held) < size:
            # never beyond what is asked for: what follows may be another array, or no base64 any more
            signs = self._signs.read(4 * -(-(size - len(self._held)) // 3))
            signs = signs[: len(signs) - len(signs) % 4]
            if not signs:
                break
            try:
                self._held += b"".join(
                    binascii.a2b_base64(run.group(), strict_mode=True) for run in _RUN.finditer(signs)
                )
            except binascii.Error as error:
                raise BadFileError(f"{self._where}: damaged base64 ({error})") from error
        data, self._held = self._held[:size], self._held[size:]
        return data
