"""A stage with render settings, two products and three render vars, and what is read of them."""

from __future__ import annotations

from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.render_settings.render_prims import read_render_spec
from msbvh.stage import values
from pxr import Sdf, Usd

STAGE = """#usda 1.0
(
    startTimeCode = 1
    renderSettingsPrimPath = "/Render/Settings"
)
def Camera "Cam" {
    float horizontalAperture = 20
    float verticalAperture = 10
    float focalLength = 25
    float2 clippingRange = (1, 100)
    double shutter:open = -0.5
    double shutter:close = 0.5
    float fStop = 0.5
    float focusDistance = 2
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Camera "Other" {
    double3 xformOp:translate = (0, 0, 12)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Mesh "Slope" {
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(-4, -2, 0), (4, -2, 0), (4, 2, 0)]
    color3f[] primvars:displayColor = [(0.2, 0.4, 0.6)]
    uniform token subdivisionScheme = "none"
}
def Scope "Render" {
    def RenderSettings "Settings" {
        rel camera = </Cam>
        rel products = [</Render/Product>, </Render/Second>]
        uniform int2 resolution = (80, 40)
        uniform float pixelAspectRatio = 1
        uniform token aspectRatioConformPolicy = "expandAperture"
        uniform float4 dataWindowNDC = (0, 0, 1, 1)
        uniform bool disableMotionBlur = 0
        uniform bool instantaneousShutter = 0
        uniform bool disableDepthOfField = 1
        uniform token[] includedPurposes = ["default", "render"]
        uniform token[] materialBindingPurposes = ["full", ""]
        uniform token renderingColorSpace = "lin_rec709_scene"
        uniform int msbvh:samplesPerPixel = 4
        uniform float msbvh:motionTolerance = 0.25
    }
    def RenderProduct "Product" {
        rel orderedVars = [</Render/Beauty>, </Render/far>, </Render/tint>]
        uniform token productType = "raster"
        token productName = "beauty.exr"
        uniform float4 dataWindowNDC = (0.25, 0.25, 0.75, 1.25)
    }
    def RenderProduct "Second" {
        rel camera = </Other>
        uniform int2 resolution = (30, 40)
        uniform float pixelAspectRatio = 2
    }
    def RenderVar "Beauty" {
        uniform token dataType = "color4h"
        uniform string sourceName = "C.*[LO]"
        uniform token sourceType = "lpe"
    }
    def RenderVar "far" {
        uniform token dataType = "half"
        uniform string sourceName = "z"
    }
    def RenderVar "tint" {
        uniform string sourceName = "albedo"
    }
}
"""
SETTINGS = "/Render/Settings"


def stage_of(text: str = STAGE) -> Usd.Stage:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(text)
    return Usd.Stage.Open(layer)


def spec_of(stage: Usd.Stage, path: str = SETTINGS) -> tuple[_core.RenderSpec, list[str]]:
    """And what was said."""
    said = Diagnostics()
    with values.reported_to(said):
        return read_render_spec(stage.GetPrimAtPath(path)), [str(each) for each in said]
