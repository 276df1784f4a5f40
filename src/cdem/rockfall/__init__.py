"""Rockfall: many runs of one block each over bare ground, and their statistics."""
