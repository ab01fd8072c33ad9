"""Frame ranges and the files of each frame."""
