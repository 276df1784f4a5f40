"""Marks of tests that look at the machine and not at results."""

import os

import pytest

of_the_cpu = pytest.mark.skipif(
    os.environ.get("CDEM_ISA") == "emulated",
    reason="time or memory of a core for the CPU; the emulated device takes more of both",
)
