"""The version of cdem, stored in results, checkpoints and sweeps."""

__version__ = "0.1.0"
