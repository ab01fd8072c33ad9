"""Where the Hydra plugin is, and which hosts it fits."""
