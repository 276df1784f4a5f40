"""Factors of safety over terrain by closed forms, and the bodies worth a computation."""
