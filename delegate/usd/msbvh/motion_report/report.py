"""What `msbvh motion` reports: how each prim moves, by which rule, on which track, and how far that errs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pxr import Sdf, Usd, UsdGeom

from ..base.errors import Diagnostics, SceneError
from ..motion.motion_scales import scales_at
from ..motion.samples import FoundSamples, SampleLog
from ..motion.times import Shutter
from ..scene.reader import ReadResult
from ..stage.value_types import INT
from ..stage.values import reported_to, value
from .one_path import instance_count, worst_track

DEGREES = {1: "linear", 2: "quadratic", 3: "cubic"}
_EVERY_PRIM = Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)
MOST_TIMES = 16
"""Sample times of an attribute that are listed; of more, the first and the last."""


@dataclass(frozen=True)
class PrimMotion:
    """How one prim, or a set of instances that move alike, was kept."""

    path: str
    source: str
    rule: str
    segments: int
    degree: int
    time_remap: bool
    hidden_partly: bool
    moving_transform: bool
    error_pixels: float
    tolerance_pixels: float
    """That the error is held to."""
    outside: int
    """Of `count`: that move, wholly outside of the picture throughout the shutter, and may stray further than what is seen."""
    keys_saved: int
    """By those."""
    bytes: int
    count: int
    samples: tuple[FoundSamples, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def still(self) -> bool:
        """Whether it neither moves nor appears or goes."""
        return self.segments == 0 and not self.hidden_partly

    @property
    def beyond(self) -> bool:
        """Whether it misses its tolerance."""
        return not self.error_pixels <= self.tolerance_pixels

    @property
    def track(self) -> str:
        """In words."""
        if self.segments == 0:
            words = "still"
        else:
            words = "moving transform" if self.moving_transform else DEGREES[self.degree]
        if self.time_remap:
            words += " under a time remap"
        if self.hidden_partly:
            words += ", visible for a part of the shutter"
        if not self.outside:
            return words
        return f"{words}, {'' if self.outside >= self.count else f'{self.outside:,} '}outside of the picture"

    def plain(self) -> dict[str, Any]:
        """As JSON has it."""
        return {
            "path": self.path,
            "source": self.source,
            "rule": self.rule,
            "samples": [_plain_samples(samples) for samples in self.samples],
            "track": self.track,
            "segments": self.segments,
            "degree": self.degree,
            "error_px": self.error_pixels if math.isfinite(self.error_pixels) else None,
            "tolerance_px": self.tolerance_pixels,
            "outside": self.outside,
            "keys_saved": self.keys_saved,
            "bytes": self.bytes,
            "warnings": list(self.warnings),
            "count": self.count,
        }


@dataclass(frozen=True)
class MotionReport:
    """The motion of a frame."""

    camera: str
    frame: float | None
    shutter: tuple[float, float]
    """Frames relative to the frame."""
    tolerance_pixels: float
    """Of what is in the picture."""
    prims: tuple[PrimMotion, ...]

    @property
    def beyond(self) -> list[PrimMotion]:
        """Those that miss their tolerance, the worst first."""
        missed = [prim for prim in self.prims if prim.beyond]
        return sorted(missed, key=lambda prim: -prim.error_pixels)

    def plain(self) -> dict[str, Any]:
        """As JSON has it."""
        return {
            "camera": self.camera,
            "frame": self.frame,
            "shutter": list(self.shutter),
            "tolerance_px": self.tolerance_pixels,
            "prims": [prim.plain() for prim in self.prims],
        }


def motion_report(
    stage: Usd.Stage,
    frame: float | None,
    result: ReadResult,
    log: SampleLog,
    tolerance: float,
    prim: str | None,
) -> MotionReport:
    """What a frame's reading has found, limited to a prim and those below it where one is given.

    Raises SceneError where there is no such prim, or nothing drawn at or below it.
    """
    by_path: dict[str, list[Any]] = {}
    for track in result.tracks:
        by_path.setdefault(track.path, []).append(track)
    merged = [_merged(tracks) for tracks in by_path.values()]
    chosen: Iterable[tuple[PrimMotion, Usd.Prim | None]] = ((found, None) for found in merged)
    if prim is not None:
        chosen = _at_or_below(stage, prim, merged, result, log)
    with reported_to(result.diagnostics):
        warnings = result.diagnostics.by_path()
        camera, shutter = result.camera, result.camera.shutter
        prims = [_filled(found, member, stage, shutter, log, warnings) for found, member in chosen]
    return MotionReport(camera.path or "framing camera", frame, (shutter.open, shutter.close), tolerance, tuple(prims))


def _merged(tracks: Sequence[Any]) -> PrimMotion:
    """The tracks of one path as one: instances that take different numbers of keys, a mesh that is itself an
    instance."""
    main = max(tracks, key=lambda track: (track.segments, track.degree, track.error_pixels))
    worst = worst_track(tracks)
    rules = dict.fromkeys(track.rule for track in tracks)
    if len(rules) > 1:
        rules.pop("still", None)
    return PrimMotion(
        path=main.path,
        source=main.source,
        rule="; ".join(rules),
        segments=main.segments,
        degree=main.degree,
        time_remap=any(track.time_remap for track in tracks),
        hidden_partly=any(track.hidden_partly for track in tracks),
        moving_transform=main.moving_transform,
        error_pixels=worst.error_pixels,
        tolerance_pixels=worst.tolerance_pixels,
        outside=sum(track.outside for track in tracks),
        keys_saved=sum(track.keys_saved for track in tracks),
        bytes=sum(track.bytes for track in tracks),
        count=instance_count(tracks),
    )


def _filled(
    found: PrimMotion,
    member: Usd.Prim | None,
    stage: Usd.Stage,
    shutter: Shutter,
    log: SampleLog,
    warnings: dict[str, list[str]],
) -> PrimMotion:
    """With samples, warnings and what the rule has to say about UsdGeomMotionAPI. `member`: of the instances
    that move alike, the one that was asked for."""
    prim = member or _prim_of(stage, found)
    said = [*warnings.get(found.path, ())]
    if member and str(member.GetPath()) != found.path:
        said += warnings.get(str(member.GetPath()), ())
    remarks = _remarks(prim, shutter) if prim and not found.still else []
    return replace(
        found,
        path=str(prim.GetPath()) if prim else found.path,
        rule="; ".join([found.rule, *remarks]),
        samples=tuple(log.samples(found.path, prim)),
        warnings=tuple(dict.fromkeys(said)),
    )


def _prim_of(stage: Usd.Stage, found: PrimMotion) -> Usd.Prim | None:
    """A framing camera is none."""
    return stage.GetPrimAtPath(found.path) if found.path.startswith("/") else None


def _remarks(prim: Usd.Prim, shutter: Shutter) -> list[str]:
    """What UsdGeomMotionAPI says at or above a prim."""
    remarks = []
    scales = scales_at(prim, shutter, Diagnostics())
    if scales.blur != 1.0:
        remarks.append(f"motion:blurScale {scales.blur:g} scales the shutter about the frame")
    if scales.velocity != 1.0:
        remarks.append(f"motion:velocityScale {scales.velocity:g} multiplies the velocities")
    above = prim
    while above and not above.IsPseudoRoot():
        count = UsdGeom.MotionAPI(above).GetNonlinearSampleCountAttr()
        if above.HasAPI(UsdGeom.MotionAPI) and count.HasAuthoredValue():
            exact = "is not needed: accelerations and angular velocities are exact here"
            remarks.append(f"motion:nonlinearSampleCount {value(count, Usd.TimeCode.Default(), INT)} {exact}")
            break
        above = above.GetParent()
    return remarks


def _at_or_below(
    stage: Usd.Stage, path: str, merged: Sequence[PrimMotion], result: ReadResult, log: SampleLog
) -> list[tuple[PrimMotion, Usd.Prim | None]]:
    """Those of a subtree, instances by their own place and by what they show."""
    top = _find_prim(stage, path, result)
    if top is None:
        return [(found, None) for found in merged if found.path == path]
    prefixes = [top.GetPath(), *_prototypes_below(top)]
    chosen = []
    for found in merged:
        prims = log.prims(found.path) or [_prim_of(stage, found)]
        seen = (prim for prim in prims if prim and any(_is_below(prim, prefix) for prefix in prefixes))
        member = next(seen, None)
        if member is not None:
            chosen.append((found, member))
    if not chosen:
        inside = result.diagnostics.by_path().items()
        said = [f"{at}: {text[0]}" for at, text in inside if at and Sdf.Path(at).HasPrefix(top.GetPath())]
        instead = said[0] if said else f"a {top.GetTypeName() or 'prim without a type'}"
        expected = "the camera, a mesh or an instance that is visible at the frame, or a prim above one"
        raise SceneError(f"{top.GetPath()}: found nothing drawn there ({instead}); expected {expected}")
    return chosen


def _find_prim(stage: Usd.Stage, path: str, result: ReadResult) -> Usd.Prim | None:
    """None for a framing camera, which is no prim. As with --camera, a relative path counts from the root."""
    if not result.camera.path and path == "framing camera":
        return None
    absolute = "/" + path.lstrip("/")
    if not Sdf.Path.IsValidPathString(absolute) or not Sdf.Path(absolute).IsAbsoluteRootOrPrimPath():
        raise SceneError(f"PRIM: found '{path}', expected the path of a prim such as /World/Set")
    prim = stage.GetPrimAtPath(absolute)
    if prim:
        return prim
    above = Sdf.Path(absolute).GetParentPath()
    while not stage.GetPrimAtPath(above):
        above = above.GetParentPath()
    children = stage.GetPrimAtPath(above).GetFilteredChildren(_EVERY_PRIM)
    names = [child.GetName() for child in children]
    known = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "") if names else "nothing"
    raise SceneError(f"{absolute}: found no such prim; {above} has {known}")


def _prototypes_below(top: Usd.Prim) -> set[Sdf.Path]:
    """Paths in native prototypes that what lies at or below a prim shows."""
    shown = {top.GetPrimInPrototype().GetPath()} if top.IsInstanceProxy() else set()
    below = Usd.PrimRange(top, _EVERY_PRIM)
    return shown | {prim.GetPrototype().GetPath() for prim in below if prim.IsInstance()}


def _is_below(prim: Usd.Prim, prefix: Sdf.Path) -> bool:
    if prim.GetPath().HasPrefix(prefix):
        return True
    return prim.IsInstanceProxy() and prim.GetPrimInPrototype().GetPath().HasPrefix(prefix)


def _plain_samples(samples: FoundSamples) -> dict[str, Any]:
    return {
        "attribute": samples.attribute,
        "times": _listed(samples.times),
        "authored": samples.authored,
        "count": len(samples.times),
    }


def _listed(times: Sequence[float]) -> list[float]:
    half = MOST_TIMES // 2
    return list(times) if len(times) <= MOST_TIMES else [*times[:half], *times[-half:]]
