"""Materials, textures, colour and lights."""
