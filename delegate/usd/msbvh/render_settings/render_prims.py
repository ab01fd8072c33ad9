"""UsdRenderSettings, UsdRenderProduct and UsdRenderVar, as they are authored, for _core.render_spec().

Their attributes are uniform: values are read at the default time, as UsdRenderComputeSpec reads them; a product's name
may change from frame to frame.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

from pxr import Sdf, Usd, UsdGeom, UsdRender

from .._core import (
    NamedSetting,
    RenderBaseInput,
    RenderProductInput,
    RenderSettingsInput,
    RenderSpec,
    RenderVarInput,
    render_spec,
)
from ..base.errors import SceneError
from ..stage.value_types import BOOL, FLOAT, FLOAT4, INT2, STRING, TOKEN, TOKENS, Kind
from ..stage.values import Unreadable, diagnostics, ignore, raw, targets, type_name, value

METADATA = "renderSettingsPrimPath"
NAMESPACE = "msbvh:"
_DEFAULT = Usd.TimeCode.Default()
_LARGEST = 2**63 - 1


def find_settings(stage: Usd.Stage, path: str | None) -> Usd.Prim | None:
    """The render settings prim of that path; without one that of the stage's metadata. None: nobody names one, or the path is
    empty. Raises SceneError where there is none of that path; what the metadata names may be missing, with a warning."""
    if path == "":
        return None
    if path is not None:
        prim = _settings_at(stage, path)
        if prim is None:
            known = ", ".join(str(each.GetPath()) for each in islice(_all_settings(stage), 8)) or "none"
            raise SceneError(f"{METADATA}: found no RenderSettings at '{path}', expected one of the stage's: {known}")
        return prim
    named = stage.GetMetadata(METADATA) if stage.HasAuthoredMetadata(METADATA) else None
    if not named:
        return None
    prim = _settings_at(stage, named) if isinstance(named, str) else None
    if prim is None:
        message = f"found '{named}', expected the path of a RenderSettings prim; ignored"
        diagnostics().warning("", METADATA, message)
    return prim


def read_render_spec(prim: Usd.Prim, code: Usd.TimeCode = _DEFAULT) -> RenderSpec:
    """What a render settings prim asks for; product names at that time. Faults are reported to the context
    (stage/values.py)."""
    settings = RenderSettingsInput()
    settings.base = _base(prim)
    products = _prims_of(prim, "products", UsdRender.Product)
    settings.products = [_product(product, code) for product in products]
    settings.included_purposes = _tokens(prim, "includedPurposes")
    settings.material_binding_purposes = _tokens(prim, "materialBindingPurposes")
    settings.rendering_color_space = _authored(prim, "renderingColorSpace", TOKEN)
    spec, said = render_spec(settings)
    diagnostics().take(said)
    return spec


def _settings_at(stage: Usd.Stage, path: str) -> Usd.Prim | None:
    full = "/" + path.lstrip("/")  # As usdrecord has it of cameras, a relative path counts from the root.
    if not Sdf.Path.IsValidPathString(full):
        return None
    prim = stage.GetPrimAtPath(Sdf.Path(full).GetPrimPath())
    return prim if prim and prim.IsA(UsdRender.Settings) else None


def _all_settings(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    return (prim for prim in stage.Traverse() if prim.IsA(UsdRender.Settings))


def _base(prim: Usd.Prim) -> RenderBaseInput:
    """What settings and products have in common."""
    base = RenderBaseInput()
    base.path = str(prim.GetPath())
    base.camera = _camera(prim)
    resolution = _authored(prim, "resolution", INT2)
    base.resolution = None if resolution is None else (resolution[0], resolution[1])
    base.pixel_aspect_ratio = _authored(prim, "pixelAspectRatio", FLOAT)
    base.aspect_ratio_conform_policy = _authored(prim, "aspectRatioConformPolicy", TOKEN)
    window = _authored(prim, "dataWindowNDC", FLOAT4)
    base.data_window_ndc = None if window is None else (window[0], window[1], window[2], window[3])
    base.disable_motion_blur = _authored(prim, "disableMotionBlur", BOOL)
    base.disable_depth_of_field = _authored(prim, "disableDepthOfField", BOOL)
    base.instantaneous_shutter = _authored(prim, "instantaneousShutter", BOOL)
    base.settings = list(_named_settings(prim))
    return base


def _product(prim: Usd.Prim, code: Usd.TimeCode) -> RenderProductInput:
    product = RenderProductInput()
    product.base = _base(prim)
    product.product_type = _authored(prim, "productType", TOKEN)
    name = prim.GetAttribute("productName")
    product.product_name = value(name, code, TOKEN) if name and name.HasAuthoredValue() else None
    product.ordered_vars = [_var(var) for var in _prims_of(prim, "orderedVars", UsdRender.Var)]
    return product


def _var(prim: Usd.Prim) -> RenderVarInput:
    return RenderVarInput(
        str(prim.GetPath()),
        _authored(prim, "dataType", TOKEN),
        _authored(prim, "sourceName", STRING),
        _authored(prim, "sourceType", TOKEN),
    )


def _camera(prim: Usd.Prim) -> str:
    """The path of the camera that a prim names; empty where it names none, or what is no camera."""
    for target in _targets(prim, "camera")[:1]:
        camera = prim.GetStage().GetPrimAtPath(target.GetPrimPath())
        if camera and camera.IsA(UsdGeom.Camera):
            return str(camera.GetPath())
        diagnostics().warning(str(prim.GetPath()), "camera", f"found no Camera at <{target}>, expected one; ignored")
    return ""


def _prims_of(prim: Usd.Prim, relationship: str, schema: Any) -> Iterator[Usd.Prim]:
    """The targets of a relationship that are prims of that schema; each other one is reported."""
    for target in _targets(prim, relationship):
        found = prim.GetStage().GetPrimAtPath(target.GetPrimPath())
        if found and found.IsA(schema):
            yield found
        else:
            message = f"found no Render{schema.__name__} at <{target}>, expected one; it is left out"
            diagnostics().warning(str(prim.GetPath()), relationship, message)


def _targets(prim: Usd.Prim, relationship: str) -> list[Sdf.Path]:
    try:
        return targets(prim, relationship)
    except Unreadable as fault:
        ignore(fault)
        return []


def _tokens(prim: Usd.Prim, name: str) -> list[str] | None:
    found = _authored(prim, name, TOKENS)
    return None if found is None else list(found)


def _authored(prim: Usd.Prim, name: str, kind: Kind) -> Any:
    """A value that is authored for all times; None where there is none."""
    attribute = prim.GetAttribute(name)
    return value(attribute, _DEFAULT, kind) if attribute and _for_all_times(attribute) else None


def _for_all_times(attribute: Usd.Attribute) -> bool:
    """Whether a value is authored for all times; one at times alone is reported."""
    if not attribute.HasAuthoredValue():
        return False
    if attribute.GetResolveInfo(_DEFAULT).GetSource() == Usd.ResolveInfoSourceDefault:
        return True
    message = "found values at times, expected one for all times"
    ignore(Unreadable(str(attribute.GetPrimPath()), attribute.GetName(), message))
    return False


def _named_settings(prim: Usd.Prim) -> Iterator[NamedSetting]:
    """Our own. Those of other namespaces are other renderers'."""
    for attribute in prim.GetAuthoredAttributes():
        if attribute.GetName().startswith(NAMESPACE) and _for_all_times(attribute):
            found = raw(attribute, _DEFAULT)
            if found is not None:
                fits = isinstance(found, (bool, float, str)) or (isinstance(found, int) and abs(found) <= _LARGEST)
                yield NamedSetting(attribute.GetName(), found if fits else None, type_name(attribute, found))
