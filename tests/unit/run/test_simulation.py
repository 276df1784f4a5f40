"""Simulations that are resumed."""

from __future__ import annotations

import json

import h5py
import pytest

pytestmark = pytest.mark.usefixtures("cube_folder")


def test_a_checkpoint_of_another_version_is_refused_in_one_line(run_cli, cube_folder):
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    with h5py.File(cube_folder / "cube.results/checkpoint.h5", "r+") as file:
        kept = json.loads(file["attributes"][()])
        del kept["core"]["dt_stable"], file["attributes"], file["spring/state"]
        file["attributes"] = json.dumps(kept)
    status, out, err = run_cli("run", "cube.yaml", "--resume")
    assert (status, out) == (1, "")
    assert "written by another version of cdem" in err
    assert "dt_stable" in err and "spring.state" in err
    assert "Traceback" not in err
