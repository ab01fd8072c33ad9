"""The one direction in which data flows: reads every #include and every Python import, and names each arrow
that runs back up, each library outside its module, and each cycle."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

MODULES = [
    "core/base",
    "core/motion",
    "core/geometry",
    "core/texture",
    "core/scene",
    "core/plan",
    "core/build",
    "core/bvh",
    "core/trace",
    "core/probe",
    "core/shade",
    "core/film",
    "core/integrate",
    "core/cost",
    "core/api",
    "delegate/translate",
    "delegate/usd/bindings",
    "delegate/hydra",
]
"""In the order in which data flows: a module includes itself and those before it."""

FRONT_ENDS = {"delegate/usd/bindings", "delegate/hydra"}
"""Side by side: neither includes the other."""

LIBRARY_HOMES = {
    "hwy/": ("core/trace/",),
    "tbb/": ("core/base/parallel.h", "core/base/parallel.cpp"),
    "oneapi/": ("core/base/parallel.h", "core/base/parallel.cpp"),
    "opensubdiv/": ("core/geometry/",),
    "nanobind/": ("delegate/usd/bindings/",),
    "Python.h": ("delegate/usd/bindings/",),
    "pxr/": ("delegate/hydra/",),
    "OpenImageIO/": ("core/texture/",),
}
"""Headers of a library, and the only places that may include them."""

PACKAGE = "delegate/usd/msbvh/"
SUBPACKAGES = [
    "base",
    "stage",
    "motion",
    "skel",
    "look",
    "camera",
    "scene",
    "render_settings",
    "output",
    "plan_report",
    "render",
    "farm",
    "motion_report",
    "accuracy_report",
    "verify",
    "conform",
    "bench",
    "accuracy",
    "hydra_info",
    "cli",
]
"""In the order in which data flows: a subpackage imports itself and those before it."""
MODULE_HOMES = {
    "click": {
        "cli.accuracy_command",
        "cli.bench_command",
        "cli.bench_options",
        "cli.budget_options",
        "cli.conform_command",
        "cli.film_options",
        "cli.frame_options",
        "cli.hydra_info_command",
        "cli.main",
        "cli.motion_command",
        "cli.noise_options",
        "cli.option_types",
        "cli.options",
        "cli.plan_command",
        "cli.record_command",
        "cli.render_options",
        "cli.reshutter_command",
        "cli.verify_command",
    },
    "tqdm": {"base.progress"},
    "lz4": {"stage.crate_check"},
    "OpenImageIO": {
        "bench.looks",
        "output.flip",
        "output.images",
        "output.reshutter",
        "look.light_texture",
        "look.texture_channel",
        "look.texture_matrix",
        "look.texture_mean",
    },
    "PyOpenColorIO": {"look.color"},
    "jinja2": {"accuracy_report.page"},
    "pyoidn": {"output.denoise"},
    "matplotlib": {
        "accuracy_report.canvas",
        "accuracy_report.labels",
        "accuracy_report.log_scale",
        "accuracy_report.plots",
    },
}
"""Python libraries, and the only modules of the package that may import them."""

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"]', re.MULTILINE)

Files = Mapping[str, str]


def module_of(path: str) -> str | None:
    return next((module for module in MODULES if path.startswith(module + "/")), None)


def include_violations(files: Files) -> Iterator[str]:
    """Lines `file includes header: reason` for C++ files, given as path -> text."""
    for file, text in files.items():
        module = module_of(file)
        for header in INCLUDE.findall(text):
            target = module_of(header)
            if module is None:
                yield f"{file}: stands in no module; expected one of {', '.join(MODULES)}"
            elif target is None and header.startswith(("core/", "delegate/")):
                yield f"{file} includes {header}: no such module"
            elif target is not None and MODULES.index(target) > MODULES.index(module):
                yield f"{file} includes {header}: against the direction, {module} comes before {target}"
            elif target in FRONT_ENDS and target != module:
                yield f"{file} includes {header}: front-ends do not know each other"
            for library, homes in LIBRARY_HOMES.items():
                if header.startswith(library) and not file.startswith(homes):
                    yield f"{file} includes {header}: only {' and '.join(homes)} may"


def module_name(file: str) -> str:
    """Of a Python file: `stage.values`, or `stage` for its __init__.py, below the package."""
    return file.removeprefix(PACKAGE).removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def imports_of(text: str, module: str) -> tuple[set[str], set[str]]:
    """What a module of our package imports: our own, as `stage.values`, perhaps with a name behind; and the top-level
    names of other libraries."""
    own: set[str] = set()
    others: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            at = ["msbvh", *module.split(".")][: -node.level] if node.level else []
            stem = ".".join([*at, *([node.module] if node.module else [])])
            names = [f"{stem}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            top, _, rest = name.partition(".")
            own.add(rest) if top == "msbvh" else others.add(top)
    return own, others


def import_violations(files: Files) -> Iterator[str]:
    """The same for the Python package's modules."""
    imports = {
        name: imports_of(text, name) for name, text in ((module_name(file), text) for file, text in files.items())
    }
    known = {module: {_longest(name, imports.keys()) for name in own} - {""} for module, (own, _) in imports.items()}
    for module, (_, others) in imports.items():
        place = module.partition(".")[0]
        if place not in SUBPACKAGES and module not in ("__init__", "__main__"):
            yield f"{module}: stands in no subpackage; expected one of {', '.join(SUBPACKAGES)}"
            continue
        for library, homes in MODULE_HOMES.items():
            if library in others and module not in homes:
                yield f"{module} imports {library}: only {', '.join(sorted(homes))} may"
        for target in sorted(known[module]):
            subpackage = target.partition(".")[0]
            if module != "__main__" and _order(subpackage) > _order(place):
                yield f"{module} imports {target}: against the direction, {place} comes before {subpackage}"
    yield from (f"import cycle: {' -> '.join(cycle)}" for cycle in cycles(known))


def _longest(name: str, modules: Iterable[str]) -> str:
    """The module that an imported name belongs to; empty for the extension's."""
    parts = name.split(".")
    starts = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    return next((start for start in starts if start in modules), "")


def _order(subpackage: str) -> int:
    return SUBPACKAGES.index(subpackage) if subpackage in SUBPACKAGES else len(SUBPACKAGES)


def cycles(graph: Mapping[str, set[str]]) -> Iterator[list[str]]:
    """Cycles of a graph, each found at least once."""
    done: set[str] = set()

    def visit(node: str, trail: list[str]) -> Iterator[list[str]]:
        if node in trail:
            yield [*trail[trail.index(node) :], node]
        elif node not in done:
            for target in sorted(graph[node]):
                yield from visit(target, [*trail, node])
            done.add(node)

    for start in sorted(graph):
        yield from visit(start, [])


def read(folder: str, *suffixes: str) -> dict[str, str]:
    paths = (path for path in (ROOT / folder).rglob("*") if path.suffix in suffixes)
    return {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in paths}


def test_includes_run_one_way() -> None:
    files = read("core", ".h", ".cpp") | read("delegate", ".h", ".cpp")
    named = {"core/base", "core/trace", "core/api", "delegate/translate", "delegate/hydra"}
    assert {module_of(file) for file in files} >= named
    assert list(include_violations(files)) == []


def test_imports_run_one_way() -> None:
    files = {file: text for file, text in read(PACKAGE, ".py").items()}
    assert {module_name(file).partition(".")[0] for file in files} > set(SUBPACKAGES)
    assert list(import_violations(files)) == []


@pytest.mark.parametrize(
    ("file", "header", "reason"),
    [
        ("core/base/vec.h", '"core/motion/track.h"', "core/base comes before core/motion"),
        ("core/build/sah.cpp", '"core/bvh/node.h"', "core/build comes before core/bvh"),
        (
            "core/api/renderer.cpp",
            '"delegate/translate/inputs.h"',
            "core/api comes before delegate/translate",
        ),
        ("core/api/accel.cpp", '"core/extra/a.h"', "no such module"),
        ("delegate/hydra/plugin.cpp", '"delegate/usd/bindings/core.h"', "front-ends do not know each other"),
        ("core/shade/sky.cpp", "<hwy/highway.h>", "only core/trace/ may"),
        ("core/build/topology.cpp", "<tbb/parallel_for.h>", "only core/base/parallel.h"),
        ("core/build/reference.cpp", "<opensubdiv/bfr/surface.h>", "only core/geometry/ may"),
        ("core/scene/validate.cpp", "<OpenImageIO/texture.h>", "only core/texture/ may"),
        ("core/scene/scene.cpp", "<pxr/usd/usd/stage.h>", "only delegate/hydra/ may"),
        ("delegate/translate/frame/shutter.h", "<pxr/pxr.h>", "only delegate/hydra/ may"),
        ("delegate/translate/translator.cpp", "<nanobind/nanobind.h>", "only delegate/usd/bindings/ may"),
        ("core/attic/old.cpp", "<vector>", "stands in no module"),
    ],
)
def test_a_planted_include_is_caught(file: str, header: str, reason: str) -> None:
    found = list(include_violations({file: f"#pragma once\n  # include {header}\n"}))
    assert len(found) == 1
    assert reason in found[0]


@pytest.mark.parametrize(
    ("modules", "reason"),
    [
        (
            {"stage/opening": "import click"},
            "stage.opening imports click: only cli.accuracy_command, cli.bench_command",
        ),
        (
            {"scene/reader": "from ..cli.main import main", "cli/main": ""},
            "scene.reader imports cli.main: against the direction, scene comes before cli",
        ),
        (
            {"scene/reader": "def f():\n    from msbvh.render.record import record", "render/record": ""},
            "scene.reader imports render.record",
        ),
        ({"scene/reader": "from ..render import record", "render/record": ""}, "scene.reader imports render.record"),
        ({"base/a": "from .. import __main__", "__main__": ""}, "base.a imports __main__"),
        ({"reader": ""}, "reader: stands in no subpackage"),
        (
            {"base/a": "from . import b", "base/b": "from .c import x", "base/c": "import msbvh.base.a"},
            "import cycle: base.a -> base.b -> base.c -> base.a",
        ),
    ],
)
def test_a_planted_import_is_caught(modules: dict[str, str], reason: str) -> None:
    files = {f"{PACKAGE}{name}.py": text for name, text in modules.items()}
    assert any(reason in line for line in import_violations(files))


def test_what_is_allowed_passes() -> None:
    includes = {
        "core/trace/kernel.cpp": '#include <hwy/highway.h>\n#include "core/bvh/layout.h"\n',
        "core/base/parallel.cpp": "#include <tbb/parallel_for.h>\n",
        "delegate/usd/bindings/core.cpp": '#include <nanobind/nanobind.h>\n#include "core/api/renderer.h"\n',
    }
    imports = {
        f"{PACKAGE}__main__.py": "from .cli.main import main\n",
        f"{PACKAGE}cli/main.py": "import click\nfrom ..render.record import record\nfrom .. import _core\n",
        f"{PACKAGE}render/__init__.py": "",
        f"{PACKAGE}render/record.py": "import os\n",
    }
    assert list(include_violations(includes)) == []
    assert list(import_violations(imports)) == []


def test_openusd_versions_are_told_apart_in_one_header() -> None:
    """All guards of the Hydra plugin are made in api_version.h; others use what it defines."""
    files = read("delegate/hydra", ".h", ".cpp")
    assert "HD_API_VERSION >= 103" in files["delegate/hydra/api_version.h"]
    guarded = [
        file
        for file, text in files.items()
        if re.search(r"^#.*(HD_API_VERSION|HDSI_API_VERSION|PXR_VERSION)", text, re.MULTILINE)
    ]
    assert guarded == ["delegate/hydra/api_version.h"]
