"""Files and folders of strangers that once ran code, read other files, hung or ended in a traceback.

More of their kinds: `test_strangers_files.py`, whose files `tests/shared/strangers.py` writes.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

import pytest
from shared.faults import FAULTS

from cdem.errors import CaseError
from cdem.terrain.features import read_features

PROGRAM = [sys.executable, "-I", "-c", "from cdem.cli import main; main()"]
PLANTED = "open('PWNED', 'w').write('code of the folder ran')\nraise ImportError\n"


@pytest.mark.parametrize(
    ("folder", "module", "words", "said"),
    [
        ("", "h5py", ["check", "case.yaml"],
         "case.yaml:2:9: model.mesh: body.med: cannot be read (Unable to synchronously open file"),
        ("sweep", "pickle", ["sweep", "study.yaml", "--workers", "1"],
         "study.yaml:4:11: results.a: 'status' is unknown; there are: "),
    ],
)  # fmt: skip
def test_no_module_of_the_current_folder_runs(tmp_path, folder, module, words, said):
    """Of `trust/cwd_import`; the damaged mesh and the unknown result are one line each."""
    shutil.copytree(FAULTS / "trust/cwd_import", tmp_path, dirs_exist_ok=True)
    place = tmp_path / folder
    (place / f"{module}.py").write_text(PLANTED)
    done = subprocess.run([*PROGRAM, *words], cwd=place, capture_output=True, text=True)
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr.splitlines()[-1].startswith(said) and "Traceback" not in done.stderr
    assert list(tmp_path.rglob("PWNED")) == []


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("gdalg/outline.gpkg", "its first bytes do not match its ending .gpkg"),
        ("gpkg_hang/bomb.gpkg", "has a view or virtual table 't', which would compute when read"),
        ("kmz_abort/b.kmz", "unpacks to more than 100 times its size, more than any map"),
    ],
)
def test_an_outline_leads_nowhere_and_ends_in_time(tmp_path, monkeypatch, name, said):
    """The first reads another file, where GDAL has its way; the others took no end, and all memory."""
    pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    (tmp_path / "w/sec").mkdir(parents=True)
    (tmp_path / "w/sec/secret.geojson").write_text(
        '{"type": "Feature", "properties": {"s": "TOPSECRET"},'
        ' "geometry": {"type": "Point", "coordinates": [0, 0]}}'
    )
    monkeypatch.chdir(tmp_path)
    path, before = FAULTS / "trust" / name, os.times()
    with pytest.raises(CaseError) as caught:
        read_features(path)
    after = os.times()
    told = str(caught.value)
    assert told.startswith(f"{path}: {said}") and "\n" not in told and "TOPSECRET" not in told
    assert after.children_user - before.children_user < 5


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("m1", "m1.yaml:3:76: materials.r.law: must be elastic, mohr-coulomb, "),
        ("m2", "m2.yaml:6:101: stages.1.set.groups.g.material: must be a text, got a list of 1"),
    ],
)
@pytest.mark.parametrize("verb", ["check", "run"])
def test_a_list_where_a_name_belongs_is_one_line(run_cli, tmp_path, monkeypatch, verb, name, said):
    monkeypatch.chdir(tmp_path)
    status, out, err = run_cli(verb, str(FAULTS / f"trust/tracebacks/{name}.yaml"))
    assert (status, out) == (1, "") and said in err and err.count("\n") == 1
