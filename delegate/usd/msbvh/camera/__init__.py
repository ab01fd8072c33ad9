"""The camera: window, lens, and its motion."""
