"""What a sweep has to know of a scene before it renders it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from pxr import Usd

from .. import _core
from ..base.errors import Diagnostics
from ..scene.reader import ReadResult, ReadSettings, read_frame
from ..stage.opening import tf_messages

FRAMES_OF_A_SEQUENCE = 4
"""That the refit knob renders."""


@dataclass(frozen=True)
class SceneFacts:
    """Of one frame of a scene."""

    effects: frozenset[str]
    """That are on, by the names of core/plan/effect_plan.h."""
    moves: bool
    """Whether anything that is drawn does."""
    moves_outside: bool
    """Whether anything moves wholly outside of the picture, on a tolerance of its own."""
    cut: bool
    """Whether surfaces are cut more or less finely by --complexity: subdivided ones, spheres and the like."""
    frame: float | None
    frames: int
    """That follow on the stage from this one on, itself included."""
    tracks: Sequence[_core.TrackReport]
    """As the base settings keep them; the camera's first."""
    statistics: Mapping[str, int]

    def has(self, effect: str) -> bool:
        return effect in self.effects


def scene_facts(
    stage: Usd.Stage, frame: float | None, settings: ReadSettings, bounces: int, diagnostics: Diagnostics
) -> tuple[SceneFacts, ReadResult]:
    """Reads the frame twice. Raises SceneError as read_frame() does."""
    result = read_frame(stage, frame, settings, diagnostics)
    with tf_messages(Diagnostics()):
        coarse = read_frame(stage, frame, replace(settings, complexity=_other_complexity(settings)))
    found = _core.effects(result.scene, max_bounces=bounces)
    counts = dict(result.scene.statistics())
    last = stage.GetEndTimeCode() if stage.HasAuthoredTimeCodeRange() else frame
    facts = SceneFacts(
        effects=frozenset(row["effect"] for row in found["effects"] if row["asked_by"]),
        moves=any(track.segments > 0 for track in result.tracks),
        moves_outside=any(track.outside for track in result.tracks),
        cut=counts["triangles"] != coarse.scene.statistics()["triangles"],
        frame=frame,
        frames=1 if frame is None or last is None else max(1, int(last - frame) + 1),
        tracks=result.tracks,
        statistics=counts,
    )
    return facts, result


def _other_complexity(settings: ReadSettings) -> str:
    return "low" if settings.complexity != "low" else "veryhigh"
