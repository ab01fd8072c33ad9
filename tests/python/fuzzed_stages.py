"""Stages of every schema that is read, with attributes of right and wrong types and values, as hypothesis makes them:
`python fuzzed_stages.py FIRST COUNT` reads and renders so many and prints a line of JSON for each.

A process of its own, so that a crash or a hang costs the test a message.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from hypothesis import HealthCheck, Phase, Verbosity, given, seed, settings
from hypothesis import strategies as st

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "python"))

from fuzzed_schemas import ALL, APIS, PATHS, RELATIONSHIPS, SCHEMAS, SOUND, WORDS
from mutations import NUMBERS, TYPES, outcome

_SIZES = {"2": 2, "3": 3, "4": 4}
_numbers = st.one_of(
    st.sampled_from(("0", "1", "2", "0.5", "-1", "3", "4")),
    st.sampled_from(NUMBERS),
    st.floats(-10, 10, width=32).map(lambda value: f"{value:g}"),
)
_integers = st.one_of(st.integers(-1, 8), st.sampled_from((2147483647, 100, 65536))).map(str)
_words = st.sampled_from(WORDS).map(json.dumps)
_assets = st.sampled_from(("@@", "@nowhere.png@", "@nowhere.<UDIM>.png@", "@./a.usda@"))


def _tuples(numbers: st.SearchStrategy[str], size: int) -> st.SearchStrategy[str]:
    return st.lists(numbers, min_size=size, max_size=size).map(lambda parts: f"({', '.join(parts)})")


def _scalar(kind: str) -> st.SearchStrategy[str]:
    """Text of a value of a type without []."""
    if kind in ("token", "string"):
        return _words
    if kind == "asset":
        return _assets
    if kind == "bool":
        return st.sampled_from(("0", "1", "true"))
    if kind.startswith("matrix"):
        size = int(kind[6])
        sound = [f"({', '.join(str(int(r == c)) for c in range(size))})" for r in range(size)]
        return st.one_of(
            st.just(f"({', '.join(sound)})"),
            st.lists(_tuples(_numbers, size), min_size=size, max_size=size).map(lambda rows: f"({', '.join(rows)})"),
        )
    if kind.startswith("quat"):
        return st.one_of(st.just("(1, 0, 0, 0)"), _tuples(_numbers, 4))
    base = kind.rstrip("234fhdi")
    numbers = _integers if base.startswith(("int", "u", "i")) else _numbers
    for digit, size in _SIZES.items():
        if digit in kind and kind not in ("int64", "uint64"):
            return _tuples(numbers, size)
    return numbers


def _value(kind: str) -> st.SearchStrategy[str]:
    if not kind.endswith("[]"):
        return _scalar(kind)
    return st.lists(_scalar(kind.removesuffix("[]")), max_size=5).map(lambda parts: f"[{', '.join(parts)}]")


@st.composite
def _attribute(draw: st.DrawFn, declaration: str) -> tuple[str, str]:
    """Name, and the line that authors it: by default or in time, now and then of another type."""
    *head, kind, name = declaration.split()
    if draw(st.integers(0, 7)) == 7:
        kind = draw(st.sampled_from(TYPES)) + draw(st.sampled_from(("", "[]")))
    start = " ".join([*head, kind, name])
    if draw(st.integers(0, 3)) == 0:
        times = draw(
            st.lists(st.one_of(st.integers(8, 12), st.floats(9, 11, width=32)), min_size=1, max_size=4, unique=True)
        )
        samples = ", ".join(f"{time:g}: {draw(st.one_of(_value(kind), st.just('None')))}" for time in sorted(times))
        return name, f"{start}.timeSamples = {{ {samples} }}"
    line = f"{start} = {draw(_value(kind))}"
    if name.startswith("primvars:") and draw(st.booleans()):
        line += f" (interpolation = {draw(_words)})"
    return name, line


@st.composite
def _relationship(draw: st.DrawFn) -> tuple[str, str]:
    name = draw(st.sampled_from(RELATIONSHIPS))
    targets = draw(st.lists(st.sampled_from(PATHS), min_size=1, max_size=3, unique=True))
    return name, f"rel {name} = [{', '.join(f'<{path}>' for path in targets)}]"


@st.composite
def _prim(draw: st.DrawFn, name: str, depth: int) -> str:
    kind = draw(st.sampled_from(sorted(SCHEMAS)))
    lines = {declaration.split()[-1]: f"{declaration} = {value}" for declaration, value in SOUND.get(kind, {}).items()}
    declarations = SCHEMAS[kind] + ALL
    for declaration in draw(st.lists(st.sampled_from(declarations), max_size=5, unique=True)):
        attribute, line = draw(_attribute(declaration))
        lines[attribute] = line
    for attribute, line in draw(st.lists(_relationship(), max_size=2)):
        lines[attribute] = line
    if "xformOpOrder" not in lines:
        ops = [each for each in lines if each.startswith("xformOp:")]
        lines["xformOpOrder"] = f"uniform token[] xformOpOrder = {json.dumps(ops)}"
    if kind == "PointInstancer" and "prototypes" not in lines:
        lines["prototypes"] = "rel prototypes = [</World/P0/Child>]"
    apis = draw(st.lists(st.sampled_from(APIS), max_size=2, unique=True))
    head = [f"prepend apiSchemas = {json.dumps(apis)}"] if apis else []
    if draw(st.integers(0, 9)) == 9:
        head.append("instanceable = true")
        head.append(f"references = <{draw(st.sampled_from(('/World/P0', '/World/P1', '/Looks/Red')))}>")
    specifier = draw(st.sampled_from(("def",) * 6 + ("over", "class")))
    children = "" if depth == 0 else draw(_children(depth - 1))
    body = "\n".join([*lines.values(), children])
    return f'{specifier} {kind} "{name}" ({"; ".join(head)}) {{\n{body}\n}}'


@st.composite
def _children(draw: st.DrawFn, depth: int) -> str:
    number = draw(st.sampled_from((0, 1, 1, 2)))
    return "\n".join(draw(_prim("Child" if i == 0 else f"Other{i}", depth)) for i in range(number))


_CAMERA = """
def Camera "Cam" {
    double3 xformOp:translate = (0, 0, 20)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    double shutter:open = -0.5
    double shutter:close = 0.5
}
"""
_LOOKS = """
def Scope "Looks" {
    def Material "Red" {
        token outputs:surface.connect = </Looks/Red/Surface.outputs:surface>
        def Shader "Surface" {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (1, 0, 0)
            token outputs:surface
        }
    }
}
"""


@st.composite
def stages(draw: st.DrawFn) -> str:
    """Text of a layer."""
    header = []
    for name in ("timeCodesPerSecond", "startTimeCode", "metersPerUnit", "endTimeCode"):
        if draw(st.integers(0, 9)) == 9:
            header.append(f"{name} = {draw(_numbers)}")
    prims = [draw(_prim(f"P{i}", 2)) for i in range(draw(st.integers(1, 3)))]
    world = 'def Xform "World" {\n' + "\n".join(prims) + "\n}"
    return f"#usda 1.0\n({'; '.join(header)})\n{_CAMERA}{_LOOKS}{world}\n"


def check(text: str) -> str:
    """drawn, refused or unreadable. Raises AssertionError for anything else, and for a refusal of several lines."""
    found = outcome(text)
    assert not found.startswith("WRONG"), found
    assert found == "drawn" or "\n" not in found, found
    return found.partition(":")[0]


@settings(deadline=None, database=None, suppress_health_check=list(HealthCheck))
@given(stages())
def _any_stage(text: str) -> None:
    check(text)


def one_input(data: bytes) -> None:
    """The stage that the bytes stand for: of a fuzzer."""
    _any_stage.hypothesis.fuzz_one_input(data)


def main(first: int, count: int) -> None:
    """A line for each stage; the last one says what is wrong, with the smallest stage for which it is."""
    number, failing = 0, ""

    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        verbosity=Verbosity.quiet,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
    @seed(first)
    @given(stages())
    def read_and_render(text: str) -> None:
        nonlocal number, failing
        print(json.dumps({"seed": first + number}), flush=True)
        try:
            kind = check(text)
        except AssertionError:
            failing = text  # The last one is the smallest.
            raise
        print(json.dumps({"seed": first + number, "outcome": kind}), flush=True)
        number += 1

    try:
        read_and_render()
    except AssertionError as wrong:
        print(json.dumps({"seed": first, "outcome": str(wrong), "stage": failing}), flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
