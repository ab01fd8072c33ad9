"""Image files, AOVs, statistics, and which files a command writes."""
