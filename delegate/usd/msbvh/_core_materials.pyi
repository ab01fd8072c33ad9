"""The part of _core that says what shading networks mean (delegate/translate/look)."""

from collections.abc import Callable, Mapping, Sequence

from ._core import Diagnostic
from ._core_inputs import F32

class Asset:
    """A file that an input names."""

    def __init__(self, path: str, files: Sequence[str], color_space: str = "") -> None:
        """``path`` as authored; ``files`` resolved: one, a UDIM texture's tiles in order, or none; ``color_space``: what
        the stage says that they hold, empty for nothing."""
    @property
    def color_space(self) -> str: ...
    @property
    def path(self) -> str: ...
    @property
    def files(self) -> list[str]: ...

ShaderData = bool | float | Sequence[float] | str | Asset | None
"""A vector has two to four numbers. None: of a type that is none of these."""

class ShaderValue:
    def __init__(self, data: ShaderData, text: str, type: str) -> None:
        """``text`` and ``type``: the value and its type for messages."""
    @property
    def data(self) -> ShaderData: ...
    @property
    def text(self) -> str: ...
    @property
    def type(self) -> str: ...

class ShaderConnection:
    """To what another node computes."""

    def __init__(self, node: str, output: str) -> None:
        """The node's path and the output's name."""
    @property
    def node(self) -> str: ...
    @property
    def output(self) -> str: ...

class Origin:
    """Where something was authored, for messages."""

    def __init__(self, path: str, attribute: str) -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def attribute(self) -> str: ...

class ShaderInput:
    def __init__(
        self,
        name: str,
        value: ShaderValue | None = None,
        in_shutter: Sequence[ShaderValue | None] = (),
        connections: Sequence[ShaderConnection] = (),
        origin: Origin | None = None,
    ) -> None:
        """``value`` at the frame, None: the node's default. ``in_shutter``: the different values over the open shutter,
        where they are not the frame's alone. The first of the connections counts, and more than a value does.
        ``origin`` of the value, which may come from the material's interface; None: the node's own input."""
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> ShaderValue | None: ...
    @property
    def in_shutter(self) -> list[ShaderValue | None]: ...
    @property
    def connections(self) -> list[ShaderConnection]: ...
    @property
    def origin(self) -> Origin | None: ...

class ShaderNode:
    def __init__(self, path: str, identifier: str, inputs: Sequence[ShaderInput]) -> None:
        """``identifier`` such as UsdPreviewSurface; empty: none is known."""
    @property
    def path(self) -> str: ...
    @property
    def identifier(self) -> str: ...
    @property
    def inputs(self) -> list[ShaderInput]: ...

class ShaderNetwork:
    def __init__(self, path: str, nodes: Sequence[ShaderNode], terminals: Mapping[str, ShaderConnection]) -> None:
        """``path`` of the material; each node once, in any order, cycles allowed; ``terminals`` by name: surface."""
    @property
    def path(self) -> str: ...
    @property
    def nodes(self) -> list[ShaderNode]: ...
    @property
    def terminals(self) -> dict[str, ShaderConnection]: ...

def evaluated_inputs(identifier: str) -> list[str]:
    """The inputs of a node of that identifier that are evaluated: others need not be read."""

def surface_rank(identifier: str) -> int:
    """Among the surfaces of a material's render contexts: 0 what is read as it is, 1 what is mapped to a
    UsdPreviewSurface, 2 what is not drawn."""

class SurfaceLook:
    """What a material's surface is made of, for Translator.add_material()."""

    @property
    def name(self) -> str: ...
    @property
    def primvars(self) -> list[tuple[str, int]]:
        """The names of those that a prim must bring along, without primvars:, and how many numbers make up a value at
        least, 1 to 4."""

def preview_surface(
    network: ShaderNetwork,
    locate: Callable[[str], tuple[str, int, int] | None],
    rendering_space: str = "lin_rec709_scene",
) -> tuple[SurfaceLook | None, list[Diagnostic]]:
    """What the network means, None where its surface is none that is drawn, and what is to be said about it. ``locate``:
    of a resolved file the path, and the offset and the number of its bytes there (0: all); None where they do not lie
    anywhere as they stand. Textures that are the same everywhere become constants, in the rendering space."""

class Displacement:
    """How a material displaces what is bound to it."""

    @property
    def primvar(self) -> str:
        """The name of the one that a mesh must bring along; empty: none."""
    @property
    def primvar_width(self) -> int:
        """Numbers that make up a value of it: 1, or 2 for texture coordinates."""

def displacement(
    network: ShaderNetwork, channel: Callable[[list[str], str, int], tuple[F32, str, str] | None]
) -> tuple[Displacement | None, list[Diagnostic]]:
    """What the network displaces, None for nothing, and what is to be said about it. ``channel``: red, green, blue or
    alpha (0 to 3) of the texture in some files, linear, by UsdUVTexture's sourceColorSpace: float32[H, W], the uppermost
    row first, and the wrap modes that the file names in s and t (empty: none); None where it cannot be read."""
