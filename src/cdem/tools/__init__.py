"""Tests of an installation: its speed, and its working parts."""
