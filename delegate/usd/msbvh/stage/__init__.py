"""Opening a stage, and the one gate through which its values are read."""
