"""Render settings prims: what they ask for, and what that makes of a command's own settings."""
