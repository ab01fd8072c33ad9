"""The knobs that `msbvh accuracy` turns, in the order of its report."""

from __future__ import annotations

from collections.abc import Sequence

from .knobs import Knob
from .motion_knobs import MOTION_KNOBS
from .sampling_knobs import SAMPLING_KNOBS
from .shape_knobs import SHAPE_KNOBS
from .tree_knobs import TREE_KNOBS

ALL: Sequence[Knob] = (*MOTION_KNOBS, *SHAPE_KNOBS, *SAMPLING_KNOBS, *TREE_KNOBS)
