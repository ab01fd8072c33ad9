"""What a file says of its Cryptomattes: specification 1.2.0 (https://github.com/Psyop/Cryptomatte)."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence

import numpy as np

from .._core import name_hash

RANKS_A_LAYER = 2
Manifest = Callable[[np.ndarray], Sequence[tuple[str, int]]]
"""The names behind hashes, uint32[N]."""


def attributes(layer: str, values: np.ndarray, manifest: Manifest) -> dict[str, str]:
    """Of a layer of that name: float32[height, width, 2 * ranks] of ids and their coverage, and the names behind the ids."""
    ids = np.unique(np.ascontiguousarray(values[..., ::2]).view(np.uint32))
    names = {name: f"{found:08x}" for name, found in manifest(ids[ids != 0])}
    key = f"cryptomatte/{name_hash(layer):08x}"[: len("cryptomatte/") + 7]
    return {
        f"{key}/name": layer,
        f"{key}/hash": "MurmurHash3_32",
        f"{key}/conversion": "uint32_to_float32",
        f"{key}/manifest": json.dumps(names, separators=(",", ":"), ensure_ascii=False),
    }
