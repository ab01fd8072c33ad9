"""msbvh bench --frames: its scenes, what it measures, what makes a comparison void, and what it refuses."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Fails, Run
from msbvh.base.errors import SceneError
from msbvh.bench import cycles_peer, frame_sides
from msbvh.bench.cycles_peer import Cycles, find_cycles, installed, usual_folder
from msbvh.bench.cycles_script import phases
from msbvh.bench.frame_noise import Picture, likeness, noise
from msbvh.bench.frame_scenes import SCENES
from msbvh.bench.frame_sides import Job, old_build, rendered, this_build
from msbvh.bench.frames import FrameSettings
from msbvh.bench.frames_table import voids
from msbvh.bench.scene_parts import CAMERA, FRAME, IRRADIANCE, RATE, SHUTTER
from pxr import Usd, UsdGeom, UsdLux, UsdShade

OURS = f"{shlex.quote(sys.executable)} -m msbvh"
QUICK = ("bench", "--frames", "--quick", "--json")
SPREAD = ("read_s", "build_s", "trace_s", "write_s", "frame_s", "process_s", "start_s", "relative_mse")


def report(msbvh: Run, *arguments: object, code: int = 0) -> dict[str, Any]:
    done = msbvh(*QUICK, *arguments)
    assert done.returncode == code, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def cycles_folder() -> Path:
    return Path(os.environ.get("MSBVH_BPY_ENV") or usual_folder())


# The scenes


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_has_only_what_every_renderer_reads(name: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.usdc"
    SCENES[name].write(file)
    stage = Usd.Stage.Open(str(file))
    lights = [prim for prim in stage.TraverseAll() if prim.HasAPI(UsdLux.LightAPI)]
    assert [light.GetTypeName() for light in lights] == ["DistantLight"]
    assert UsdLux.LightAPI(lights[0]).GetNormalizeAttr().Get() is True
    assert UsdLux.LightAPI(lights[0]).GetIntensityAttr().Get() == IRRADIANCE
    camera = UsdGeom.Camera.Get(stage, CAMERA)
    assert (camera.GetShutterOpenAttr().Get(), camera.GetShutterCloseAttr().Get()) == SHUTTER
    assert stage.GetTimeCodesPerSecond() == RATE
    triangles = 0
    for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()):
        if mesh := UsdGeom.Mesh(prim):
            counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
            assert (counts == 3).all()
            assert mesh.GetSubdivisionSchemeAttr().Get() == "none"
            assert not mesh.GetNormalsAttr().HasAuthoredValue()
            assert len(mesh.GetDisplayColorAttr().Get()) == 1
            triangles += len(counts)
    assert triangles > 5_000_000 if name == "crowd" else 50_000 <= triangles <= 200_000


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_moves_as_it_says(name: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.usda"
    SCENES[name].write(file, 0.05)
    stage = Usd.Stage.Open(str(file))

    def pose(offset: float) -> list[Any]:
        cache = UsdGeom.XformCache(FRAME + offset)
        meshes = [prim for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()) if prim.IsA(UsdGeom.Mesh)]
        return [
            (cache.GetLocalToWorldTransform(prim), UsdGeom.Mesh(prim).GetPointsAttr().Get(FRAME + offset))
            for prim in meshes
        ]

    moved = sum(before != after for before, after in zip(pose(SHUTTER[0]), pose(SHUTTER[1]), strict=True))
    assert moved == {"rotor": 8, "cloth": 1, "parts": 100, "crowd": 150, "still": 0}[name]


@pytest.mark.parametrize("look", ["metal", "textured"])
def test_a_look_is_on_every_mesh(look: str, tmp_path: Path) -> None:
    plain, dressed = tmp_path / "plain.usda", tmp_path / "dressed.usda"
    SCENES["crowd"].write(plain, 0.05)
    SCENES["crowd"].dressed(look).write(dressed, 0.05)
    stage = Usd.Stage.Open(str(dressed))
    meshes = [prim for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()) if prim.IsA(UsdGeom.Mesh)]
    assert len(meshes) > 100
    for prim in meshes:
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        assert material.GetPath() == f"/looks/{look}"
        st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
        assert bool(st) == (look == "textured")
        if st:
            assert len(st.Get()) == len(UsdGeom.Mesh(prim).GetFaceVertexIndicesAttr().Get())
    assert (tmp_path / "checker.png").is_file() == (look == "textured")
    SCENES["crowd"].dressed("displayColor").write(tmp_path / "again.usda", 0.05)
    assert (tmp_path / "again.usda").read_bytes() == plain.read_bytes()


def test_looks_are_measured_one_after_another(msbvh: Run) -> None:
    found = report(
        msbvh, "--scenes", "rotor", "--looks", "displayColor,metal", "--repetitions", 1, "--reference-spp", 0
    )
    assert [(row["scene"], row["look"]) for row in found["rows"]] == [("rotor", "displayColor"), ("rotor", "metal")]
    assert found["machine"]["looks"] == ["displayColor", "metal"]
    assert all(row["cpu_s"] > 0.0 for row in found["rows"])
    done = msbvh(*QUICK, "--looks", "velvet")
    assert done.returncode == 2 and "velvet" in done.stderr


# Noise, and whether two pictures are of the same scene


def grains(seed: int, deviation: float, count: int = 1) -> list[np.ndarray]:
    """Pictures of a ramp under noise."""
    random = np.random.default_rng(seed)
    ramp = np.linspace(0.05, 1.0, 96)[None, :, None] * np.ones((64, 96, 3))
    return [ramp + random.normal(0.0, deviation, ramp.shape) for _ in range(count)]


def test_noise_is_that_of_the_picture_however_noisy_its_reference() -> None:
    """The reference's own part is taken away: without that, it would add half of what is measured here."""
    expected = (0.02**2 / (np.linspace(0.05, 1.0, 96) ** 2 + 0.01)).mean()
    found = noise(grains(1, 0.02)[0], Picture.of(grains(2, 0.02, 2)))
    assert found.relative_mse == pytest.approx(expected, rel=0.05)
    assert found.reference_share == pytest.approx(1 / 3, rel=0.05)
    quiet = noise(grains(1, 0.02)[0], Picture.of(grains(3, 0.001, 2)))
    assert quiet.relative_mse == pytest.approx(expected, rel=0.05)
    assert quiet.reference_share < 0.01


def test_noise_alone_is_no_difference() -> None:
    """Means of squares of 64 pixels differ by 0.015 here; what is left beside the noise's own part is far less."""
    ours, other = (Picture.of(grains(seed, 0.05, 2)) for seed in (1, 2))
    raw = (other.blocks().mean - ours.blocks().mean) ** 2 / (ours.blocks().mean ** 2 + 0.01)
    same = likeness(ours, other)
    assert np.sqrt(raw.mean()) > 0.012
    assert same.shape < 0.008
    assert same.comparable


@pytest.mark.parametrize(
    "change",
    [
        lambda pixels: pixels * 1.05,
        lambda pixels: pixels * np.array([1.0, 1.0, 1.03]),
        lambda pixels: pixels[:, ::-1],  # the same means
        lambda pixels: np.roll(pixels, 4, axis=1),
        lambda pixels: pixels + 0.06 * np.sin(np.arange(64) / 8)[:, None, None],
    ],
)
def test_another_picture_is_no_comparison(change: Callable[[np.ndarray], np.ndarray]) -> None:
    other = [change(pixels) for pixels in grains(2, 0.02, 2)]
    assert not likeness(Picture.of(grains(1, 0.02, 2)), Picture.of(other)).comparable


# The benchmark


def test_the_schema_of_json(msbvh: Run) -> None:
    found = report(msbvh, "--scenes", "rotor,still", "--old", OURS)
    machine, rows = found["machine"], found["rows"]
    assert machine["processor"]
    assert set(machine["sides"]) == {"msbvh", "old"}
    assert [(row["scene"], row["side"]) for row in rows] == [
        ("rotor", "msbvh"), ("rotor", "old"), ("still", "msbvh"), ("still", "old"),
    ]  # fmt: skip
    for row in rows:
        for key in SPREAD:
            assert 0.0 < row[f"{key}_low"] <= row[key] <= row[f"{key}_high"], (key, row)
        phases_s = sum(row[f"{phase}_s_low"] for phase in frame_sides.PHASES)
        assert phases_s <= row["frame_s_high"] < row["process_s_high"]
        assert row["memory_bytes"] > 50 << 20
        assert row["reference_share"] < 0.5


def test_a_build_beside_itself_is_the_same(msbvh: Run) -> None:
    rows = report(msbvh, "--scenes", "still", "--old", OURS)["rows"]
    ours, old = rows
    assert ours["comparable"] is None
    assert all(ours[f"{cost}_ratio"] is None for cost in ("trace", "frame", "process"))
    assert old["comparable"] is True
    assert old["shape_difference"] == 0.0  # the same seeds
    assert old["relative_mse"] == ours["relative_mse"]
    assert old["trace_ratio_low"] <= old["trace_ratio"] <= old["trace_ratio_high"]


def test_another_picture_voids_the_comparison(msbvh: Run, tmp_path: Path) -> None:
    """An old build that forgets motion blur: quicker, and no comparison."""
    script = tmp_path / "forgetful"
    script.write_text(f'#!/bin/sh\nexec {OURS} "$@" --shutter 0:0\n')
    script.chmod(0o755)
    rows = report(msbvh, "--scenes", "rotor", "--old", script, code=1)["rows"]
    old = rows[1]
    assert old["comparable"] is False
    assert old["shape_difference"] > 0.02
    assert all(old[key] is None for key in old if "_ratio" in key)
    assert old["trace_s"] > 0.0
    (void,) = voids(rows)
    assert "void: rotor, displayColor, old: the converged pictures differ" in void


def test_without_converged_pictures_there_are_times_alone(msbvh: Run, tmp_path: Path) -> None:
    rows = report(msbvh, "--scenes", "still", "--reference-spp", 0, "--old", OURS, "--out", "out")["rows"]
    assert [row["relative_mse"] for row in rows] == [None, None]
    assert [row["trace_mse_ratio"] for row in rows] == [None, None]
    assert rows[1]["trace_ratio"] > 0.0
    assert rows[1]["comparable"] is True  # by the pictures of the rounds
    assert json.loads((tmp_path / "out" / "frames.json").read_text())["rows"] == rows
    assert (tmp_path / "out" / "frames" / "still.usdc").is_file()


def test_noise_falls_with_samples(msbvh: Run) -> None:
    def error(spp: int) -> float:
        (row,) = report(msbvh, "--scenes", "rotor", "--spp", spp, "--reference-spp", 1024)["rows"]
        return float(row["relative_mse"])

    few, many = error(4), error(64)
    assert few / many > 8.0  # 16 by independent samples, more where they are stratified


def test_threads_are_rows_of_their_own() -> None:
    all_of_them = len(os.sched_getaffinity(0))
    assert FrameSettings(threads=(1, 0)).thread_counts == tuple(dict.fromkeys((1, all_of_them)))
    assert FrameSettings(threads=(4096,)).thread_counts == (all_of_them,)


def test_a_frame_gets_as_many_processors_as_threads(tmp_path: Path) -> None:
    class Spy:
        name = "spy"

        def command(self, job: Job, folder: Path) -> Sequence[str]:
            said = f"import os; print(len(os.sched_getaffinity(0)), file=open({str(folder / 'seen')!r}, 'w'))"
            return [sys.executable, "-c", said]

        def figures(self, folder: Path) -> Any:
            raise ValueError("spied")

    job = Job(SCENES["still"], tmp_path / "none.usdc", 8, 8, 2, 1, 1, threads=1)
    with pytest.raises(SceneError, match="still: found spied"):
        rendered(Spy(), job, tmp_path / "spy")
    assert (tmp_path / "spy" / "seen").read_text().strip() == "1"


def test_peak_memory_is_the_renderer_s_own(tmp_path: Path) -> None:
    """What this process holds must not count."""
    held = np.ones(100 << 20, np.uint8)
    file = tmp_path / "scene.usdc"
    SCENES["still"].write(file, 0.05)
    run = rendered(this_build(), Job(SCENES["still"], file, 16, 16, 0, 1, 1, threads=1), tmp_path / "ours")
    status = Path("/proc/self/status").read_text().splitlines()
    own = int(next(line for line in status if line.startswith("VmRSS")).split()[1]) << 10
    assert held[-1] == 1
    assert (50 << 20) < run.memory_bytes < own


def test_a_renderer_that_fails_is_named(msbvh: Run) -> None:
    done = msbvh(*QUICK, "--scenes", "still", "--old", "false")
    assert done.returncode == 1
    assert done.stderr.endswith("msbvh: error: bench: old: exit code 1: it said nothing\n")
    done = msbvh(*QUICK, "--scenes", "still", "--old", "/no/such/msbvh")
    assert done.returncode == 1
    assert "cannot be run: /no/such/msbvh" in done.stderr
    assert not done.stdout


@pytest.mark.parametrize("command", ["", "'open"])
def test_a_command_line_that_is_none(command: str) -> None:
    with pytest.raises(SceneError, match="--old: found"):
        old_build(command)


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("--frames", "--scenes", "nothing*"), 1, "matches nothing; expected globs of rotor, cloth"),
        (("--frames", "--builder", "mbvh"), 2, "--builder and --frames exclude each other"),
        (("--frames", "--triangles", 1000), 2, "--triangles and --frames exclude each other"),
        (("--frames", "--peer", "embree"), 2, "--peer embree: found --frames"),
        (("--peer", "cycles"), 2, "--peer cycles: found no --frames"),
        (("--old", "msbvh"), 2, "--old needs --frames"),
        (("--spp", 4), 2, "--spp needs --frames"),
        (("--reference-spp", 0), 2, "--reference-spp needs --frames"),
        (("--resolution", 4, 4), 2, "--resolution needs --frames"),
        (("--frames", "--peer-env", "x"), 2, "--peer-env needs --peer cycles"),
    ],
)
def test_what_is_refused(fails: Fails, arguments: Sequence[object], code: int, message: str) -> None:
    fails(("bench", *arguments), code, message)


# Cycles


STATUS = (
    (11.0, "Fra:1 | blade_0"),
    (12.0, "Fra:1 | Mem: 3M | Updating Scene"),
    (12.5, "Fra:1 | Mem: 3M | Updating Scene | Building BVH"),
    (14.0, "Fra:1 | Scene | Sample 0/16"),
    (14.5, "Fra:1 | Updating Scene"),
    (17.0, "Fra:1 | Scene | Sample 16/16"),
    (18.0, "Fra:1 | Finished"),
)


def test_phases_of_cycles() -> None:
    assert phases(10.0, STATUS, 18.5) == {"read": 2.0, "build": 2.0, "trace": 4.0, "write": 0.5}


@pytest.mark.parametrize("missing", ["Updating Scene", "Sample", "Finished"])
def test_a_cycles_that_says_other_things_is_an_error(missing: str) -> None:
    with pytest.raises(ValueError, match=f"no status '{missing}"):
        phases(10.0, [line for line in STATUS if missing not in line[1]], 18.5)


def test_a_folder_of_other_things_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(SceneError, match="no Python environment"):
        find_cycles(tmp_path, lambda _: None)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_no_python_for_bpy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cycles_peer, "PYTHON", (3, 2))
    with pytest.raises(SceneError, match=r"found no python3\.2, which bpy .* needs"):
        find_cycles(tmp_path / "new", lambda _: None)


def test_an_installation_that_fails_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    python = tmp_path / "python"
    python.write_text('#!/bin/sh\nmkdir -p "$3/bin" && cp "$0" "$3/bin/python" && echo no network && exit 3\n')
    python.chmod(0o755)
    monkeypatch.setattr(cycles_peer, "_matching_python", lambda: str(python))
    notes: list[str] = []
    with pytest.raises(SceneError, match="cannot install bpy .*: no network"):
        find_cycles(tmp_path / "new", notes.append)
    assert "installing bpy" in notes[0]


def test_where_the_environment_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert usual_folder().parent == tmp_path / "msbvh"
    assert not installed(usual_folder())


needs_cycles = pytest.mark.skipif(
    not installed(cycles_folder()),
    reason=f"no bpy in {cycles_folder()} (MSBVH_BPY_ENV); `bench --frames --peer cycles` makes it",
)


@needs_cycles
@pytest.mark.slow
def test_cycles_draws_the_same_pictures(msbvh: Run) -> None:
    """All five scenes: motion, light, shading and colours are read alike, and all of a scene's looks."""
    asked = ("--peer", "cycles", "--peer-env", cycles_folder(), "--repetitions", 1, "--reference-spp", 512)
    found = report(msbvh, *asked)
    dressed = report(msbvh, *asked, "--scenes", "still", "--looks", "metal,textured")
    rows = [row for each in (found, dressed) for row in each["rows"] if row["side"] == "cycles"]
    assert [row["scene"] for row in rows] == [*SCENES, "still", "still"]
    for row in rows:
        assert row["comparable"] is True, row
        assert row["trace_ratio"] > 0.0
        assert row["trace_mse_ratio"] > 0.0
    assert found["machine"]["sides"]["cycles"].startswith(f"Cycles of Blender {cycles_peer.BPY}")


@needs_cycles
@pytest.mark.slow
def test_a_cycles_that_shades_smooth_is_caught(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Means alone would let it pass: the sensitivity of the check."""
    script = Path(cycles_peer.cycles_script.__file__).read_text()
    smooth = tmp_path / "smooth.py"
    shutil.copy(Path(cycles_peer.cycles_script.__file__).with_name("cycles_looks.py"), tmp_path)
    smooth.write_text(script.replace("mesh.shade_flat()", "mesh.shade_smooth()"))
    assert smooth.read_text() != script
    file = tmp_path / "scene.usdc"
    SCENES["still"].write(file, 0.12)

    def picture(side: frame_sides.Side) -> Picture:
        jobs = [Job(SCENES["still"], file, 96, 64, 2, 128, seed, 1) for seed in (1, 2)]
        return Picture.of([rendered(side, job, tmp_path / side.name).pixels for job in jobs])

    ours, cycles = this_build(), Cycles(cycles_folder() / "bin" / "python")
    right = picture(ours)
    assert likeness(right, picture(cycles)).comparable
    monkeypatch.setattr(cycles_peer.cycles_script, "__file__", str(smooth))
    wrong = likeness(right, picture(cycles))
    assert wrong.mean < 0.01
    assert not wrong.comparable
