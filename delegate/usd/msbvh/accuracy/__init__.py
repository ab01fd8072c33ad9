"""What each step of accuracy costs: `msbvh accuracy`."""
