"""The types of value that the reader takes: one that is meant, and those that convert to it without loss.

An attribute on a stage may hold a value of any type, whatever its schema says: an exporter writes double3 for float3,
a hand-written override a number for an array. USD's typed C++ getters pass over such values without a word.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Vt


class Lossy(ValueError):
    """A value does not fit into the type that is meant; str() says which."""


@dataclass(frozen=True)
class Kind:
    """A type of value."""

    name: str
    """As Sdf calls it, for messages about attributes that no schema defines."""
    exact: type
    """What Python sees of a value of this type."""
    conversions: dict[type, Callable[[Any], object]] = field(default_factory=dict)
    """From other types. They raise Lossy for a value that does not fit."""


def _numbers(exact: Any) -> Callable[[object], object]:
    """Converts arrays of numbers, or of tuples of numbers, to a Vt array."""
    empty = exact()
    dtype = np.asarray(exact(1)).dtype

    def convert(value: object) -> object:
        given = np.asarray(value)
        if not given.size:
            return empty
        with np.errstate(over="ignore", invalid="ignore"):
            converted = given.astype(dtype)
        lost = converted != given if dtype.kind in "iu" else np.isinf(converted) & ~np.isinf(np.asarray(given, float))
        if lost.any():
            raise Lossy(f"{given[lost].ravel()[0]}")
        return exact.FromNumpy(np.ascontiguousarray(converted))

    return convert


def _number_arrays(exact: type, *others: type) -> dict[type, Callable[[object], object]]:
    return dict.fromkeys(others, _numbers(exact))


def _alone(exact: type, scalars: tuple[type, ...]) -> dict[type, Callable[[object], object]]:
    """A single value as an array of one, for primvars: what is constant needs no array."""
    convert = _numbers(exact)
    return dict.fromkeys(scalars, lambda value: convert(np.asarray([value])))


def _flag(value: object) -> bool:
    if value not in (0, 1):
        raise Lossy(str(value))
    return bool(value)


def _vector(exact: type) -> Callable[[object], object]:
    def convert(value: Any) -> object:
        converted = exact(*value)
        if np.isinf(np.array(converted)).any() and not np.isinf(np.array(value, float)).any():
            raise Lossy(str(value))
        return converted

    return convert


_INTEGER_ARRAYS = (Vt.IntArray, Vt.UIntArray, Vt.Int64Array, Vt.UInt64Array, Vt.UCharArray)
_REAL_ARRAYS = (Vt.HalfArray, Vt.DoubleArray, *_INTEGER_ARRAYS)
_TRIPLES = (Gf.Vec3d, Gf.Vec3h, Gf.Vec3i)
_PAIRS = (Gf.Vec2d, Gf.Vec2h, Gf.Vec2i)
_PAIR_ARRAYS = (Vt.Vec2dArray, Vt.Vec2hArray, Vt.Vec2iArray)
_TRIPLE_ARRAYS = (Vt.Vec3dArray, Vt.Vec3hArray, Vt.Vec3iArray)

BOOL = Kind("bool", bool, {int: _flag})
INT = Kind("int", int)
FLOAT = Kind("float", float, dict.fromkeys((int, Gf.TimeCode, Gf.Duration), lambda value: float(value)))
TOKEN = Kind("token", str)
STRING = Kind("string", str)
ASSET = Kind("asset", Sdf.AssetPath)
INT2 = Kind("int2", Gf.Vec2i)
FLOAT2 = Kind("float2", Gf.Vec2f, dict.fromkeys(_PAIRS, _vector(Gf.Vec2f)))
DOUBLE2 = Kind("double2", Gf.Vec2d, dict.fromkeys((Gf.Vec2f, Gf.Vec2h, Gf.Vec2i), _vector(Gf.Vec2d)))
FLOAT3 = Kind("float3", Gf.Vec3f, dict.fromkeys(_TRIPLES, _vector(Gf.Vec3f)))
FLOAT4 = Kind("float4", Gf.Vec4f, dict.fromkeys((Gf.Vec4d, Gf.Vec4h, Gf.Vec4i), _vector(Gf.Vec4f)))
MATRIX = Kind("matrix4d", Gf.Matrix4d)
TOKENS = Kind("token[]", Vt.TokenArray, {Vt.StringArray: lambda value: Vt.TokenArray(list(value))})
INTS = Kind("int[]", Vt.IntArray, _number_arrays(Vt.IntArray, *_INTEGER_ARRAYS[1:]))
INT3S = Kind("int3[]", Vt.Vec3iArray)
INT4S = Kind("int4[]", Vt.Vec4iArray)
LONGS = Kind("int64[]", Vt.Int64Array, _number_arrays(Vt.Int64Array, *_INTEGER_ARRAYS))
FLOATS = Kind("float[]", Vt.FloatArray, _number_arrays(Vt.FloatArray, *_REAL_ARRAYS))
DOUBLES = Kind(
    "double[]", Vt.DoubleArray, _number_arrays(Vt.DoubleArray, Vt.HalfArray, Vt.FloatArray, *_INTEGER_ARRAYS)
)
DOUBLE2S = Kind("double2[]", Vt.Vec2dArray, _number_arrays(Vt.Vec2dArray, Vt.Vec2fArray, Vt.Vec2hArray, Vt.Vec2iArray))
FLOAT3S = Kind("float3[]", Vt.Vec3fArray, _number_arrays(Vt.Vec3fArray, *_TRIPLE_ARRAYS))
FLOAT4S = Kind("float4[]", Vt.Vec4fArray, _number_arrays(Vt.Vec4fArray, Vt.Vec4dArray, Vt.Vec4hArray, Vt.Vec4iArray))
HALF3S = Kind("half3[]", Vt.Vec3hArray, _number_arrays(Vt.Vec3hArray))
QUATERNIONS = Kind("quatf[]", Vt.QuatfArray, dict.fromkeys((Vt.QuathArray, Vt.QuatdArray), _numbers(Vt.QuatfArray)))
MATRICES = Kind("matrix4d[]", Vt.Matrix4dArray)
FLOAT_PRIMVAR = Kind("float[]", Vt.FloatArray, {**FLOATS.conversions, **_alone(Vt.FloatArray, (float, int))})
COLOR_PRIMVAR = Kind(
    "color3f[]", Vt.Vec3fArray, {**FLOAT3S.conversions, **_alone(Vt.Vec3fArray, (Gf.Vec3f, *_TRIPLES))}
)
COORDINATE_PRIMVAR = Kind(
    "texCoord2f[]",
    Vt.Vec2fArray,
    {**_number_arrays(Vt.Vec2fArray, *_PAIR_ARRAYS), **_alone(Vt.Vec2fArray, (Gf.Vec2f, *_PAIRS))},
)
VECTOR4_PRIMVAR = Kind(
    "color4f[]",
    Vt.Vec4fArray,
    {**FLOAT4S.conversions, **_alone(Vt.Vec4fArray, (Gf.Vec4f, Gf.Vec4d, Gf.Vec4h, Gf.Vec4i))},
)
