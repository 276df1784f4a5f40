import sys

import pytest

from cdem.errors import BackendError
from cdem.ranks import mpi


def test_without_mpi4py_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "mpi4py", None)
    with pytest.raises(BackendError, match=r"need mpi4py: pip install 'cdem\[mpi\]'"):
        mpi.imported()


class _One:
    """An MPI that sees one rank."""

    class COMM_WORLD:
        size = 1

    @staticmethod
    def Get_library_version() -> str:
        return "Open MPI v5.0.1, package: of somebody"


def test_an_mpi_that_did_not_start_the_ranks_is_told(monkeypatch):
    monkeypatch.setattr(mpi, "imported", lambda: _One)
    monkeypatch.setattr(mpi, "launched", lambda: 4)
    with pytest.raises(BackendError, match=r"4 ranks were started.* \(Open MPI v5\.0\.1\)"):
        mpi.world()


@pytest.mark.parametrize(
    ("library", "words"),
    [
        ("MPICH Version:      5.0.2\nMPICH Release date: Fri\n\0", "MPICH 5.0.2"),
        ("Open MPI v5.0.11, package: Open MPI root@vm", "Open MPI v5.0.11"),
        (
            "Intel(R) MPI Library 2021.9 for Linux* OS\n\0",
            "Intel(R) MPI Library 2021.9 for Linux* OS",
        ),
    ],
)
def test_name_and_version_of_an_mpi(library, words):
    assert mpi.first_words(library) == words
