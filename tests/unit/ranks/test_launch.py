import pytest

from cdem.ranks.launch import launched, launched_rank

VARIABLES = [
    "OMPI_COMM_WORLD_SIZE",
    "OMPI_COMM_WORLD_RANK",
    "PMI_SIZE",
    "PMI_RANK",
    "SLURM_STEP_ID",
    "SLURM_STEP_NUM_TASKS",
    "SLURM_NTASKS",
    "SLURM_PROCID",
]


@pytest.mark.parametrize(
    ("environment", "count", "rank"),
    [
        ({}, 1, 0),
        ({"OMPI_COMM_WORLD_SIZE": "4", "OMPI_COMM_WORLD_RANK": "3"}, 4, 3),
        ({"PMI_SIZE": "2", "PMI_RANK": "1"}, 2, 1),
        ({"PMI_SIZE": "1", "PMI_RANK": "0"}, 1, 0),
        ({"PMI_SIZE": "several"}, 1, 0),
        ({"SLURM_NTASKS": "8", "SLURM_PROCID": "0"}, 1, 0),
        ({"SLURM_NTASKS": "8", "SLURM_PROCID": "5", "SLURM_STEP_ID": "0"}, 8, 5),
        (
            {
                "SLURM_NTASKS": "8",
                "SLURM_STEP_NUM_TASKS": "1",
                "SLURM_PROCID": "0",
                "SLURM_STEP_ID": "0",
            },
            1,
            0,
        ),
    ],
    ids=["alone", "openmpi", "mpich", "mpich1", "nonsense", "batch", "srun", "srun1"],
)
def test_ranks_are_known_by_the_environment(monkeypatch, environment, count, rank):
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert (launched(), launched_rank()) == (count, rank)
