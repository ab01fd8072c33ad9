"""What is read of a stage, and how closely."""

from __future__ import annotations

from dataclasses import dataclass

from ..camera.picture import WHOLE, Picture
from ..stage.rendering_space import LINEAR_REC709

MAX_INSTANCES = 10_000_000
"""While they are read and their tree is built, instances take 0.8 kB each, moving ones 1 kB: these fit in 10 GB."""


@dataclass(frozen=True)
class ReadSettings:
    """What is read. Names and defaults are usdrecord's where it has them."""

    camera: str | None = None
    """Path or name; None: the primary or first camera, or one that frames the stage."""
    width: int = 960
    height: int | None = None
    """Pixels; None: from the camera's aspect ratio."""
    conform: str = "expandAperture"
    """UsdRenderSettings' aspectRatioConformPolicy."""
    pixel_aspect: float = 1.0
    """Width of a pixel over its height."""
    data_window: tuple[float, float, float, float] = WHOLE
    """UsdRenderSettings' dataWindowNDC: which pixels are rendered."""
    settings_prim: str = ""
    """That the data window is of, for messages."""
    motion_blur: bool = True
    """False: the shutter is closed."""
    depth_of_field: bool = True
    """False: the camera is a pinhole."""
    material_purpose: str = "full"
    """Which bindings count before those for all purposes: full, preview, or empty for none."""
    purposes: tuple[str, ...] = ("proxy",)
    """Drawn beside the default purpose."""
    shutter: tuple[float, float] | None = None
    """Opening and closing in frames relative to the frame, in place of the camera's; None: the camera's."""
    disable_camera_light: bool = False
    exposure: bool = True
    """Whether the camera's exposure attributes brighten the picture."""
    rendering_space: str = LINEAR_REC709
    """That colours are converted to: OpenColorIO's name."""
    complexity: str = "high"
    """How fine implicit shapes and subdivided surfaces are; a key of SILHOUETTES and EDGE_LENGTHS."""
    edge_length: float | None = None
    """About how long edges of a subdivided surface are in pixels, 0 for its cage; None: by the complexity."""
    curves: str = "ribbon"
    """What BasisCurves are drawn as: ribbon, flat, across their normals or turned to each ray; tube, round."""
    displacement: str = "auto"
    """What surfaces become that are displaced: patches, tessellate for triangles, auto for triangles as long as there is
    room; none: they are not."""
    displaced_triangle_bytes: int = 2**28
    """The room of `auto`: about as many bytes of trees."""
    motion_tolerance: float = 0.1
    """Pixels by which a moving point may stray from the stage's own evaluation. Less: more keys, more memory.
    """
    outside_tolerance: float = 8.0
    """How many times as far a prim may stray that moves wholly outside of the picture throughout the shutter, where shadows
    and bounces alone show it; not with `segments`. 1: no further than the rest."""
    max_segments: int = 128
    interpolation: str = "auto"
    """linear, quadratic or cubic tracks only; auto: the cheapest for each prim."""
    segments: int = 0
    """Exactly these for whatever moves, a power of two; 0: as few as it takes."""
    disable_draw_modes: bool = False
    """Models are drawn in full, whatever their model:drawMode is."""
    max_instances: int = MAX_INSTANCES
    """More are refused, nested ones multiplied out."""
    keep_faces: bool = False
    """Which face each triangle is of, for the AOV elementId: four bytes a triangle."""
    keep_st: bool = False
    """The primvar st of every prim, for the AOV of that name, whether its material reads it or not."""
    max_bounces: int | None = None
    """Of the render that the scene is for: prims that none of its rays can reach are left out. None: of any render."""
    measure_shape: bool = False
    """Whether TrackReport.shape_error_pixels is measured: how far what is drawn strays from the true surface. Takes a few
    times as long as refining the surfaces."""

    @property
    def picture(self) -> Picture:
        """What of these is about the picture."""
        window = self.data_window, self.settings_prim
        return Picture(self.width, self.height, self.conform, self.pixel_aspect, *window, exposed=self.exposure)


DEFAULTS = ReadSettings()
