"""Factors of safety over terrain by closed forms, and the bodies that deserve a computation."""
