"""How many ranks this process was started with; asks the environment only, so it costs nothing."""

from __future__ import annotations

import os

LAUNCHERS = (
    ("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"),  # Open MPI
    ("PMI_SIZE", "PMI_RANK"),  # MPICH, Intel MPI, MVAPICH, Cray
)
"""Variables with the number of ranks and the number of this one."""


def launched() -> int:
    """Number of ranks that were started together by mpiexec, mpirun or srun; 1 without them."""
    return _launch()[1]


def launched_rank() -> int:
    """Number of this rank, from 0, by the word of what started it."""
    return _launch()[0]


def _launch() -> tuple[int, int]:
    launchers = list(LAUNCHERS)
    if "SLURM_STEP_ID" in os.environ:  # started by srun; a batch script alone has no step
        launchers += [("SLURM_STEP_NUM_TASKS", "SLURM_PROCID"), ("SLURM_NTASKS", "SLURM_PROCID")]
    for size, rank in launchers:
        if (count := _number(size)) is not None:
            return (_number(rank) or 0, count) if count > 1 else (0, 1)
    return 0, 1


def _number(name: str) -> int | None:
    text = os.environ.get(name, "")
    return int(text) if text.isdecimal() else None
