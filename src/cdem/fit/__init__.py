"""Observations in the field against runs: how well a run fits, and which parameters fit."""
