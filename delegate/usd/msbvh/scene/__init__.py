"""Prims to what the translator takes: shapes, primvars, instances, and the reader that walks the stage."""
