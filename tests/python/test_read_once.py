"""Everything that is read of a prim and is no motion, changed within the shutter: docs/design/read-once.md says what
happens to each attribute, and every line of its table is held here.

The truth is what the stage has at any time: stage_truth.py, its projection, or the attribute's own value.
"""

from __future__ import annotations

import pytest
import read_once_geometry  # noqa: F401  its cases register themselves
import read_once_rest  # noqa: F401
import read_once_shapes  # noqa: F401
from pxr import Sdf, Usd
from read_once import (
    CASES,
    TABLE,
    Case,
)


def _uniform(attribute: str) -> Case:
    def check() -> None:
        kind, _, name = attribute.rpartition(".")
        api = "GeomModelAPI" if name.startswith("model:") else "SkelBindingAPI" if ":skel:" in name else ""
        registry = Usd.SchemaRegistry()
        if api:
            definition = registry.FindAppliedAPIPrimDefinition(api)
        else:
            definition = registry.FindConcretePrimDefinition(kind or "Mesh")
        assert definition.GetAttributeDefinition(name).GetVariability() == Sdf.VariabilityUniform

    return check


for _attribute, _fate in TABLE.items():
    if _fate == "uniform":
        CASES[_attribute] = [_uniform(_attribute)]


def test_every_line_of_the_table_is_held():
    assert TABLE.keys() == CASES.keys()


@pytest.mark.parametrize(
    "check",
    [
        pytest.param(check, id=f"{attribute}-{check.__name__.strip('_')}")
        for attribute, checks in CASES.items()
        for check in checks
    ],
)
def test_what_changes_within_the_shutter(check: Case):
    check()
