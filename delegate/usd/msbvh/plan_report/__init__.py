"""What `msbvh plan` says of a scene's effects."""
