"""`msbvh conform`: USD's rules of motion, for any renderer."""
