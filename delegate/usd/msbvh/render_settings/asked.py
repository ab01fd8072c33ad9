"""What a render settings prim makes of a command's own settings, by usdrecord's rule: what the prim authors wins over
--camera, --imageWidth and the output's name, and every other option wins over the prim."""

from __future__ import annotations

from collections.abc import Iterator, Set
from dataclasses import dataclass, replace
from typing import Any

from pxr import Tf, Usd

from .._core import MOST_SAMPLES_OF_NOISE, OwnSettings, ProductSpec, RenderSpec
from ..base.crash_line import crash_line
from ..base.errors import Diagnostics, SceneError
from ..scene.reader import ReadSettings
from ..stage.opening import tf_messages, tf_reason
from ..stage.values import reported_to
from .render_prims import METADATA, find_settings, read_render_spec


@dataclass(frozen=True)
class SettingsChoice:
    """Which render settings count, and against what."""

    path: str | None = None
    """Of the prim; None: the stage's metadata says; empty: there is none."""
    given: frozenset[str] = frozenset()
    """Options that the user gave, by the names of ReadSettings' and RenderSettings' fields, image_width and resolution."""


@dataclass(frozen=True)
class Asked:
    """What a stage's render settings ask for."""

    spec: RenderSpec
    path: str
    """Of the settings prim."""

    @property
    def product(self) -> ProductSpec:
        """The picture: of the first product, or of the settings where they name none."""
        return self.spec.products[0] if self.spec.products else self.spec.base


def asked_of(stage: Usd.Stage, choice: SettingsChoice, frame: float | None, diagnostics: Diagnostics) -> Asked | None:
    """None where nobody names render settings. Raises SceneError where there are none of that path."""
    code = Usd.TimeCode.Default() if frame is None else Usd.TimeCode(frame)
    where = stage.GetRootLayer().realPath or stage.GetRootLayer().identifier
    with crash_line(where), reported_to(diagnostics), tf_messages(diagnostics):
        try:
            prim = find_settings(stage, choice.path)
            return None if prim is None else Asked(read_render_spec(prim, code), str(prim.GetPath()))
        except (Tf.ErrorException, UnicodeDecodeError) as error:
            raise SceneError(f"{METADATA}: USD cannot evaluate it: {tf_reason(error)}") from error


def applied_to_reading(asked: Asked, read: ReadSettings, given: Set[str], diagnostics: Diagnostics) -> ReadSettings:
    """The settings that a stage is read by."""
    product, changes = asked.product, dict(_size(asked.product, given, diagnostics))
    if product.camera:
        if "camera" in given:
            diagnostics.note(product.path, "camera", f"{product.camera}; wins over --camera, as with usdrecord")
        changes["camera"] = product.camera
    changes["pixel_aspect"] = product.pixel_aspect_ratio
    changes["data_window"], changes["settings_prim"] = tuple(product.data_window_ndc), product.path
    if "conform" not in given:
        changes["conform"] = product.policy
    if asked.spec.sets_purposes and "purposes" not in given:
        changes["purposes"] = tuple(each for each in asked.spec.included_purposes if each != "default")
    changes["material_purpose"] = asked.spec.material_purpose
    if not product.motion_blur and "shutter" not in given:
        diagnostics.note(product.path, "disableMotionBlur", "the shutter is closed: no motion blur")
        changes["motion_blur"] = False
    changes["depth_of_field"] = product.depth_of_field
    own = asked.spec.own
    wanted: dict[str, Any] = {
        "motion_tolerance": own.motion_tolerance,
        "edge_length": None if "complexity" in given else own.edge_length,
        "segments": own.segments,
        "interpolation": own.interpolation,
        "rendering_space": asked.spec.rendering_space or None,
    }
    if read.max_bounces is not None:
        wanted["max_bounces"] = own.max_bounces
    changes.update(_not_given(wanted, given))
    return replace(read, **changes)


def own_render_settings(own: OwnSettings, given: Set[str]) -> dict[str, Any]:
    """Fields of the renderer's settings that the prim sets in place of defaults."""
    wanted = {
        "spp": MOST_SAMPLES_OF_NOISE if own.samples is None and own.noise else own.samples,
        "noise": own.noise,
        "seed": own.seed,
        "max_bounces": own.max_bounces,
        "refraction": own.refraction,
        "builder": own.builder,
        "layout": own.layout,
    }
    return dict(_not_given(wanted, given))


def _not_given(wanted: dict[str, Any], given: Set[str]) -> Iterator[tuple[str, Any]]:
    return ((name, value) for name, value in wanted.items() if value is not None and name not in given)


def _size(product: ProductSpec, given: Set[str], diagnostics: Diagnostics) -> Iterator[tuple[str, Any]]:
    """--resolution is ours and wins; --imageWidth is usdrecord's and loses."""
    if product.sets_resolution and "resolution" not in given:
        if "image_width" in given:
            size = f"{product.width} x {product.height}"
            diagnostics.note(product.path, "resolution", f"{size}; wins over --imageWidth, as with usdrecord")
        yield "width", product.width
        yield "height", product.height
