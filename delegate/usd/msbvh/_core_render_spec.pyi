"""The part of _core that says what render settings prims ask for (delegate/translate/render)."""

from ._core import Diagnostic

Four = tuple[float, float, float, float]
PixelWindow = tuple[int, int, int, int]
"""x, y, width, height from the picture's upper left corner, y downwards; outside of the picture is overscan."""

class NamedSetting:
    """A value in a namespace, such as msbvh:seed."""

    def __init__(self, name: str, value: bool | int | float | str | None, type: str) -> None:
        """None: a value of another type, which is called ``type``."""

class RenderBaseInput:
    """UsdRenderSettingsBase as authored; None: not authored."""

    path: str
    camera: str
    """The path of the camera prim; empty: not authored."""
    resolution: tuple[int, int] | None
    pixel_aspect_ratio: float | None
    aspect_ratio_conform_policy: str | None
    data_window_ndc: Four | None
    """xmin, ymin, xmax, ymax; (0, 0) is bottom left."""
    disable_motion_blur: bool | None
    disable_depth_of_field: bool | None
    instantaneous_shutter: bool | None
    settings: list[NamedSetting]

class RenderVarInput:
    """UsdRenderVar as authored."""

    def __init__(self, path: str, data_type: str | None, source_name: str | None, source_type: str | None) -> None: ...

class RenderProductInput:
    """UsdRenderProduct as authored."""

    base: RenderBaseInput
    product_type: str | None
    product_name: str | None
    ordered_vars: list[RenderVarInput]

class RenderSettingsInput:
    """UsdRenderSettings as authored."""

    base: RenderBaseInput
    products: list[RenderProductInput]
    included_purposes: list[str] | None
    material_binding_purposes: list[str] | None
    rendering_color_space: str | None

class RenderVarSpec:
    """A layer of a file."""

    @property
    def path(self) -> str: ...
    @property
    def name(self) -> str:
        """Of the layer; colour is called R, G, B, A whatever it is."""
    @property
    def aov(self) -> str | None:
        """None: colour and alpha."""
    @property
    def format(self) -> str | None:
        """half or float; None: the file's own default."""

class ProductSpec:
    """One picture, with what it inherits. A value that made no sense does not count."""

    @property
    def path(self) -> str: ...
    @property
    def name(self) -> str:
        """productName as authored."""
    @property
    def camera(self) -> str:
        """Empty: none is named."""
    @property
    def sets_resolution(self) -> bool:
        """Whether the size is authored, not the schema's fallback."""
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def pixel_aspect_ratio(self) -> float: ...
    @property
    def policy(self) -> str:
        """Of ASPECT_POLICIES."""
    @property
    def data_window_ndc(self) -> Four: ...
    @property
    def motion_blur(self) -> bool: ...
    @property
    def depth_of_field(self) -> bool: ...
    @property
    def vars(self) -> list[RenderVarSpec]:
        """Empty: colour."""

MOST_SAMPLES_OF_NOISE: int
"""Of a pixel, where its noise decides and nobody says how many there are at most."""

class OwnSettings:
    """What is authored in the namespace msbvh, and makes sense."""

    @property
    def samples(self) -> int | None: ...
    @property
    def seed(self) -> int | None: ...
    @property
    def max_bounces(self) -> int | None: ...
    @property
    def noise(self) -> float | None: ...
    @property
    def motion_tolerance(self) -> float | None: ...
    @property
    def edge_length(self) -> float | None: ...
    @property
    def segments(self) -> int | None: ...
    @property
    def refraction(self) -> bool | None: ...
    @property
    def interpolation(self) -> str | None: ...
    @property
    def builder(self) -> str | None: ...
    @property
    def layout(self) -> str | None: ...

class RenderSpec:
    """What render settings ask for."""

    @property
    def base(self) -> ProductSpec:
        """What the settings say themselves: the picture where they name no product."""
    @property
    def products(self) -> list[ProductSpec]: ...
    @property
    def sets_purposes(self) -> bool: ...
    @property
    def included_purposes(self) -> list[str]: ...
    @property
    def material_purpose(self) -> str:
        """full, preview, or empty for those of all purposes."""
    @property
    def rendering_space(self) -> str:
        """OpenColorIO's name; empty: nothing that is known is asked for."""
    @property
    def own(self) -> OwnSettings: ...

def render_spec(settings: RenderSettingsInput) -> tuple[RenderSpec, list[Diagnostic]]:
    """By the rules of UsdRenderComputeSpec."""

def conformed_picture(
    window: Four, width: float, height: float, pixel_aspect_ratio: float, policy: str
) -> tuple[Four, float]:
    """The window (left, right, bottom, top) that a picture of so many pixels of that aspect ratio shows, and theirs as the
    policy, of ASPECT_POLICIES, leaves it."""

def pixels_of(data_window_ndc: Four, path: str, width: int, height: int) -> tuple[PixelWindow, list[Diagnostic]]:
    """Those whose centres lie within, of a picture of that size. One that holds none is ignored with a warning that names
    ``path``."""

def window_part(pixels: PixelWindow, width: int, height: int) -> Four:
    """left, right, bottom, top of those pixels, as shares of the picture's width and height from the left and the bottom."""
