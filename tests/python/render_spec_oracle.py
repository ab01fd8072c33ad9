"""What render settings ask for, by UsdRenderComputeSpec (OpenUSD 24.11, usdRender/spec.cpp), which usd-core does not hand to
Python: its rules once more, over the schema's own getters."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pxr import Sdf, Usd, UsdGeom, UsdRender


@dataclass(frozen=True)
class Product:
    """UsdRenderSpec::Product, without namespaced settings."""

    path: str = ""
    type: str = ""
    name: str = ""
    camera: str = ""
    disable_motion_blur: bool = False
    disable_depth_of_field: bool = False
    resolution: tuple[int, int] = (0, 0)
    pixel_aspect_ratio: float = 0.0
    policy: str = ""
    aperture: tuple[float, float] = (0.0, 0.0)
    data_window: tuple[float, ...] = ()
    vars: tuple[tuple[str, str, str, str], ...] = ()
    """Path, dataType, sourceName and sourceType."""


def compute_spec(settings: UsdRender.Settings) -> list[Product]:
    """Products whose camera is there; others are left out, as by spec.cpp."""
    stage = settings.GetPrim().GetStage()
    base = _base(settings, Product(), with_fallbacks=True)
    products = []
    for path in settings.GetProductsRel().GetForwardedTargets():
        prim = UsdRender.Product(stage.GetPrimAtPath(path))
        if not prim:
            continue
        product = _base(prim, replace(base, path=str(path)), with_fallbacks=False)
        camera = UsdGeom.Camera(stage.GetPrimAtPath(product.camera)) if product.camera else None
        if not camera:
            continue
        aperture = (camera.GetHorizontalApertureAttr().Get(), camera.GetVerticalApertureAttr().Get())
        product = _conformed(replace(product, aperture=aperture))
        products.append(
            replace(
                product,
                type=prim.GetProductTypeAttr().Get(),
                name=prim.GetProductNameAttr().Get(),
                vars=tuple(_vars(stage, prim.GetOrderedVarsRel().GetForwardedTargets())),
            )
        )
    return products


def _vars(stage: Usd.Stage, paths: list[Sdf.Path]):
    for path in paths:
        var = UsdRender.Var(stage.GetPrimAtPath(path))
        if var:
            yield str(path), var.GetDataTypeAttr().Get(), var.GetSourceNameAttr().Get(), var.GetSourceTypeAttr().Get()


def _base(prim: UsdRender.SettingsBase, product: Product, with_fallbacks: bool) -> Product:
    base = UsdRender.SettingsBase(prim.GetPrim())
    targets = base.GetCameraRel().GetForwardedTargets()
    found = {"camera": str(targets[0])} if targets else {}
    attributes = {
        "resolution": base.GetResolutionAttr(),
        "pixel_aspect_ratio": base.GetPixelAspectRatioAttr(),
        "policy": base.GetAspectRatioConformPolicyAttr(),
        "data_window": base.GetDataWindowNDCAttr(),
        "disable_motion_blur": base.GetDisableMotionBlurAttr(),
        "disable_depth_of_field": base.GetDisableDepthOfFieldAttr(),
    }
    for name, attribute in attributes.items():
        if with_fallbacks or attribute.HasAuthoredValue():
            value = attribute.Get()
            found[name] = tuple(value) if name in ("resolution", "data_window") else value
    return replace(product, **found)


def _conformed(product: Product) -> Product:
    (width, height), (across, up) = product.resolution, product.aperture
    if min(width, height, across, up) <= 0:
        return product
    image = product.pixel_aspect_ratio * width / height
    if image <= 0:
        return product
    camera = across / up
    if product.policy == "adjustPixelAspectRatio":
        return replace(product, pixel_aspect_ratio=camera * height / width)
    sets_height = {
        "adjustApertureHeight": True,
        "adjustApertureWidth": False,
        "expandAperture": camera > image,
        "cropAperture": camera <= image,
    }[product.policy]
    return replace(product, aperture=(across, across / image) if sets_height else (up * image, up))
