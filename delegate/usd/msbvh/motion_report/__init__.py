"""`msbvh motion`: which samples were read, which track was fitted, and why."""
