"""A look at a binary layer's table of contents before USD follows it: it allocates what a damaged one asks for."""

from __future__ import annotations

import struct
from pathlib import Path

_MAGIC = b"PXR-USDC"
_BOOTSTRAP = struct.Struct("<8s8sq")
_SECTION = struct.Struct("<16sqq")
_COUNTED = (b"TOKENS", b"STRINGS", b"FIELDS", b"FIELDSETS", b"PATHS", b"SPECS")
"""Sections that begin with the number of their elements."""
_DENSEST = 1024
"""Elements a byte: integers take two bits at least, and LZ4 expands to at most 255 times."""
_MOST_SECTIONS = 64


def crate_fault(path: str) -> str:
    """What is wrong with a binary layer's sections, in words; empty where nothing is, or it is another format."""
    try:
        size = Path(path).stat().st_size
        with open(path, "rb") as file:
            head = file.read(_BOOTSTRAP.size)
            if not head.startswith(_MAGIC) or len(head) < _BOOTSTRAP.size:
                return ""
            _, _, contents = _BOOTSTRAP.unpack(head)
            if not 0 <= contents <= size - 8:
                return ""  # USD says that itself.
            file.seek(contents)
            (count,) = struct.unpack("<Q", file.read(8))
            if count > _MOST_SECTIONS:
                return f"found {count} sections, expected at most {_MOST_SECTIONS}"
            table = file.read(_SECTION.size * count)
            sections = [_SECTION.unpack_from(table, i * _SECTION.size) for i in range(len(table) // _SECTION.size)]
            for name, start, length in sections:
                name = name.rstrip(b"\0")
                label = name.decode("ascii", "replace")
                if start < 0 or length < 0 or start + length > size:
                    return f"found a section {label} of {length} bytes at {start}, expected it inside {size} bytes"
                if name in _COUNTED and length >= 8:
                    file.seek(start)
                    (elements,) = struct.unpack("<Q", file.read(8))
                    if elements > _DENSEST * length:
                        return f"found {elements} elements in the {length} bytes of section {label}, expected fewer"
    except OSError:
        pass  # USD says what is wrong.
    return ""
