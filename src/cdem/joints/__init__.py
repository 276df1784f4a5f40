"""Bodies cut into blocks by sets of joints."""
