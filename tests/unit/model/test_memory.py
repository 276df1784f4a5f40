"""Memory that a model takes, and how much there is."""

from __future__ import annotations

import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from shared.machine import of_the_cpu

from cdem import Case
from cdem.errors import ModelError
from cdem.model import memory

CASE = """\
model: {{blocks: [{{group: r, box: {{size: [10, 10, 10], divisions: {cells}, shape: {shape}}}}}],
         split: {{r: {split}}}}}
materials: {{rock: {{density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}}}
groups: {{r: {{material: rock}}}}
interfaces: {{default: {{friction_angle: 30, cohesion: {cohesion}}}}}
loads: {{gravity: [0, 0, -10]}}
stages: [{{name: fall, mode: dynamic, duration: "5 ms"}}]
"""


def write(path: Path, cells, shape="hex8", split="connected", cohesion=0) -> Path:
    path.write_text(CASE.format(cells=cells, shape=shape, split=split, cohesion=cohesion))
    return path


@of_the_cpu
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize(
    ("cells", "shape", "split", "cohesion"),
    [
        ([30, 30, 30], "hex8", "connected", 0),
        pytest.param([15, 15, 15], "tet4", "elements", 0, marks=pytest.mark.slow),
        ([16, 16, 16], "tet4", "elements", 1e6),
        pytest.param([18, 18, 18], "wedge6", "elements", 1e6, marks=pytest.mark.slow),
    ],
)
def test_the_need_is_the_peak_of_a_process_that_builds_the_model(
    tmp_path, cells, shape, split, cohesion
):
    """Within 25 %, more than the drift from one version of NumPy to the next."""
    file = write(tmp_path / "r.yaml", cells, shape, split, cohesion)
    code = (
        f"import cdem; cdem.Simulation({str(file)!r}, threads=1).step(20);"
        "print(open('/proc/self/status').read())"
    )
    status = subprocess.check_output([sys.executable, "-c", code], text=True)
    peak = 1024 * int(re.search(r"VmHWM:\s*(\d+) kB", status)[1])
    case = Case.load(file)
    assert memory.need(memory.pieces_of_boxes(case)) == pytest.approx(peak, rel=0.25)


@of_the_cpu
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_solve_is_part_of_the_need(tmp_path):
    """Within 25 %: bonded tets take 8 kB more each while their rest is solved for."""
    file = write(tmp_path / "r.yaml", [12, 12, 12], "tet4", "elements", 1e6)
    floor = "supports: [{surface: {group: r, normal: [0, 0, -1]}, fix: [x, y, z]}]"
    text = file.read_text().replace("-10]}", f"-10], {floor}}}")
    text = text.replace('dynamic, duration: "5 ms"', "static, max_steps: 1")
    file.write_text(text.replace("cohesion: 1000000.0", "cohesion: 1e9, tensile_strength: 1e9"))
    code = (
        f"import cdem; cdem.Simulation({str(file)!r}, threads=1).run();"
        "print(open('/proc/self/status').read())"
    )
    status = subprocess.check_output([sys.executable, "-c", code], text=True)
    peak = 1024 * int(re.search(r"VmHWM:\s*(\d+) kB", status)[1])
    pieces = memory.pieces_of_boxes(Case.load(file))
    assert memory.need(pieces, solves=True) == pytest.approx(peak, rel=0.25)
    assert memory.need(pieces, solves=True) > 1.5 * memory.need(pieces)


def test_a_model_that_fits_without_a_solve_is_told_so(tmp_path, monkeypatch):
    """Only then: for a model that fits by no way the words would not help."""
    file = write(tmp_path / "r.yaml", [40, 40, 40], "tet4", "elements", 1e6)
    file.write_text(file.read_text().replace('dynamic, duration: "5 ms"', "static"))
    case = Case.load(file)
    pieces = memory.pieces_of_boxes(case)
    between = 0.5 * (memory.need(pieces) + memory.need(pieces, solves=True))
    for free, told in ((between, True), (0.9 * memory.need(pieces), False)):
        monkeypatch.setattr(memory, "room", lambda free=free: (free, "the test"))
        with pytest.raises(ModelError) as error:
            memory.check_memory(case, pieces)
        assert ("or relax: adaptive in static stages, which takes" in str(error.value)) == told


def test_boxes_too_large_are_refused_before_they_are_made(tmp_path):
    """A billion hexahedra: their corners alone would be 24 GB."""
    code = "from cdem.cli import main; main()"
    file = write(tmp_path / "r.yaml", [1000, 1000, 1000])
    run = subprocess.run(
        [sys.executable, "-c", code, "check", str(file)], capture_output=True, text=True, timeout=60
    )
    assert run.returncode == 1
    assert len(run.stderr.splitlines()) == 1
    assert "r.yaml:1:1: model: 1,000,000,000 elements need about 1.31e+04 GB" in run.stderr
    assert "Use fewer elements" in run.stderr


def test_a_limit_of_the_process_is_known(tmp_path):
    file = write(tmp_path / "r.yaml", [60, 60, 60])

    def run(limit: int) -> subprocess.CompletedProcess:
        code = (
            f"import resource; resource.setrlimit(resource.RLIMIT_AS, ({limit}, {limit}));"
            "from cdem.cli import main; main()"
        )
        words = [sys.executable, "-c", code, "check", str(file)]
        return subprocess.run(words, capture_output=True, text=True, timeout=100)

    refused = run(2_500_000_000)
    assert refused.returncode == 1
    assert "216,000 elements need about 2.9 GB" in refused.stderr
    assert "(the limit of the process (ulimit -v))" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1


def test_memory_that_runs_out_is_one_line(run_cli, cube_folder, monkeypatch):
    def full(case, more):
        raise MemoryError("Unable to allocate 9 GiB")

    monkeypatch.setattr("cdem.run.state.build", full)
    status, out, err = run_cli("check", "cube.yaml")
    assert (status, out) == (1, "")
    assert err == (
        "out of memory (Unable to allocate 9 GiB): the model is too large for this machine or its "
        "limits; use fewer elements\n"
    )


def tree(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


MACHINE = {"proc/meminfo": "MemTotal: 32000000 kB\nMemAvailable: 16000000 kB\n",
           "proc/self/statm": "1000 500 1 1 0 1 0\n"}  # fmt: skip


@pytest.mark.parametrize(
    ("files", "room", "by"),
    [
        ({}, 16.384e9, "the memory of this machine"),
        ({"proc/self/cgroup": "0::/a/b\n", "sys/fs/cgroup/a/memory.max": "4000000000\n",
          "sys/fs/cgroup/a/memory.current": "1500000000\n",
          "sys/fs/cgroup/a/b/memory.max": "max\n",
          "sys/fs/cgroup/a/memory.stat": "anon 5\ninactive_file 500000000\n"}, 3e9, "a/memory.max"),
        ({"proc/self/cgroup": "0::/\n", "sys/fs/cgroup/memory.high": "2000000000\n"},
         2e9, "memory.high"),
        ({"proc/self/cgroup": "5:cpu:/x\n4:memory:/x/y\n",
          "sys/fs/cgroup/memory/memory.limit_in_bytes": "3000000000\n",
          "sys/fs/cgroup/memory/memory.usage_in_bytes": "1000000000\n"},
         2e9, "memory.limit_in_bytes"),
    ],
)  # fmt: skip
def test_the_least_limit_counts(tmp_path, monkeypatch, files, room, by):
    no_limit = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)
    monkeypatch.setattr(memory.resource, "getrlimit", lambda which: no_limit)
    found, limit = memory.room(tree(tmp_path, MACHINE | files))
    assert found == pytest.approx(room)
    assert by in limit
