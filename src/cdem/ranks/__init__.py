"""Ranks: processes, or threads, that share one model and its work."""
