"""A look at a binary layer's tables before USD follows them: it allocates what a damaged one asks for.

The layout is that of OpenUSD's pxr/usd/sdf/crateFile.h, from version 0.7 on. Older files, and tables that cannot be understood,
are left to USD.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import lz4.block
import numpy as np

_MAGIC = b"PXR-USDC"
_BOOTSTRAP = struct.Struct("<8s8sq")
_SECTION = struct.Struct("<16sqq")
_COUNTED = (b"TOKENS", b"STRINGS", b"FIELDS", b"FIELDSETS", b"PATHS", b"SPECS")
"""Sections that begin with the number of their elements."""
_DENSEST = 1024
"""Elements a byte: integers take two bits at least, and LZ4 expands to at most 255 times."""
_MOST_SECTIONS = 64

_SINCE_LONG_COUNTS = (0, 7)
"""Version from which on arrays have their lengths in eight bytes."""
_ELEMENT_BYTES = np.ones(256, np.uint64)
"""Of an array in the file, by the number that its type has there: crateDataTypes.h."""
_ELEMENT_BYTES[3:31] = [4, 4, 8, 8, 2, 4, 8, 4, 4, 4, 32, 72, 128, 32, 16, 8, 16, 8, 4, 8, 24, 12, 6, 12, 32, 16, 8, 16]
_LZ4_EXPANSION = 255
"""Bytes that come of one, at most."""
_CHUNK_BYTES = 0x7E000000
"""The most that one block of LZ4 holds."""


def crate_fault(path: str) -> str:
    """What is wrong with a binary layer's sections, its paths or the lengths of its arrays, in words; empty where nothing
    is, or it is another format."""
    try:
        size = Path(path).stat().st_size
        with open(path, "rb") as file:
            head = file.read(_BOOTSTRAP.size)
            if not head.startswith(_MAGIC) or len(head) < _BOOTSTRAP.size:
                return ""
            _, version, contents = _BOOTSTRAP.unpack(head)
            if not 0 <= contents <= size - 8:
                return ""  # USD says that itself.
            file.seek(contents)
            (count,) = struct.unpack("<Q", file.read(8))
            if count > _MOST_SECTIONS:
                return f"found {count} sections, expected at most {_MOST_SECTIONS}"
            table = file.read(_SECTION.size * count)
            sections = [_SECTION.unpack_from(table, i * _SECTION.size) for i in range(len(table) // _SECTION.size)]
            named = {name.rstrip(b"\0"): (start, length) for name, start, length in sections}
            fault = _section_fault(file, named, size)
            if fault or (version[0], version[1]) < _SINCE_LONG_COUNTS:
                return fault
            return _path_fault(file, named) or _array_fault(file, named, size)
    except OSError:
        pass  # USD says what is wrong.
    return ""


def _section_fault(file: BinaryIO, sections: dict[bytes, tuple[int, int]], size: int) -> str:
    for name, (start, length) in sections.items():
        label = "".join(c if c.isprintable() else "?" for c in name.decode("ascii", "replace"))
        if start < 0 or length < 0 or start + length > size:
            return f"found a section {label} of {length} bytes at {start}, expected it inside {size} bytes"
        if name in _COUNTED and length >= 8:
            file.seek(start)
            (elements,) = struct.unpack("<Q", file.read(8))
            if elements > _DENSEST * length:
                return f"found {elements} elements in the {length} bytes of section {label}, expected fewer"
    return ""


def _path_fault(file: BinaryIO, sections: dict[bytes, tuple[int, int]]) -> str:
    """Paths that are no tree: USD follows each way to a path, of which there may be exponentially many. An element is
    followed by the next one unless its jump is -2, and by the one that a positive jump leads to."""
    jumps = _table(file, sections, b"PATHS", path_jumps).astype(np.int64)
    from_here = np.flatnonzero(jumps > 0)
    to = from_here + jumps[from_here]
    outside = np.concatenate([to[to >= len(jumps)], np.flatnonzero(jumps < -2)])
    inside, times = np.unique(to[to < len(jumps)], return_counts=True)
    twice = inside[(times > 1) | (jumps[inside - 1] != -2)]
    if len(outside):
        return f"found a sibling outside of the table of {len(jumps)} paths, expected one inside"
    if len(twice):
        return f"found {len(twice)} of {len(jumps)} paths that are reached in two ways, expected a tree"
    return ""


def _table(
    file: BinaryIO, sections: dict[bytes, tuple[int, int]], name: bytes, decoded: Callable[[bytes], np.ndarray]
) -> np.ndarray:
    """The numbers of a section; none where it is absent or cannot be decoded, which USD says itself."""
    start, length = sections.get(name, (0, 0))
    file.seek(start)
    try:
        return decoded(file.read(length))
    except (struct.error, ValueError, IndexError, OverflowError, lz4.block.LZ4BlockError):
        return np.zeros(0, np.uint64)


def path_jumps(section: bytes) -> np.ndarray:
    """int64: of each path's element, the distance to its sibling; 0: the next one is, -1: has children alone, -2: has
    neither."""
    (count,) = struct.unpack_from("<Q", section, 8)
    at = 16
    for _ in range(2):  # The numbers of the paths, and of their names.
        (compressed_bytes,) = struct.unpack_from("<Q", section, at)
        at += 8 + compressed_bytes
    (compressed_bytes,) = struct.unpack_from("<Q", section, at)
    return _integers(section[at + 8 : at + 8 + compressed_bytes], count)


def _integers(compressed: bytes, count: int) -> np.ndarray:
    """int64: what Usd_IntegerCompression has packed: the commonest difference, two bits each for how many bytes a
    difference takes (none: it is that one; 1, 2, 4), and those bytes."""
    code_bytes = (2 * count + 7) // 8
    if code_bytes > _LZ4_EXPANSION * len(compressed):
        raise ValueError(f"{len(compressed)} bytes cannot hold {count} integers")
    data = np.frombuffer(_decompressed(compressed, 4 + code_bytes + 4 * count), np.uint8)
    codes = data[4 : 4 + code_bytes]
    kinds = (codes[:, None] >> np.array([0, 2, 4, 6], np.uint8) & 3).reshape(-1)[:count]
    sizes = np.array([0, 1, 2, 4])[kinds]
    begins = 4 + code_bytes + np.concatenate([[0], np.cumsum(sizes)[:-1]])
    differences = np.full(count, data[:4].view("<i4")[0], np.int64)
    for kind, dtype in ((1, "<i1"), (2, "<i2"), (3, "<i4")):
        at = begins[kinds == kind]
        differences[kinds == kind] = data[at[:, None] + np.arange(np.dtype(dtype).itemsize)].view(dtype).reshape(-1)
    return np.cumsum(differences)


def _array_fault(file: BinaryIO, sections: dict[bytes, tuple[int, int]], size: int) -> str:
    """Arrays in the table of fields whose lengths the file cannot hold. Those inside time samples are not looked at."""
    fields = _table(file, sections, b"FIELDS", _field_values)
    is_array, is_inlined, is_compressed = ((fields >> np.uint64(bit)) & np.uint64(1) for bit in (63, 62, 61))
    places = fields & np.uint64((1 << 48) - 1)
    kept = (is_array == 1) & (is_inlined == 0) & (places > 0) & (places + np.uint64(8) <= size)
    content = np.memmap(file, np.uint8, "r")
    at = places[kept].astype(np.int64)
    counts = content[at[:, None] + np.arange(8)].view("<u8")[:, 0] if len(at) else np.zeros(0, np.uint64)
    left = np.uint64(size) - places[kept] - np.uint64(8)
    kinds = (fields[kept] >> np.uint64(48)) & np.uint64(255)
    most = np.where(is_compressed[kept] == 1, left * np.uint64(_DENSEST), left // _ELEMENT_BYTES[kinds.astype(int)])
    for found, can_be in zip(counts[counts > most].tolist(), most[counts > most].tolist(), strict=True):
        return f"found an array of {found} elements where the file has bytes for {can_be}, expected no more"
    return ""


def _field_values(section: bytes) -> np.ndarray:
    """uint64: the values of all fields, as the file has them (ValueRep)."""
    count, index_bytes = struct.unpack_from("<QQ", section)
    (value_bytes,) = struct.unpack_from("<Q", section, 16 + index_bytes)
    begin = 24 + index_bytes
    compressed = section[begin : begin + value_bytes]
    if 8 * count > _LZ4_EXPANSION * len(compressed):
        raise ValueError(f"{len(compressed)} bytes cannot hold {count} values")
    return np.frombuffer(_decompressed(compressed, 8 * count), "<u8")


def _decompressed(data: bytes, size: int) -> bytes:
    """TfFastCompression: the number of chunks, then each with its size; 0: one block alone."""
    if data[:1] == b"\0":
        return lz4.block.decompress(data[1:], uncompressed_size=size)
    whole, at = b"", 1
    for _ in range(data[0] if data else 0):
        (length,) = struct.unpack_from("<i", data, at)
        most = min(_CHUNK_BYTES, size - len(whole))
        whole += lz4.block.decompress(data[at + 4 : at + 4 + length], uncompressed_size=most)
        at += 4 + length
    return whole
