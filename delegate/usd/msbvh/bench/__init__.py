"""`msbvh bench`: rays and whole frames, side by side with peers."""
