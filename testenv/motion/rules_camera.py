"""The camera over the shutter."""

from __future__ import annotations

from authoring import STILL, Scene, box, place, rule, samples, slide, turn
from pxr import Gf, UsdGeom

TOPIC = "camera"
FULL = (-0.5, 0.5)


@rule(TOPIC, "A camera that moves blurs what stands still")
def camera_translates(scene: Scene) -> None:
    scene.wedge("/Wedge")
    samples(scene.eye, {9.0: Gf.Vec3d(-6, -2, 20), 11.0: Gf.Vec3d(6, 2, 20)})


@rule(TOPIC, "A camera that rolls truly rotates", "points run along chords", shutter=FULL)
def camera_rolls(scene: Scene) -> None:
    bar = scene.bar("/Bar")
    if scene.mistaken:
        samples(
            UsdGeom.Xformable(bar).AddTransformOp(),
            {t: Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d.ZAxis(), -a)) for t, a in {9.5: 0, 10.5: 150}.items()},
        )
    else:
        turn(scene.camera, {9.0: -75.0, 11.0: 225.0})


@rule(TOPIC, "A camera that pans", STILL)
def camera_pans(scene: Scene) -> None:
    scene.square("/Square")
    samples(UsdGeom.Xformable(scene.camera).AddRotateYOp(), {9.0: -20.0, 11.0: 20.0})


@rule(TOPIC, "The motion of a camera's ancestors counts", "its own alone", rig="/Rig")
def camera_ancestors(scene: Scene) -> None:
    scene.wedge("/Wedge")
    if not scene.mistaken:
        turn(UsdGeom.Xform.Get(scene.stage, "/Rig"), {9.0: -50.0, 11.0: 50.0})


@rule(TOPIC, "What moves as the camera does stays sharp", "it is blurred")
def camera_follows(scene: Scene) -> None:
    path = {9.0: (-6, -2), 10.0: (1, 1), 11.0: (6, -1)}
    slide(scene.square("/Square"), {t: (0, p[1] - 1) for t, p in path.items()} if scene.mistaken else path)
    if not scene.mistaken:
        samples(scene.eye, {t: Gf.Vec3d(x - 1, y - 1, 20) for t, (x, y) in path.items()})
    slide(scene.square("/Stays", 0, 2.3, 0.8), {10.0: (0, 0)})


@rule(TOPIC, "A camera that dollies in changes the perspective over the shutter", STILL)
def camera_dollies(scene: Scene) -> None:
    scene.polygon("/Near", box(1.5, 1, 2, 1))
    place(scene.polygon("/Far", box(-6, -4, 4, 4)), 0, 0, -15)
    samples(scene.eye, {9.0: Gf.Vec3d(0, 0, 32), 11.0: Gf.Vec3d(0, 0, 8)})


@rule(TOPIC, "An animated focal length zooms over the shutter", "the frame's focal length")
def focal_length(scene: Scene) -> None:
    scene.polygon("/A", box(1.5, 0.8, 1.5, 0.8))
    scene.polygon("/B", box(-1.8, -0.9, 1.2, 0.8))
    lengths = {10.0: 40.0} if scene.mistaken else {9.75: 25.0, 10.0: 40.0, 10.5: 75.0}
    samples(scene.camera.GetFocalLengthAttr(), lengths)


@rule(TOPIC, "Animated apertures zoom over the shutter", "the frame's apertures")
def apertures(scene: Scene) -> None:
    scene.polygon("/A", box(1.5, 0.8, 1.5, 0.8))
    scene.polygon("/B", box(-1.8, -0.9, 1.2, 0.8))
    widths = {10.0: 24.0} if scene.mistaken else {9.5: 40.0, 10.0: 24.0, 10.6: 12.0}
    samples(scene.camera.GetHorizontalApertureAttr(), widths)
    samples(scene.camera.GetVerticalApertureAttr(), {t: w / 2 for t, w in widths.items()})


@rule(TOPIC, "Animated aperture offsets shift the image over the shutter", "the frame's offsets")
def aperture_offsets(scene: Scene) -> None:
    scene.square("/Square", -1.0, 0.0)
    if scene.mistaken:
        return
    samples(scene.camera.CreateHorizontalApertureOffsetAttr(), {9.0: -8.0, 11.0: 8.0})
    samples(scene.camera.CreateVerticalApertureOffsetAttr(), {9.5: 2.0, 10.5: -2.0})


@rule(TOPIC, "An orthographic camera moves, and depth makes no difference", "a perspective camera")
def orthographic(scene: Scene) -> None:
    place(scene.square("/Near", -2.0, 1.2), 0, 0, 6)
    place(scene.square("/Far", 2.0, -1.2), 0, 0, -12)
    samples(scene.eye, {9.0: Gf.Vec3d(-3, 0, 20), 11.0: Gf.Vec3d(3, 1, 20)})
    if not scene.mistaken:
        scene.camera.CreateProjectionAttr(UsdGeom.Tokens.orthographic)
        scene.camera.GetHorizontalApertureAttr().Set(120.0)
        scene.camera.GetVerticalApertureAttr().Set(60.0)


@rule(TOPIC, "What passes the near plane within the shutter is cut off there", "the plane lies nearer")
def near_plane(scene: Scene) -> None:
    scene.camera.GetClippingRangeAttr().Set(Gf.Vec2f(0.5 if scene.mistaken else 14.0, 1000.0))
    slide(scene.polygon("/Sheet", box(0, 0, 2, 2)), {9.5: (-1, 0, 2), 10.5: (1, 0, 8)})


@rule(TOPIC, "An animated clippingRange cuts off over the shutter", "the frame's for all", shutter=FULL)
def clipping_range(scene: Scene) -> None:
    floor = [(-4, -2, 18), (4, -2, 18), (4, -2, -40), (-4, -2, -40)]
    scene.polygon("/Floor", floor)
    ranges = {9.5: (5.0, 9.0), 10.25: (12.0, 60.0), 10.5: (8.0, 10.0)}
    if scene.mistaken:
        ranges = {10.0: (9.667, 43.0)}
    scene.camera.GetClippingRangeAttr().Clear()
    samples(scene.camera.GetClippingRangeAttr(), {time: Gf.Vec2f(*planes) for time, planes in ranges.items()})


@rule(TOPIC, "A camera and its subject at a million units blur as at the origin", "single precision")
def camera_far_off(scene: Scene) -> None:
    far = 4_194_304.0
    samples(scene.eye, {9.0: Gf.Vec3d(far - 3, far, 20), 11.0: Gf.Vec3d(far + 3, far, 20)})
    square = scene.square("/Square", side=1.0)
    if scene.mistaken:
        samples(scene.eye, {10.0: Gf.Vec3d(far, far, 20)})
        place(square, far + 0.5, far)
    else:
        slide(square, {9.0: (far + 2, far - 3), 11.0: (far - 2, far + 3)})
