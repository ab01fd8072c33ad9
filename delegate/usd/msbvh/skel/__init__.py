"""UsdSkel: bindings, poses and skinned points."""
