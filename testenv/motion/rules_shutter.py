"""Which times count: the shutter, the frame, the samples around it."""

from __future__ import annotations

from authoring import STILL, Scene, rule, samples, slide
from pxr import Gf, Sdf, Ts, Usd, UsdGeom

SHUTTER, SAMPLING = "shutter", "sampling"
ACROSS = {9.0: (-8, 0), 11.0: (8, 0)}
"""Eight units a frame, in the middle at frame 10."""


@rule(SHUTTER, "An asymmetric shutter opens and closes where it says", "a centred shutter", shutter=(0.0, 0.5))
def shutter_asymmetric(scene: Scene) -> None:
    slide(scene.square("/Square"), ACROSS)
    if scene.mistaken:
        scene.set_shutter(-0.25, 0.25)


@rule(SHUTTER, "A shutter before the frame shows the past alone", "it shows the future", shutter=(-0.5, -0.1))
def shutter_trailing(scene: Scene) -> None:
    slide(scene.square("/Square"), ACROSS)
    if scene.mistaken:
        scene.set_shutter(0.1, 0.5)


@rule(SHUTTER, "A shutter of no length shows the frame, sharp", "a default shutter", shutter=(0.0, 0.0))
def shutter_zero(scene: Scene) -> None:
    slide(scene.square("/Square"), ACROSS)
    if scene.mistaken:
        scene.set_shutter(-0.25, 0.25)


@rule(SHUTTER, "A reversed shutter shows the frame, sharp", "it is turned round", shutter=(0.25, -0.25))
def shutter_reversed(scene: Scene) -> None:
    slide(scene.square("/Square"), ACROSS)
    if scene.mistaken:
        scene.set_shutter(-0.25, 0.25)


@rule(SHUTTER, "A shutter wider than a frame shows all of it", "the last frame alone", shutter=(-2.0, 2.0))
def shutter_of_four_frames(scene: Scene) -> None:
    slide(scene.square("/Square"), {8: (-4, -2), 9: (-2, 2), 10: (0, -2), 11: (2, 2), 12: (4, -2)})
    if scene.mistaken:
        scene.set_shutter(-0.5, 0.5)


@rule(SHUTTER, "An animated shutter is read at the frame", "its value at another time")
def shutter_animated(scene: Scene) -> None:
    slide(scene.square("/Square"), ACROSS)
    if scene.mistaken:
        return
    samples(scene.camera.GetShutterOpenAttr(), {9.0: -1.0, 10.0: -0.1, 11.0: 0.0})
    samples(scene.camera.GetShutterCloseAttr(), {9.0: 0.0, 10.0: 0.2, 11.0: 1.0})


@rule(SHUTTER, "A fractional frame is the shutter's origin", "the nearest whole frame", frames=(10.25,))
def frame_fractional(scene: Scene) -> None:
    slide(scene.square("/Square"), {9.0: (-10, 0), 11.0: (6, 0)} if scene.mistaken else ACROSS)


@rule(
    SHUTTER,
    "A frame rendered in a sequence is the frame rendered alone",
    "an earlier frame's motion again",
    frames=(8.0, 9.0, 10.0),
)
def frame_in_sequence(scene: Scene) -> None:
    square = scene.square("/Square")
    places = {7.0: (-5, 2), 8.5: (3, 2), 9.5: (4, -1), 10.6: (-4, -1), 12.0: (0, 0)}
    slide(square, {9.0: (-5, 2), 10.5: (3, 2)} if scene.mistaken else places)


@rule(SAMPLING, "Samples on both sides of a short shutter count", shutter=(-0.1, 0.1))
def bracketing_samples(scene: Scene) -> None:
    slide(scene.square("/Square"), {0: (-100, 0), 20: (100, 0)})


@rule(SAMPLING, "Bracketing samples of points count as those of transforms do", shutter=(-0.1, 0.1))
def bracketing_points(scene: Scene) -> None:
    scene.points_between(scene.square("/Square"), {0: (-100, 0), 20: (100, 0)})


@rule(SAMPLING, "After the last sample its value holds", "motion is extrapolated", shutter=(-0.5, 0.5))
def hold_after(scene: Scene) -> None:
    slide(scene.square("/Square"), {9.5: (-3, 0), **({10.5: (3, 0)} if scene.mistaken else {10.0: (0, 0)})})


@rule(SAMPLING, "Before the first sample its value holds", "motion is extrapolated", shutter=(-0.5, 0.5))
def hold_before(scene: Scene) -> None:
    mesh = scene.square("/Square")
    scene.points_between(mesh, {10.5: (3, 0), **({9.5: (-3, 0)} if scene.mistaken else {10.0: (0, 0)})})


@rule(SAMPLING, "Samples beyond the stage's start and end time count", "motion is cut off there")
def beyond_the_stage_range(scene: Scene) -> None:
    scene.stage.SetStartTimeCode(10)
    scene.stage.SetEndTimeCode(10)
    slide(scene.square("/Square"), {10.0: (0, 0)} if scene.mistaken else ACROSS)


@rule(SAMPLING, "Samples at uneven times are all met", "a straight line from the first to the last")
def uneven_samples(scene: Scene) -> None:
    path = {9.7: (-4, -2), 9.8: (-4, 1.5), 9.875: (-2, 1.5), 10.4: (3, -1.5), 10.6: (4, 2)}
    ends = {time: path[time] for time in (9.7, 10.6)}
    slide(scene.square("/Square", side=1.0), ends if scene.mistaken else path)


@rule(SAMPLING, "A path of many samples within the shutter is followed", "its ends alone", shutter=(-0.5, 0.5))
def many_samples(scene: Scene) -> None:
    zigzag = {9.5 + i / 8: (-3 + i * 6 / 8, 2.0 if i % 2 else -2.0) for i in range(9)}
    ends = {time: zigzag[time] for time in (9.5, 10.5)}
    slide(scene.square("/Square"), ends if scene.mistaken else zigzag)


@rule(SAMPLING, "Attributes sampled at different times each keep theirs", "one attribute's times for both")
def differing_sample_times(scene: Scene) -> None:
    square = scene.square("/Square", side=1.0)
    slide(square, {9.0: (-8, 0), 11.0: (8, 0)})
    heights = {
        9.75: (0, -2),
        9.9: (0, 2),
        10.0: (0, 2),
        10.2: (0, -2),
        10.35: (0, 1),
        10.5: (0, -1),
        11: (0, 0),
    }
    scene.points_between(square, {9.75: (0, -2), 10.5: (0, -1)} if scene.mistaken else heights)


@rule(SAMPLING, "Samples that all but coincide make a step, not a fault", "the step is smoothed")
def nearly_coincident_samples(scene: Scene) -> None:
    step = {9.75: (-4, -1), 10.125 - 8e-9: (-4, 1), 10.125: (4, 1), 10.5: (4, -1)}
    smooth = {9.75: (-4, -1), 10.125: (4, 1), 10.5: (4, -1)}
    slide(scene.square("/Square"), smooth if scene.mistaken else step)


@rule(SAMPLING, "Equal samples within the shutter are still, whatever follows", "the outer samples count")
def constant_samples(scene: Scene) -> None:
    equal = {8.0 + i / 8: (0, 0) for i in range(25)}
    slide(scene.square("/Square"), {9.5: (-4, 0), 10.5: (4, 0)} if scene.mistaken else {**equal, 12.0: (8, 0)})


@rule(SAMPLING, "Samples win over a default value on the same attribute", "the default value")
def samples_over_default(scene: Scene) -> None:
    operation = UsdGeom.Xformable(scene.square("/Square")).AddTranslateOp()
    operation.Set(Gf.Vec3d(-4, 1.5, 0))
    if not scene.mistaken:
        samples(operation, {9.0: Gf.Vec3d(-8, 0, 0), 11.0: Gf.Vec3d(8, 0, 0)})


@rule(SAMPLING, "A single sample holds at every time", "no value, as at the default time", slack=0.0)
def single_sample(scene: Scene) -> None:
    square = scene.square("/Square")
    slide(square, {3.0: (0, 0) if scene.mistaken else (-3, 1)})
    UsdGeom.Xformable(square).AddRotateZOp().Set(30.0)


def spline(points: dict[float, float], interpolation: object, ends: str = "double") -> Ts.Spline:
    """Knots with level tangents of a third of a frame."""
    curve = Ts.Spline(ends)
    for time, value in points.items():
        knot = Ts.Knot(typeName=ends, time=time, value=value, nextInterp=interpolation)
        knot.SetPreTanWidth(0.3)
        knot.SetPostTanWidth(0.3)
        curve.SetKnot(knot)
    return curve


@rule(SAMPLING, "An op that a spline drives moves, though it has no samples")
def spline_op(scene: Scene) -> None:
    operation = UsdGeom.Xformable(scene.square("/Square")).AddTranslateXOp()
    operation.GetAttr().SetSpline(spline({9.7: -4.0, 10.0: 4.0, 10.6: -2.0}, Ts.InterpCurve))


@rule(SAMPLING, "A spline's held segment jumps", "it glides")
def spline_held(scene: Scene) -> None:
    operation = UsdGeom.Xformable(scene.square("/Square")).AddTranslateXOp()
    kind = Ts.InterpLinear if scene.mistaken else Ts.InterpHeld
    operation.GetAttr().SetSpline(spline({9.5: -4.0, 10.0: 3.0, 10.5: 0.0}, kind))


@rule(SAMPLING, "A blocked sample ends the value of the one before it, which holds until there", "it glides on")
def block_holds_points(scene: Scene) -> None:
    square = scene.square("/Square")
    scene.points_between(square, {9.5: (-3, 0), 12.5: (21, 0)})
    if not scene.mistaken:
        square.GetPointsAttr().Set(Sdf.ValueBlock(), 11.0)


@rule(SAMPLING, "Within a block an op has no value and counts as none", "the block is interpolated across")
def block_of_an_op(scene: Scene) -> None:
    operation = slide(scene.square("/Square"), {9.5: (-4, 1), 10.5: (4, 1)})
    if not scene.mistaken:
        operation.GetAttr().Set(Sdf.ValueBlock(), 10.0)


def moving_layer(scene: Scene, name: str, time_codes_per_second: float = 24.0) -> str:
    """A layer of its own with a moving square; returns the path to it from the scene."""
    other = Scene(scene.folder, time_codes_per_second=time_codes_per_second)
    other.stage.RemovePrim(str(other.camera.GetPath()))
    slide(other.square("/Square"), {0.0: (-4, -2), 1.0: (-4, 2), 2.0: (4, 2), 3.0: (4, -2)})
    (scene.folder / "layers").mkdir(parents=True, exist_ok=True)
    other.stage.GetRootLayer().Export(str(scene.folder / "layers" / name), comment="Written by make_scenes.py.")
    return f"./layers/{name}"


@rule(SAMPLING, "A reference's layer offset shifts and scales its samples", "samples as they stand in the layer")
def layer_offset(scene: Scene) -> None:
    path = moving_layer(scene, "layer_offset.usda")
    offset = Sdf.LayerOffset(9.75, 1.0) if scene.mistaken else Sdf.LayerOffset(9.75, 0.25)
    scene.stage.DefinePrim("/Square").GetReferences().AddReference(path, "/Square", offset)


@rule(SAMPLING, "A layer of another timeCodesPerSecond is read in the stage's", "its time codes as they stand")
def layer_of_other_rate(scene: Scene) -> None:
    path = moving_layer(scene, "layer_of_other_rate.usda", 24.0 if scene.mistaken else 96.0)
    scene.stage.DefinePrim("/Square").GetReferences().AddReference(path, "/Square", Sdf.LayerOffset(9.75, 1.0))


@rule(SAMPLING, "Value clips are read where they are active", STILL)
def value_clips(scene: Scene) -> None:
    path = moving_layer(scene, "value_clips.usda")
    square = scene.square("/Square")
    operation = UsdGeom.Xformable(square).AddTranslateOp()
    operation.Set(Gf.Vec3d(0, 0, 0))
    operation.GetAttr().Clear()
    clips = Usd.ClipsAPI(square)
    clips.SetClipPrimPath("/Square")
    clips.SetClipAssetPaths([Sdf.AssetPath(path)])
    clips.SetClipManifestAssetPath(Sdf.AssetPath(path))
    clips.SetClipActive([Gf.Vec2d(0, 0)])
    clips.SetClipTimes([Gf.Vec2d(9.5, 0.0), Gf.Vec2d(10.5, 3.0)])
