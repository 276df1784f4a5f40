"""Slips and doubts that `cdem check` once passed over in silence, or answered unclearly or late."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from shared.cases import CUBE
from shared.faults import FAULTS, fault

from cdem import Case, Simulation
from cdem.output.reader import FrameSeries

BOX = {"group": "rock", "box": {"size": [1, 1, 1]}}
CASE = {
    "cdem": 2,
    "model": {"blocks": [BOX]},
    "materials": {"r": {"density": 2600, "young_modulus": "1 GPa", "poisson_ratio": 0.25}},
    "groups": {"rock": {"material": "r"}},
    "interfaces": {"default": {"friction_angle": 30}},
    "loads": {
        "gravity": [0, 0, -9.81],
        "supports": [{"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["x", "y", "z"]}],
    },
    "stages": [{"name": "s", "mode": "dynamic", "duration": 0.01}],
}


@pytest.fixture
def check(run_cli, tmp_path, monkeypatch):
    """Check a case with changes; returns all that is printed."""
    monkeypatch.chdir(tmp_path)

    def call(*words: str, **changes: object) -> str:
        Path("case.yaml").write_text(yaml.safe_dump(CASE | changes, allow_unicode=True))
        status, out, err = run_cli("check", "case.yaml", *words)
        assert status in (0, 1) and "Traceback" not in err
        return out + err

    return call


ROCKFALL = FAULTS / "field2/rockfall_200MPa_too_deep.yaml"
STIFFER = FAULTS / "field2/rockfall_2GPa_ok_many_frames.yaml"


def test_a_fall_names_the_stiffness_that_it_needs(run_cli):
    # 5.9e8 Pa/m let the boulder go through; 1.2e9 Pa/m stops it
    _, out, _ = run_cli("check", str(ROCKFALL))
    assert "group boulder may fall 116 m, to 47.6 m/s" in out
    assert "contact_stiffness: 1.2e+09 Pa/m" in out


def test_a_fall_onto_rock_that_is_stiff_enough_is_no_doubt(run_cli):
    status, out, _ = run_cli("check", str(STIFFER))
    assert status == 0 and "warning" not in out


@pytest.mark.slow
def test_a_fall_onto_rock_as_stiff_as_told_loses_no_contact():
    """The boulder goes on over the flat, and off the end of the ground."""
    sim = Simulation(Case.load(ROCKFALL, ["interfaces.default.contact_stiffness=1.2e9"]), threads=1)
    assert sim.run() == "at rest"
    assert (
        sim.out.sum() == 1 and sim.fields["position"][sim.build.nodes_of("boulder"), 0].min() > 175
    )


@pytest.mark.slow
def test_a_fall_onto_stiff_rock_ends_on_it_with_a_frame_of_every_second(tmp_path):
    sim = Simulation(Case.load(STIFFER), threads=1, output=tmp_path / "out")
    assert sim.run() == "at rest"
    place = sim.fields["position"][sim.build.nodes_of("boulder")].mean(axis=0)
    assert 96 < place[0] < 176 and place[2] == pytest.approx(0.5, abs=0.01)
    assert abs(sim.energies["error"]) < 1e-3
    times = FrameSeries(tmp_path / "out").times
    assert times == pytest.approx([*range(int(sim.time) + 1), sim.time], abs=1e-3)


def test_bonded_joints_that_are_wet(run_cli):
    _, out, _ = run_cli("check", str(FAULTS / "newcomer/roadcut.yaml"))
    assert "presses in bedding, cross, bonded or not (wet: auto)" in out
    assert (
        "compliance; raise" not in out and "% compliance in tension and bending; raise" not in out
    )


def test_a_pulse_that_a_static_stage_uses_up_is_refused_and_mended_as_told(run_cli):
    """The top of `col` then moves as that of `col_dyn`, without the static stage: 0.12 m/s, not 8e-5."""
    status, out, err = run_cli("check", str(FAULTS / "newcomer/col.yaml"))
    assert (status, out) == (1, "") and err.count("\n") == 1
    assert (
        "col.yaml:12:92: loads.velocities.0.history: is over at 0.04 s, before the stage shake"
        in err
    )
    assert "write stage: shake beside it" in err
    fastest = []
    for name in ("col", "col_dyn"):
        case = fault(f"newcomer/{name}.yaml")
        case["loads"]["velocities"][0]["stage"] = "shake"
        sim = Simulation(Case.from_dict(case), threads=1)
        top = np.linalg.norm(sim.build.born - [0, 0, 60], axis=1).argmin()
        if len(case["stages"]) == 2:
            sim.run_stage("rest")
        end, seen = sim.time + 0.3, []
        while sim.time < end:
            sim.run_until(min(end, sim.time + 0.002))
            seen.append(abs(sim.fields["velocity"][top, 0]))
        fastest.append(max(seen))
    assert fastest[0] == pytest.approx(0.123, rel=0.01)
    assert fastest[1] == pytest.approx(fastest[0], rel=0.01)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("field2/elastic_column_one_stage", "stage settle: "),
        ("field2/elastic_column_two_stages", "stage decide: "),
        ("field2/w1_brittle", "joint A: 5 pairs, 603.817 m2"),
        ("field2/w3_dry", "A: k_n 1e+09 .. 1e+09 Pa/m"),
        ("field2/w3_resc", "joint B: 4 pairs, 504.123 m2"),
        ("newcomer/residual", "presses in bedding, cross, bonded or not (wet: auto)"),
    ],
)
def test_cases_of_factors_are_checked(run_cli, name, said):
    """No more than `check` is tested here: what `critical` answers is another matter.

    These inputs are those of PH13 and PH14, whose factors of safety belong to the issue on rest.
    """
    status, out, err = run_cli("check", str(FAULTS / f"{name}.yaml"))
    assert status == 0 and said in out and "Traceback" not in out + err


BOLTS = {
    "bolt_types": {"bar": {"area": "491 mm2", "young_modulus": "200 GPa", "yield_force": "250 kN"}},
    "bolts": [
        {"name": "b", "type": "bar", "points": [[0.5, 0.5, 1], [0.5, 0.5, 0.2]], "plate": True,
         "anchor": True, "pretension": "300 kN"},
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    "changes, said",
    [
        (BOLTS, "bolts.0.pretension: 3e+05 N is above the yield force of bar, 2.5e+05 N"),
        ({"bolt_types": {"bar": BOLTS["bolt_types"]["bar"] | {"area": 491}}},
         'did you mean "491 mm2"?'),
        ({"histories": [{"name": "h", "point": [9, 0, 0], "quantities": ["velocity"]}]},
         "the point of 'h' lies outside the model; the nearest node, which is used, is 8 m"),
        ({"output": {"every": 1e-9}}, "output.every: 1e-09 s makes 1e+07 frames of stage 's'"),
        ({"damping": {"local": 0.8}}, "it belongs to a stage"),
        ({"materials": {"r": CASE["materials"]["r"] | {"young_modulus": "5 000 000 000"}}},
         "without marks between its digits"),
        ({"model": {"blocks": [BOX], "joints": [
            {"name": f"j{k}", "normal": n, "spacing": 0.001}
            for k, n in enumerate(([1, 0, 0], [0, 1, 0], [0, 0, 1]))]}},
         "would cut the model into about 1e+09 blocks"),
    ],
)  # fmt: skip
def test_check_speaks(check, changes, said):
    assert said in check(**changes)


def test_more_threads_than_cores_are_told(check):
    assert "--threads 999: there are" in check("--threads", "999")


def test_typeset_signs_are_read(check):
    loads = CASE["loads"] | {"gravity": [0, 0, "−9.81 m/s2"]}
    out = check(loads=loads, interfaces={"default": {"friction_angle": "“30 deg”"}})
    assert "time step" in out and "gravity" not in out


def test_a_case_is_no_result_folder(run_cli, tmp_path):
    (tmp_path / "cube.yaml").write_text(CUBE)
    status, _, err = run_cli("info", str(tmp_path / "cube.yaml"))
    assert status == 1 and "cdem check" in err


def test_a_wrong_field_is_answered_at_once(tmp_path):
    text = (
        "import sys\nfrom cdem import cli\nsys.argv = ['cdem', 'render', '.', '--field', 'displacment']\n"
        "try:\n    cli.main()\nexcept SystemExit:\n    pass\n"
        "print(*(m for m in ('numpy', 'h5py', 'pyvista', 'matplotlib', 'meshio') if m in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", text], capture_output=True, text=True, cwd=tmp_path
    )
    assert "did you mean displacement?" in done.stderr
    assert not {"h5py", "pyvista", "matplotlib", "meshio"} & set(done.stdout.split())


@pytest.mark.parametrize(
    "words, heavy",
    [
        (
            ["--help"],
            "numpy pydantic h5py meshio scipy pyvista matplotlib pyproj ruamel",
        ),
        (["check", "cube.yaml"], "meshio scipy pyvista matplotlib pyproj rasterio shapely"),
    ],
)
def test_nothing_heavy_is_imported(tmp_path, words, heavy):
    (tmp_path / "cube.yaml").write_text(CUBE)
    text = (
        f"import sys\nfrom cdem import cli\nsys.argv = ['cdem', *{words}]\n"
        "try:\n    cli.main()\nexcept SystemExit:\n    pass\n"
        f"print('HEAVY', *(m for m in {heavy.split()} if m in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", text], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.stdout.splitlines()[-1].split() == ["HEAVY"], done.stdout + done.stderr
