"""Point clouds of rock faces: flat facets, and the sets of joints to which they belong."""
