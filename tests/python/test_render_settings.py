"""Render settings prims are read by UsdRenderComputeSpec's rules, whatever is authored."""

from __future__ import annotations

import random
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.render_settings.render_prims import read_render_spec
from msbvh.stage import values
from pxr import Gf, Sdf, Usd, UsdGeom, UsdRender
from render_settings_stage import SETTINGS, spec_of, stage_of
from render_spec_oracle import Product, compute_spec
from shared_scenes import SharedScene, every_scene, here, parameters
from soak import soak_count, soak_figure
from test_values import TYPES, sample_of


def product_of(spec: _core.ProductSpec, product: Product, stage: Usd.Stage) -> Product:
    """A product of ours as the oracle puts it; what is kept of USD's own, because ours says it otherwise: the name, which is
    the frame's here, and the type and the vars, which are checked."""
    camera = UsdGeom.Camera(stage.GetPrimAtPath(spec.camera))
    across, up = camera.GetHorizontalApertureAttr().Get(), camera.GetVerticalApertureAttr().Get()
    window = (-across / 2, across / 2, -up / 2, up / 2)
    (left, right, bottom, top), pixel_aspect = _core.conformed_picture(
        window, spec.width, spec.height, spec.pixel_aspect_ratio, spec.policy
    )
    return Product(
        path=spec.path,
        type=product.type,
        name=product.name,
        camera=spec.camera,
        disable_motion_blur=not spec.motion_blur,
        disable_depth_of_field=not spec.depth_of_field,
        resolution=(spec.width, spec.height),
        pixel_aspect_ratio=pytest.approx(pixel_aspect, rel=1e-6),
        policy=spec.policy,
        aperture=(pytest.approx(right - left, rel=1e-6), pytest.approx(top - bottom, rel=1e-6)),
        data_window=tuple(spec.data_window_ndc),
        vars=product.vars,
    )


def assert_as_usd(stage: Usd.Stage) -> int:
    """All settings of a stage; how many products there were."""
    count = 0
    for prim in stage.Traverse():
        if not prim.IsA(UsdRender.Settings):
            continue
        spec, _ = spec_of(stage, str(prim.GetPath()))
        expected = compute_spec(UsdRender.Settings(prim))
        assert len(spec.products) == len(expected)
        for ours, theirs in zip(spec.products, expected, strict=True):
            assert product_of(ours, theirs, stage) == theirs
            assert [var.path for var in ours.vars] == [path for path, *_ in theirs.vars]
            count += 1
        settings = UsdRender.Settings(prim)
        assert spec.included_purposes == list(settings.GetIncludedPurposesAttr().Get())
        purposes = list(settings.GetMaterialBindingPurposesAttr().Get())
        assert spec.material_purpose == purposes[0].replace("allPurpose", "")
    return count


def with_settings(scene: SharedScene) -> str:
    return "" if scene.opens else "broken on purpose: USD does not open it"


FOLDERS = ("render_settings", "cameras")


@pytest.mark.shared
@pytest.mark.parametrize("scene", parameters([each for each in every_scene() if each.group in FOLDERS], with_settings))
def test_public_scenes_ask_for_what_usd_computes(scene):
    stage = Usd.Stage.Open(str(here(scene).path))
    found = assert_as_usd(stage)
    assert found or scene.group == "cameras"


@pytest.mark.parametrize("policy", _core.ASPECT_POLICIES)
@pytest.mark.parametrize("pixel_aspect", [0.5, 1.0, 2.0])
def test_settings_are_what_usd_computes(policy, pixel_aspect):
    stage = stage_of()
    settings = UsdRender.Settings.Get(stage, SETTINGS)
    settings.GetAspectRatioConformPolicyAttr().Set(policy)
    settings.GetPixelAspectRatioAttr().Set(pixel_aspect)
    for disabled in (False, True):
        settings.GetDisableMotionBlurAttr().Set(disabled)
        assert assert_as_usd(stage) == 2


# What is read, and what is said of what is wrong.


@cache
def asked() -> dict[tuple[str, str], Any]:
    values.asked = {}
    try:
        spec_of(stage_of())
        return values.asked
    finally:
        values.asked = None


@cache
def whole_stage() -> Usd.Stage:
    return stage_of()


def attributes() -> Iterator[Usd.Attribute]:
    """Those that are authored on render settings prims."""
    for prim in whole_stage().Traverse():
        if prim.GetTypeName() in ("RenderSettings", "RenderProduct", "RenderVar"):
            yield from prim.GetAuthoredAttributes()


def test_every_attribute_that_is_authored_is_asked_for():
    """Otherwise the sweep would not try it."""
    read = {(str(attribute.GetPrim().GetTypeName()), attribute.GetName()) for attribute in attributes()}
    assert read == set(asked())


def test_the_kinds_that_are_asked_for_are_those_of_the_schemas():
    for attribute in attributes():
        kind = asked()[str(attribute.GetPrim().GetTypeName()), attribute.GetName()]
        definition = attribute.GetPrim().GetPrimDefinition().GetAttributeDefinition(attribute.GetName())
        if definition:
            assert type(definition.GetTypeName().defaultValue) is kind.exact, attribute.GetPath()


CASES = 250
"""Of the sweep, in a sample."""


@pytest.mark.soak
def test_a_value_of_any_type_is_taken_or_named():
    """Every attribute that is read x every type of value, scalar and array."""
    every = [(attribute.GetPath(), typed) for attribute in attributes() for typed in TYPES]
    chosen = random.Random(5).sample(every, soak_count(min(CASES, len(every)), len(every)))
    faults = [fault for path, typed in chosen if (fault := _fault(path, typed))]
    assert not faults, f"{len(faults)} of {len(chosen)}:\n" + "\n".join(faults[:40])
    soak_figure("render settings of any type", f"{len(chosen)} of {len(every)} attributes x types, all taken or named")


def _fault(path: Sdf.Path, typed: Sdf.ValueTypeName) -> str:
    stage = stage_of()
    spec = Sdf.CreatePrimInLayer(stage.GetSessionLayer(), path.GetPrimPath())
    Sdf.AttributeSpec(spec, path.name, typed).default = sample_of(typed)
    try:
        found, said = spec_of(stage)
    except Exception as error:
        return f"{path} as {typed}: {type(error).__name__}: {error}"
    if len(found.products) != 2:
        return f"{path} as {typed}: {len(found.products)} products"
    kind = asked()[str(stage.GetPrimAtPath(path.GetPrimPath()).GetTypeName()), path.name]
    held = type(stage.GetAttributeAtPath(path).Get())
    takes = kind is values.ANY or held in {kind.exact, *kind.conversions}
    if not takes and not any(str(path) in line for line in said):
        return f"{path} as {typed}: not a word; said {said}"
    return ""


NUMBERS = (
    0.0,
    -0.0,
    1.0,
    0.5,
    -1.0,
    1e-30,
    1e-45,
    65535.0,
    1e9,
    3e38,
    -3e38,
    float("inf"),
    -float("inf"),
    float("nan"),
)


def test_whatever_numbers_are_authored_the_picture_is_one_that_can_be_rendered():
    dice = random.Random(3)
    for _ in range(3000):
        settings = _core.RenderSettingsInput()
        product, base = _core.RenderProductInput(), _core.RenderBaseInput()
        base.path = "/Render/Product"
        if dice.random() < 0.7:
            base.resolution = (
                dice.choice((-(2**31), -1, 0, 1, 7, 1920, 65535, 65536, 2**31 - 1)),
                dice.randrange(1, 9),
            )
        base.pixel_aspect_ratio = dice.choice((None, *NUMBERS))
        base.data_window_ndc = tuple(dice.choice((*NUMBERS, dice.uniform(-2, 2))) for _ in range(4))
        base.aspect_ratio_conform_policy = dice.choice((*_core.ASPECT_POLICIES, "", "none"))
        product.base = base
        settings.products = [product]
        spec, said = _core.render_spec(settings)
        found = spec.products[0]
        assert 1 <= found.width <= 65535 and 1 <= found.height <= 65535
        (x, y, width, height), more = _core.pixels_of(found.data_window_ndc, found.path, found.width, found.height)
        assert 1 <= width <= 65535 and 1 <= height <= 65535 and abs(x) <= 65535 and abs(y) <= 2 * 65535
        window, pixel_aspect = _core.conformed_picture(
            (-1, 1, -1, 1), found.width, found.height, found.pixel_aspect_ratio, found.policy
        )
        assert np.isfinite(window).all() and window[0] < window[1] and window[2] < window[3] and pixel_aspect > 0
        for each in (*said, *more):
            assert each.path == "/Render/Product" and each.severity == "warning" and "expected" in each.message


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("Settings.resolution", Gf.Vec2i(0, 40), "/Render/Settings.resolution: found (0, 40), expected 1 to 65535"),
        ("Settings.resolution", Gf.Vec2i(2**31 - 1, 1), "expected 1 to 65535 pixels each way; ignored"),
        ("Settings.pixelAspectRatio", float("nan"), "/Render/Settings.pixelAspectRatio: found nan, expected a number"),
        ("Settings.aspectRatioConformPolicy", "stretch", "found 'stretch', expected one of expandAperture"),
        (
            "Product.dataWindowNDC",
            Gf.Vec4f(0, float("nan"), 1, 1),
            "/Render/Product.dataWindowNDC: found (0, nan, 1, 1)",
        ),
        ("Product.dataWindowNDC", Gf.Vec4f(1, 0, 0, 1), "expected finite xmin, ymin, xmax, ymax"),
        ("Product.productType", "deepRaster", "/Render/Product.productType: found deepRaster"),
        ("far.sourceName", "motionvector", "/Render/far.sourceName: found 'motionvector', expected color, Ci"),
        ("far.sourceType", "primvar", "/Render/far.sourceType: found primvar"),
        ("Beauty.sourceName", "C<RD>L", "/Render/Beauty.sourceName: found the light path expression 'C<RD>L'"),
        ("tint.sourceName", "Ci", "/Render/tint: found channel R twice in the product"),
        ("tint.dataType", "half", "/Render/tint.dataType: found half, expected 3 numbers a pixel"),
        ("Settings.msbvh:samplesPerPixel", -1, "/Render/Settings.msbvh:samplesPerPixel: found -1, expected an integer"),
    ],
)
def test_what_makes_no_sense_is_named_once(path, value, message):
    stage = stage_of()
    attribute = stage.GetAttributeAtPath(f"/Render/{path}") or stage.GetPrimAtPath(
        f"/Render/{path.partition('.')[0]}"
    ).GetAttribute(path.partition(".")[2])
    attribute.Set(value)
    _, said = spec_of(stage)
    assert len(said) == 1 and message in said[0], said


def test_relationships_to_what_is_not_there_are_named():
    stage = stage_of()
    settings = UsdRender.Settings.Get(stage, SETTINGS)
    settings.GetCameraRel().SetTargets(["/Slope"])
    settings.GetProductsRel().AddTarget("/Nowhere")
    UsdRender.Product.Get(stage, "/Render/Product").GetOrderedVarsRel().AddTarget("/Cam")
    spec, said = spec_of(stage)
    assert said == [
        "/Render/Settings.camera: found no Camera at </Slope>, expected one; ignored",
        "/Render/Product.orderedVars: found no RenderVar at </Cam>, expected one; it is left out",
        "/Render/Settings.products: found no RenderProduct at </Nowhere>, expected one; it is left out",
    ]
    assert spec.base.camera == "" and len(spec.products) == 2 and len(spec.products[0].vars) == 3


def test_values_at_times_are_no_settings_but_for_a_products_name():
    stage = stage_of()
    UsdRender.Settings.Get(stage, SETTINGS).GetPrim().RemoveProperty("resolution")
    UsdRender.Settings.Get(stage, SETTINGS).CreateResolutionAttr().Set(Gf.Vec2i(8, 8), 1.0)
    name = UsdRender.Product.Get(stage, "/Render/Product").GetProductNameAttr()
    name.Clear()
    name.Set("a.exr", 1.0)
    name.Set("b.exr", 2.0)
    seed = stage.GetPrimAtPath(SETTINGS).CreateAttribute("msbvh:seed", Sdf.ValueTypeNames.Int)
    seed.Set(3, 1.0)
    spec, said = spec_of(stage)
    text = "found values at times, expected one for all times; ignored"
    assert said == [f"{SETTINGS}.{name}: {text}" for name in ("resolution", "msbvh:seed")]
    assert spec.own.seed is None
    assert not spec.base.sets_resolution
    with values.reported_to(Diagnostics()):
        assert read_render_spec(stage.GetPrimAtPath(SETTINGS), Usd.TimeCode(2.0)).products[0].name == "b.exr"
