"""Errors, exit codes, signals, output streams, files written whole: what knows no USD."""
