"""`msbvh verify`: rays that are likely to find a defect, on a user's own scene or on closed shells in hard motion."""
