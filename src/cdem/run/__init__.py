"""A run: stages, progress, the result folder and its files."""
