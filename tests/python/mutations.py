"""Text layers with random faults, rendered small, many in one process: `python mutations.py FIRST COUNT` prints a line
of JSON for each. A process of its own, so that a crash or a hang costs the test a message."""

from __future__ import annotations

import json
import random
import re
import sys
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "python"))

TYPES = [
    "bool",
    "uchar",
    "int",
    "uint",
    "int64",
    "uint64",
    "half",
    "float",
    "double",
    "timecode",
    "string",
    "token",
    "asset",
    "int2",
    "half3",
    "float2",
    "float3",
    "double3",
    "float4",
    "point3f",
    "vector3f",
    "normal3f",
    "color3f",
    "quath",
    "quatf",
    "quatd",
    "matrix3d",
    "matrix4d",
    "texCoord2f",
]
NUMBERS = [
    "nan",
    "inf",
    "-inf",
    "1e30",
    "-1e30",
    "1e300",
    "3e38",
    "1e-30",
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "7",
    "0.5",
    "2147483647",
    "4294967296",
]
WORDS = ("", "garbage", "invisible", "none", "!invert!xformOp:translate", "!resetXformStack!", "caf\u00e9", "X", "/a.b")
PRIM_TYPES = [
    "Xform",
    "Mesh",
    "Cube",
    "Sphere",
    "Cone",
    "Plane",
    "PointInstancer",
    "Camera",
    "Scope",
    "SkelRoot",
    "Skeleton",
    "SkelAnimation",
    "Material",
    "Shader",
    "RectLight",
    "SphereLight",
    "DomeLight",
    "DistantLight",
    "GeomSubset",
    "BlendShape",
    "Points",
    "BasisCurves",
    "Nonsense",
]

_NUMBER = re.compile(r"(?<![\w.\"])-?\d+\.?\d*(?:[eE][-+]?\d+)?(?![\w\"])")
_TYPE = re.compile(r"(?m)^(\s*(?:custom |uniform )*)(\w+)((?:\[\])? [\w:.]+(?: =|\.timeSamples))")
_STRING = re.compile(r"\"[^\"\n]*\"")
_PRIM = re.compile(r"(?m)^(\s*)(def|over|class)( \w+)?( \")")
_TARGET = re.compile(r"<(/[^>]*)>")
_NAME = re.compile(r"(?m)^(\s*(?:custom |uniform )*[\w\[\]]+ )([\w:]+)(?= =|\.timeSamples)")


def _replace(pattern: re.Pattern, text: str, dice: random.Random, new: Callable[[re.Match], str]) -> str:
    found = list(pattern.finditer(text))
    if not found:
        return text
    match = dice.choice(found)
    return text[: match.start()] + new(match) + text[match.end() :]


def _another_type(text: str, dice: random.Random) -> str:
    return _replace(_TYPE, text, dice, lambda m: m[1] + dice.choice(TYPES) + m[3])


def _scalar_or_array(text: str, dice: random.Random) -> str:
    def flip(match: re.Match) -> str:
        rest = match[3].removeprefix("[]") if match[3].startswith("[]") else "[]" + match[3]
        return match[1] + match[2] + rest

    return _replace(_TYPE, text, dice, flip)


def _retyped(text: str, dice: random.Random) -> str:
    """Another type with a value of that type, which the parser takes."""
    values = {"int": "3", "float": "nan", "string": '"a"', "int[]": "[1, 2]", "double3": "(1, 2, 3)"}
    values["float3[]"] = "[(1, 2, 3)]"
    kind = dice.choice(list(values))
    line = re.compile(r"(?m)^(\s*(?:custom |uniform )*)[\w\[\]]+ ([\w:]+) = [^\n]*[^\[({\n]$")
    return _replace(line, text, dice, lambda m: f"{m[1]}{kind} {m[2]} = {values[kind]}")


def _number(text: str, dice: random.Random) -> str:
    return _replace(_NUMBER, text, dice, lambda _: dice.choice(NUMBERS))


def _word(text: str, dice: random.Random) -> str:
    return _replace(_STRING, text, dice, lambda _: json.dumps(dice.choice(WORDS), ensure_ascii=False))


def _prim_type(text: str, dice: random.Random) -> str:
    return _replace(_PRIM, text, dice, lambda m: f"{m[1]}{m[2]} {dice.choice(PRIM_TYPES)}{m[4]}")


def _specifier(text: str, dice: random.Random) -> str:
    return _replace(_PRIM, text, dice, lambda m: f"{m[1]}{dice.choice(('def', 'over', 'class'))}{m[3] or ''}{m[4]}")


def _target(text: str, dice: random.Random) -> str:
    others = [found[1] for found in _TARGET.finditer(text)] + ["/", "/nowhere", "/World"]
    return _replace(_TARGET, text, dice, lambda _: f"<{dice.choice(others)}>")


def _name(text: str, dice: random.Random) -> str:
    names = [found[2] for found in _NAME.finditer(text)]
    return _replace(_NAME, text, dice, lambda m: m[1] + dice.choice(names))


def _line(text: str, dice: random.Random) -> str:
    lines = text.splitlines()
    at = dice.randrange(1, len(lines))
    lines[at : at + 1] = dice.choice(([], [lines[at]] * 2))
    return "\n".join(lines)


MUTATIONS = (
    *(_another_type, _scalar_or_array, _retyped, _retyped, _number, _number),
    *(_word, _prim_type, _specifier, _target, _name, _line),
)


@cache
def corpus() -> list[tuple[str, str]]:
    """Names and texts of sound layers."""
    from every_attribute import SCENES
    from random_stages import StageMaker

    scenes = sorted((ROOT / "testenv" / "motion" / "scenes").glob("*.usda"))
    texts = [(path.name, path.read_text(encoding="utf-8")) for path in scenes]
    texts += [(f"every attribute: {name}", "#usda 1.0\n" + text) for name, text in SCENES.items()] * 4
    made = [StageMaker(seed, seed % 2 == 1) for seed in range(12)]
    texts += [(f"random stage {i}", each.stage.GetRootLayer().ExportToString()) for i, each in enumerate(made)]
    return [(name, text) for name, text in texts if len(text) < 60_000]


def mutated(seed: int) -> tuple[str, str]:
    """Where a layer comes from, and its text with one to three faults."""
    dice = random.Random(seed)
    name, text = dice.choice(corpus())
    for _ in range(dice.choice((1, 1, 1, 2, 3))):
        text = dice.choice(MUTATIONS)(text, dice)
    return name, text


def outcome(text: str) -> str:
    """drawn, unreadable (no USD any more), refused: and why, or what must not be."""
    from msbvh import _core
    from msbvh.base.crash_line import crash_line
    from msbvh.base.errors import SceneError
    from msbvh.scene.reader import ReadSettings, read_frame
    from msbvh.stage.stage_metadata import frames_per_second, start_time
    from pxr import Sdf, Tf, Usd

    layer = Sdf.Layer.CreateAnonymous(".usda")
    try:
        with crash_line(layer.identifier):
            layer.ImportFromString(text)
            stage = Usd.Stage.Open(layer)
    except Tf.ErrorException:
        return "unreadable"
    if not stage.GetPseudoRoot().GetAllChildren():
        return "unreadable"
    try:
        frame = start_time(stage) if layer.HasStartTimeCode() else 10.0
        result = read_frame(stage, frame, ReadSettings(width=24, height=16))
        frames_per_second(stage, result.diagnostics)
        [str(diagnostic) for diagnostic in result.diagnostics]
        renderer = _core.Renderer(
            result.scene, width=result.camera.width, height=result.camera.height, spp=1, threads=1
        )
        pixels = renderer.render()
    except (SceneError, _core.Error) as error:
        caught = "WRONG: USD's error is nobody's prim" if "cannot be read as USD" in str(error) else "refused"
        return f"{caught}: {error}"
    except Exception as error:
        return f"WRONG: internal error: {type(error).__name__}: {error}"
    return "drawn" if np.isfinite(pixels).all() else "WRONG: a pixel is no number"


def main(first: int, count: int) -> None:
    """A line for each seed before it is tried, and one after it."""
    warnings.simplefilter("error")  # Nobody wants numpy's on the terminal.
    for seed in range(first, first + count):
        print(json.dumps({"seed": seed}), flush=True)
        name, text = mutated(seed)
        print(json.dumps({"seed": seed, "scene": name, "outcome": outcome(text)}), flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
