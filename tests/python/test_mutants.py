"""Deliberate defects (tests/mutants.toml): each is caught by the test that is named beside it."""

from __future__ import annotations

import sys

import pytest
from conftest import ROOT
from soak import is_soak, soak_figure

sys.path[:0] = [str(ROOT / "cmake"), str(ROOT / "docs")]

import mutant_checks
import switch_mutants


@pytest.mark.soak
def test_each_mutant_is_caught() -> None:
    """`make test` has no time to build the core a second time: it only sees that each can be made."""
    mutants = mutant_checks.read_mutants()
    expect_switches(mutants)
    if is_soak():
        mutant_checks.build(mutants)
        found = mutant_checks.verdicts(mutants)
        soak_figure("mutants", f"{sum(verdict.caught for verdict in found)} of {len(found)} caught")
        assert not [verdict.mutant.name for verdict in found if not verdict.caught]


def expect_switches(mutants: list[mutant_checks.Mutant]) -> None:
    """Its text occurs once, with a switch both texts are there, and its test exists."""
    assert len({mutant.name for mutant in mutants}) == len(mutants) >= 30
    sources = switch_mutants.switched_sources(switch_mutants.read_mutants())
    for number, mutant in enumerate(mutants):
        assert sources[mutant.file].count(f"mutant({number})") == 1, mutant.name
        assert mutant.search in sources[mutant.file] and mutant.replace in sources[mutant.file], mutant.name
        tests = (ROOT / "tests" / mutant.test[0]).glob("*.cpp")
        assert any(f'"{mutant.test[1]}"' in path.read_text(encoding="utf-8") for path in tests), mutant.test


def test_expressions_statements_and_constants_get_switches() -> None:
    def switched(source: str, search: str, replace: str) -> str:
        mutant = {"name": "m", "file": "f.cpp", "search": search, "replace": replace}
        return switch_mutants.switched(source, mutant, 7)

    asked = "::msbvh::mutant(7)"
    assert switched("f(a + b);\n", "a + b", "a") == f"f(({asked} ? (a) : (a + b)));\n"
    assert switched("  f();\n", "f();", "g();") == f"  if ({asked}) {{ g(); }} else {{ f(); }}\n"
    assert switched("\nconstexpr float kA = 2;\n", "2", "1") == f"\nconst float kA = ({asked} ? (1) : (2));\n"
    with pytest.raises(switch_mutants.MutantError, match=r"f\.cpp: found 2 times, expected once: a"):
        switched("a a", "a", "b")
    with pytest.raises(switch_mutants.MutantError, match="expected two expressions or two statements"):
        switched("a;", "a;", "b")
