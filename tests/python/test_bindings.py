"""msbvh._core on its own: arrays, errors, threads and signals. Pictures are the business of other tests."""

from __future__ import annotations

import ast
import gc
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msbvh import _core

QUAD = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
IDENTITY = np.eye(4)


def translation(x: float, y: float, z: float) -> np.ndarray:
    """[4, 4], row vectors."""
    matrix = np.eye(4)
    matrix[3, :3] = (x, y, z)
    return matrix


def translator(**changes: Any) -> _core.Translator:
    """A camera 5 above the plane z = 0 that sees 10 x 10 units of it."""
    camera: dict[str, Any] = {
        "path": "/cam",
        "projection": "perspective",
        "times01": np.array([0.0]),
        "world_from_camera": translation(0, 0, 5)[None],
        "windows": np.array([[-1, 1, -1, 1]], np.float32),
        "near_clip": 0.1,
        "far_clip": 100.0,
        "width": 64,
        "height": 64,
    }
    return _core.Translator(**(camera | changes))


def mesh(**changes: Any) -> _core.MeshInput:
    """A still quad, 2 x 2 units in the plane z = 0."""
    arguments: dict[str, Any] = {
        "path": "/quad",
        "face_vertex_counts": np.array([4], np.int32),
        "face_vertex_indices": np.arange(4, dtype=np.int32),
        "left_handed": False,
        "points": [(0.0, QUAD)],
        "points_held": False,
        "transform": _core.TransformSamples(np.zeros(1), IDENTITY[None]),
        "normals_interpolation": "vertex",
        "computed_normals": "faceted",
    }
    result = _core.MeshInput()
    for name, value in (arguments | changes).items():
        setattr(result, name, value)
    return result


def quad_scene() -> _core.Scene:
    """The quad, white, under a white dome."""
    builder = translator()
    builder.add_mesh(mesh(display_color=("constant", np.ones((1, 3), np.float32), None)))
    builder.add_light(
        name="/dome",
        kind="dome",
        radiance=(1.0, 1.0, 1.0),
        angle_degrees=0.0,
        radius=0.0,
        width=0.0,
        height=0.0,
        times01=np.array([0.0]),
        world_from_light=IDENTITY[None],
    )
    return builder.finish()


def test_a_scene_is_translated_and_rendered() -> None:
    builder = translator()
    moving = _core.TransformSamples(np.array([0.0, 1.0]), np.stack([IDENTITY, translation(1, 0, 0)]))
    builder.add_mesh(mesh(transform=moving))
    prototype = builder.begin_prototype("/prototype")
    builder.add_prototype_mesh(prototype, mesh(path="/prototype/quad"))
    matrices = np.tile(IDENTITY, (1, 3, 1, 1))
    level = _core.InstanceLevel()
    level.times01, level.matrices = np.array([0.0]), matrices
    builder.add_instances(path="/instances", prototype=prototype, levels=[level])
    assert not builder.empty
    assert builder.diagnostics() == []
    moving = next(track for track in builder.tracks() if track.path == "/quad")
    assert (moving.segments, moving.moving_transform) == (1, True)
    scene = builder.finish()
    assert builder.empty
    assert scene.statistics() == {
        "meshes": 2,
        "triangles": 4,
        "spans": 0,
        "points": 0,
        "keys": 2 + 2 + 3,
        "instances": 4,
        "lights": 0,
    }

    renderer = _core.Renderer(scene, width=32, height=16, spp=4)
    image = renderer.render()
    assert (image.shape, image.dtype) == ((16, 32, 4), np.float32)
    assert ("moving instances", "/quad", "1 segment") in renderer.plan
    assert renderer.statistics["camera_rays"] == 32 * 16 * 4
    assert renderer.statistics["accel"]["triangles"] == 4


def test_alpha_is_the_quad_and_the_picture_outlives_its_renderer() -> None:
    image = _core.Renderer(quad_scene(), width=50, height=50, spp=16).render()
    gc.collect()
    assert image[..., 3].mean() == pytest.approx(2 * 2 / (10 * 10), abs=1e-3)
    assert image[25, 25, 3] == 1.0
    assert image[5, 5].tolist() == [1.0, 1.0, 1.0, 0.0]  # the dome behind it, seen but not covered


def test_motion_moves_the_picture() -> None:
    """The quad crosses its own width: a ramp from 0 to 1 and back, of the quad's area."""
    builder = translator()
    right = np.float32([1, 0, 0])
    builder.add_mesh(mesh(points=[(0.0, QUAD - right), (1.0, QUAD + right)]))
    image = _core.Renderer(builder.finish(), width=40, height=40, spp=256).render()
    row = image[20, :, 3]
    assert row.sum() == pytest.approx(8.0, rel=0.01)  # 2 units at 4 pixels a unit
    centres = (np.arange(40) + 0.5) / 4 - 5
    assert row == pytest.approx(np.clip(1 - np.abs(centres) / 2, 0, 1), abs=0.02)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"points": [(0.0, QUAD.astype(np.float64))]}, TypeError, r"points\[0\]\[1\]: found float64 .*32"),
        ({"points": [(0.0, QUAD[:, :2].copy())]}, ValueError, r"points\[0\]\[1\]: found .*\(4, 2\)"),
        ({"points": [(0.0, np.asfortranarray(QUAD))]}, ValueError, "strides"),
        ({"points": QUAD}, TypeError, "points: found"),
        ({"face_vertex_counts": [4]}, TypeError, "face_vertex_counts: found list"),
        ({"face_vertex_counts": np.array([4])}, TypeError, "face_vertex_counts: found int64"),
        ({"transform": IDENTITY}, TypeError, r"transform: found float64 array .*; expected a TransformSamples"),
        ({"display_color": ("constant", np.zeros(3, np.float32), None)}, ValueError, r"display_color\[1\]"),
        ({"display_opacity": np.zeros(1, np.float32)}, TypeError, "display_opacity: found"),
        ({"computed_normals": "round"}, ValueError, 'computed_normals: found "round"; expected faceted'),
        ({"left_handed": "no"}, TypeError, "left_handed: found str; expected a bool"),
        ({"material": -1}, TypeError, "material: found int"),
    ],
)
def test_an_argument_that_does_not_fit_is_named(changes: dict[str, Any], error: type[Exception], message: str) -> None:
    builder = translator()
    with pytest.raises(error, match=message):
        builder.add_mesh(mesh(**changes))
    assert builder.empty


@pytest.mark.parametrize("name", ["path", "face_vertex_counts", "face_vertex_indices", "points", "transform"])
def test_a_missing_attribute_is_named(name: str) -> None:
    with pytest.raises(TypeError, match=rf"^MeshInput: found no {name}$"):
        translator().add_mesh(mesh(**{name: None}))


def test_an_attribute_that_does_not_exist_is_refused() -> None:
    with pytest.raises(AttributeError, match="colour"):
        mesh(colour=1)


def test_bad_data_is_a_diagnostic_and_bad_settings_an_error() -> None:
    builder = translator()
    builder.add_mesh(mesh(face_vertex_counts=np.array([5], np.int32)))
    (diagnostic,) = builder.diagnostics()
    assert (diagnostic.severity, diagnostic.path) == ("error", "/quad")
    assert diagnostic.attribute == "faceVertexCounts"
    assert "add up to 5" in diagnostic.message
    with pytest.raises(_core.Error, match="/cam.clippingRange"):
        translator(near_clip=0.0)
    with pytest.raises(_core.Error, match="width: found 0"):
        _core.Renderer(quad_scene(), width=0, height=8)
    with pytest.raises(ValueError, match='builder: found "bvh"'):
        _core.Renderer(quad_scene(), width=8, height=8, builder="bvh")


def test_empty_meshes_are_counted() -> None:
    builder = translator()
    nothing = np.zeros(0, np.int32)
    builder.add_mesh(mesh(face_vertex_counts=nothing, face_vertex_indices=nothing, points=[]))
    assert (builder.empty_meshes, builder.diagnostics(), builder.empty) == (1, [], True)


def test_arrays_are_neither_copied_nor_kept() -> None:
    points = np.tile(QUAD, (250_000, 1))
    points.flags.writeable = False  # as Vt arrays are
    references = sys.getrefcount(points)
    builder = translator()
    builder.add_mesh(mesh(points=[(0.0, points)]))
    assert builder.diagnostics() == []
    assert sys.getrefcount(points) == references


def test_progress_is_called_on_the_calling_thread_while_others_run() -> None:
    calls: list[tuple[float, int]] = []
    ticks = 0
    finished = threading.Event()

    def count() -> None:
        nonlocal ticks
        while not finished.wait(0.001):
            ticks += 1

    other = threading.Thread(target=count)
    other.start()
    renderer = _core.Renderer(quad_scene(), width=256, height=256, spp=128, threads=1)
    renderer.render(lambda done: calls.append((done, threading.get_ident())))
    finished.set()
    other.join()
    assert ticks > 10  # the GIL was free
    assert {thread for _, thread in calls} == {threading.get_ident()}
    assert [done for done, _ in calls] == sorted(done for done, _ in calls)
    assert 0.0 <= calls[0][0] <= calls[-1][0] <= 1.0


def test_an_exception_in_progress_stops_the_render() -> None:
    renderer = _core.Renderer(quad_scene(), width=1024, height=1024, spp=4096)
    start = time.monotonic()

    def stop(done: float) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        renderer.render(stop)
    assert time.monotonic() - start < 10  # the whole would take minutes


INTERRUPTED = """
import os, signal, sys, threading
sys.path.insert(0, {tests!r})
from test_bindings import _core, large_scene, quad_scene
work = {{
    "render": lambda: _core.Renderer(quad_scene(), width=2048, height=2048, spp=4096).render,
    "build": lambda: (lambda scene: lambda: _core.Renderer(scene, width=8, height=8))(large_scene()),
}}[{work!r}]()
threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    work()
except KeyboardInterrupt:
    sys.exit(42)
"""


def large_scene() -> _core.Scene:
    """A million triangles that deform, which take seconds to build."""
    count = 500_000
    rng = np.random.default_rng(1)
    quads = (QUAD * np.float32(0.01) + rng.uniform(-5, 5, (count, 1, 3)).astype(np.float32)).reshape(-1, 3)
    builder = translator()
    builder.add_mesh(
        mesh(
            face_vertex_counts=np.full(count, 4, np.int32),
            face_vertex_indices=np.arange(4 * count, dtype=np.int32),
            points=[(0.0, quads), (1.0, quads + np.float32(0.1))],
        )
    )
    return builder.finish()


@pytest.mark.parametrize("work", ["render", "build"])
def test_ctrl_c_stops_long_work(work: str) -> None:
    code = INTERRUPTED.format(tests=str(Path(__file__).parent), work=work)
    start = time.monotonic()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 42, done.stderr
    assert time.monotonic() - start < 60


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (lambda: _core.implicit_surface("Torus", [1.0], 8), 'kind: found "Torus"; expected Sphere, Cube'),
        (lambda: _core.implicit_surface("Cone", [1.0], 8), "values: expected one for each"),
        (lambda: _core.implicit_surface("Cone", [1.0, 1.0], 3), "sides: expected at least 4"),
        (lambda: _core.unit_form("Cone", [1.0, 1.0], "W"), 'axis: found "W"; expected X, Y or Z'),
        (lambda: _core.sides_for(np.ones(2), 0.1, ()), "side_counts: found none"),
        (lambda: _core.face_materials(np.array([0, 1], np.int32), [3], None), "owners: expected numbers of subsets"),
        (lambda: _core.can_be_instances(np.zeros((1, 2, 4, 4)), np.zeros((3, 3), np.float32), None), "colors: found"),
    ],
)
def test_shapes_that_do_not_fit_are_named(call: Callable[[], object], expected: str) -> None:
    with pytest.raises(ValueError) as raised:
        call()
    assert str(raised.value).startswith(expected)


def test_instruction_sets() -> None:
    names = _core.supported_instruction_sets()
    assert names
    assert set(names) <= {"sse4", "avx2", "avx3"}


STUBS = tuple(
    f"_core{part}.pyi"
    for part in ("", "_film", "_frame", "_inputs", "_look", "_materials", "_render_spec", "_sample", "_shape")
)


def test_the_stub_names_what_there_is() -> None:
    stubs = [Path(__file__).parents[2] / "delegate/usd/msbvh" / name for name in STUBS]
    body = [node for stub in stubs for node in ast.parse(stub.read_text()).body]
    typing_only = {
        "RenderSettings", "BenchClass", "LeftOut", "Material", "MotionSource", "PoseSource",
    }  # fmt: skip
    declared = [n for n in body if isinstance(n, ast.ClassDef | ast.FunctionDef)]
    constants = {n.target.id for n in body if isinstance(n, ast.AnnAssign) and n.value is None}
    names = {n.name for n in declared} - typing_only | constants - {"__version__"}
    assert names == {name for name in dir(_core) if not name.startswith("_")}
    for node in declared:
        if isinstance(node, ast.ClassDef) and node.name not in typing_only:
            members = {n.name for n in node.body if isinstance(n, ast.FunctionDef)}
            members |= {n.targets[0].id for n in node.body if isinstance(n, ast.Assign)}
            members |= {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}
            members = {name for name in members if not name.startswith("__")}
            public = {name for name in vars(getattr(_core, node.name)) if not name.startswith("_")}
            assert members == public - ({"name", "value"} - members), node.name  # Enumerations have them.
