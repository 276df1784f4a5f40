"""The version of cdem, which results, checkpoints and sweeps keep."""

__version__ = "0.1.0"
