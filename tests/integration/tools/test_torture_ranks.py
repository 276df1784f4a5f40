"""A run of two ranks of which one is killed goes on, on any number of ranks."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from shared.mpi import needs_mpi

TOOLS = Path(__file__).parents[3] / "tools/torture"


@needs_mpi
@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="ranks are found in /proc")
def test_a_trial(monkeypatch, tmp_path):
    monkeypatch.setitem(os.environ, "OMP_NUM_THREADS", "1")
    monkeypatch.syspath_prepend(str(TOOLS))
    import ranks

    torture = ranks.Ranks(tmp_path)
    assert torture.trial("1 1")[1] == ""
    (torture.whole / "histories.csv").write_text("other")
    result, why = torture.trial("1 2")
    assert result == "wrong" and "histories.csv differs" in why
