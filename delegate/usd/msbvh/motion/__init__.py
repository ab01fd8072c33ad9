"""The shutter, when values change within it, and transforms and points sampled over it."""
