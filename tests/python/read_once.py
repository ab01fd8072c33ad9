"""What the cases of docs/design/read-once.md share: its table, the register of what holds each line, stages and truth."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from conftest import ROOT
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from projection_oracle import Sampling, coverage
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade
from recording import Shot, messages

SHUTTER = (-0.25, 0.5)
CHANGES = (10.05, 10.2)
"""Time codes within the shutter of frame 10 at which values change."""
SIZE = (48, 32)
RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
COLOURS = np.array([RED, GREEN, BLUE])

Case = Callable[[], None]
CASES: dict[str, list[Case]] = {}
"""By the attribute's name in the table."""


def case(attribute: str) -> Callable[[Case], Case]:
    """Registers what holds a line of the table."""

    def register(check: Case) -> Case:
        CASES.setdefault(attribute, []).append(check)
        return check

    return register


def table() -> dict[str, str]:
    """What happens to each attribute, by docs/design/read-once.md."""
    text = (ROOT / "docs" / "design" / "read-once.md").read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `([^`]+)` \| (followed|held|uniform) \|", text, re.MULTILINE))


TABLE = table()


def set_in_turn(attribute: Usd.Attribute, values: Sequence[Any], times: Sequence[float] = (9.0, *CHANGES)) -> None:
    for time, value in zip(times, values, strict=True):
        attribute.Set(value, time)


def picture(shot: Shot, spp: int = 256) -> np.ndarray:
    """float32[H, W, 4]: the frame, lit by what glows alone."""
    conform = "adjustApertureHeight"  # As the projection has it.
    settings = ReadSettings(width=SIZE[0], height=SIZE[1], conform=conform, disable_camera_light=True)
    result = read_frame(shot.stage, 10.0, settings)
    return _core.Renderer(result.scene, width=SIZE[0], height=SIZE[1], spp=spp, max_bounces=0).render()


def assert_covers_as_the_stage(shot: Shot) -> None:
    """Alpha by the stage's own evaluation at 128 times."""
    expected = coverage(shot.stage, 10.0, "/Camera", SIZE, Sampling(128, 4))
    found = picture(shot)[..., 3]
    assert ((expected > 0.02) & (expected < 0.98)).sum() > 20, "the test sees nothing"
    assert np.abs(found - expected).mean() < 0.003
    assert np.abs(found - expected).max() < 0.1


def glowing(shot: Shot, path: str, colour: tuple[float, float, float] | None) -> UsdShade.Material:
    """A material that shows a colour as it is; None: displayColor."""
    material = UsdShade.Material.Define(shot.stage, path)
    shader = UsdShade.Shader.Define(shot.stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0))
    emission = shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f)
    if colour is None:
        reader = UsdShade.Shader.Define(shot.stage, f"{path}/Reader")
        reader.CreateIdAttr("UsdPrimvarReader_float3")
        reader.CreateInput("varname", Sdf.ValueTypeNames.Token).Set("displayColor")
        emission.ConnectToSource(reader.CreateOutput("result", Sdf.ValueTypeNames.Float3))
    else:
        emission.Set(Gf.Vec3f(*colour))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return material


def bind(prim: Any, material: UsdShade.Material) -> None:
    prim = prim if isinstance(prim, Usd.Prim) else prim.GetPrim()
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)


def shares(shutter: tuple[float, float] = SHUTTER, changes: Sequence[float] = CHANGES) -> np.ndarray:
    """Of the shutter: before the first change, between the two, and after."""
    ends = np.array([10.0 + shutter[0], *changes, 10.0 + shutter[1]])
    return np.diff(ends) / (shutter[1] - shutter[0])


def mean_of_halves(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mean colour of the left and of the right half, away from the edge between them: float64[3] each."""
    middle = SIZE[0] // 2
    return (image[:, : middle - 2, :3].mean(axis=(0, 1)), image[:, middle + 2 :, :3].mean(axis=(0, 1)))


def named(shot: Shot, attribute: str, *texts: str) -> None:
    """Exactly one warning names the attribute, and says these things."""
    found = [text for text in messages(shot.read(), "warning") if text.startswith(f"{attribute}: ")]
    assert len(found) == 1, messages(shot.read())
    assert all(text in found[0] for text in texts), found[0]


def wide_squares(shot: Shot, path: str = "/Mesh") -> UsdGeom.Mesh:
    """Two faces that fill the left and the right half of the picture."""
    mesh = UsdGeom.Mesh.Define(shot.stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateFaceVertexCountsAttr([4, 4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 4, 3, 1, 2, 5, 4])
    mesh.CreatePointsAttr([(x, y, 0) for y in (-50, 50) for x in (-50, 0, 50)])
    return mesh


def row_of_squares(shot: Shot, path: str = "/Mesh") -> UsdGeom.Mesh:
    """Three squares of two units side by side that move upwards."""
    mesh = UsdGeom.Mesh.Define(shot.stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateFaceVertexCountsAttr([4, 4, 4])
    mesh.CreateFaceVertexIndicesAttr(range(12))
    corners = [(x + dx, dy, 0) for x in (-3, 0, 3) for dx, dy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for time, rise in ((9.0, -1.0), (11.0, 1.0)):
        mesh.CreatePointsAttr().Set([(x, y + rise, z) for x, y, z in corners], time)
    return mesh
