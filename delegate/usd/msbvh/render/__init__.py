"""From a stage to finished frames."""
