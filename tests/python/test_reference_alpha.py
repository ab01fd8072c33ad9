"""Coverage against pictures of another renderer, whose alpha follows USD's plain semantics.

A plain triangle projection of usd-core's own evaluation sets the bound for each scene: what it differs by is
the reference's own noise and filter. docs/conformance.md has the table.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from alpha_references import BOUND, Comparison, alpha_errors, comparisons
from shared_scenes import SCENES, absent, parameters


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.parametrize("comparison", parameters(comparisons(), lambda comparison: comparison.excluded))
def test_alpha(tmp_path: Path, comparison: Comparison | None) -> None:
    if comparison is None:
        absent(SCENES / "INDEX.tsv")
    found = alpha_errors(comparison, tmp_path)
    assert found.oracle < 0.03, f"the oracle itself is out by {found.oracle:.4f}: is the scene comparable?"
    assert found.ours <= BOUND * found.oracle, f"ours {found.ours:.4f}, the oracle's {found.oracle:.4f}"
