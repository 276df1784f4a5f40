"""Studies: mistakes in the file, formulas, the runs that follow from it, and values drawn."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import cdem
from cdem.case.case import Case
from cdem.errors import CaseError
from cdem.run.simulation import Simulation
from cdem.study.formula import Formula
from cdem.study.plan import plan
from cdem.study.plots import effects
from cdem.study.results_table import Table, collect
from cdem.study.sampling import draw, quantile, rows
from cdem.study.schema import Parameter, Sampling
from cdem.study.study import Study
from cdem.study.worker import execute

CASE = """\
model: {blocks: [{group: cube, box: {size: [1, 1, 1]}}]}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {cube: {material: rock}}
interfaces: {default: {friction_angle: 30, cohesion: 0}}
loads: {gravity: [0, 0, -10]}
stages: [{name: fall, mode: dynamic, duration: "5 ms"}]
output: {frames: false}
"""


STATIC = CASE.replace('mode: dynamic, duration: "5 ms"', "mode: static")


@pytest.fixture
def study(tmp_path, monkeypatch):
    """Write a study beside its case and load it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cube.yaml").write_text(CASE)

    def load(text: str) -> Study:
        (tmp_path / "study.yaml").write_text("case: cube.yaml\n" + text)
        return Study.load("study.yaml")

    return load


FRICTION = "interfaces.default.friction_angle"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("parameterz: {}", "study.yaml:2:1: parameterz: unknown key; did you mean parameters?"),
        ("parameters: {}", "parameters: needs at least 1 entry, got 0"),
        (
            "parameters: {a.b: {}}",
            "study.yaml:2:14: parameters.a.b: give exactly one of values, gr",
        ),
        ("parameters: {a.b: {normal: {mean: 1, sd: 2}}}", "sd: unknown key"),
        ("parameters: {a.b: {uniform: {low: 2, high: 1}}}", "low 2 must be below high 1"),
        ("parameters: {a.b: {triangular: {low: 0, mode: 3, high: 1}}}", "mode 3 must lie between"),
        ("parameters: {a.b: {uniform: {low: 0, high: 1}}}", "needs sampling: {count: 100}"),
        ("parameters: {a.b: [1]}\nsampling: {count: 2}", "no parameter has a distribution"),
        ("parameters: {phi: [1]}", "parameters.phi: is used by no formula"),
        ("parameters: {phi: [1]}\nset: {a.b: = ph + 1}", "'ph' is not known; did you mean phi?"),
        ("parameters: {phi: [1]}\nset: {a.b: = open(phi)}", "function 'open' is not known"),
        ('parameters: {phi: [1]}\nset: {a.b: "= phi.x[0]"}', "a formula is made of numbers"),
        ("parameters: {phi: [1]}\nset: {a.b: = 1 +}", "is no formula"),
        ("parameters: {a.b: [1], c.d: [1, 2]}\ncombine: together", "there are: a.b 1, c.d 2"),
        ("parameters: {a.b: [1]}\ncritical: {between: [1, 2]}", "give either parameter or factor"),
        (
            "parameters: {a.b: [1]}\ncritical: {parameter: a.b, between: [1, 2]}",
            "critical.parameter: 'a.b' is also given by parameters; vary it once",
        ),
        ("parameters: {a.b: [1]}\nresults: {error: time}", "a column of every table"),
        ("parameters: {a.b: [1]}\nplots: [{lines: x}]", "lines needs x"),
        ("parameters: {a.b: [1]}\nplots: [{lines: f, x: a.c}]", "'a.c' is not known; did you"),
        (
            "parameters: {a.b: [1]}\nresults: {f: time}\nplots: [{tornado: g}]",
            "study.yaml:4:10: plots.0.tornado: result 'g' is not known; there are: f",
        ),
    ],
)
def test_mistakes_are_answered_with_their_place(study, text, message):
    with pytest.raises(CaseError) as error:
        study(text)
    assert message in str(error.value)
    assert str(error.value).startswith("study.yaml:")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            f"parameters: {{{FRICTION}: [10, 95]}}",
            f"study.yaml:2:14: {FRICTION} = 95: {FRICTION}: must lie in [0, 90) [deg], got 95",
        ),
        ("parameters: {loads.gravty: [0]}", "unknown key; did you mean gravity?"),
        ("parameters: {a: [1]}\nset: {loads.gravty: = a}", "study.yaml:3:7: loads.gravty: loads"),
        (
            f"parameters: {{{FRICTION}: [30]}}\n"
            "critical: {parameter: materials.rock.densty, between: [1, 2]}",
            "study.yaml:3:12: materials.rock.densty: densty: unknown key; did you mean density?",
        ),
    ],
)
def test_cases_that_are_wrong_stop_the_study_before_anything_runs(study, text, message, tmp_path):
    with pytest.raises(CaseError) as error:
        plan(study(text), tmp_path)
    assert message in str(error.value)


def test_a_critical_search_over_a_case_that_ends_in_motion_stops_the_study(study, tmp_path):
    text = f"parameters: {{{FRICTION}: [20]}}\ncritical: {{factor: true, between: [1, 2]}}"
    with pytest.raises(CaseError, match=r"cube.yaml:6.*the last stage must be static"):
        plan(study(text), tmp_path)
    (tmp_path / "cube.yaml").write_text(STATIC)
    assert len(plan(study(text), tmp_path)) == 1


def test_drawn_values_that_are_wrong_are_runs_that_failed(study, tmp_path):
    drawn = study(
        "parameters: {interfaces.default.cohesion: {normal: {mean: 0, deviation: 1}}}\n"
        "sampling: {count: 20}"
    )
    failed = [run for run in plan(drawn, tmp_path) if run.status == "failed"]
    assert len(failed) == 10  # one value in each twentieth of the distribution
    assert "must be at least 0 [Pa]" in failed[0].why


def test_formulas_and_units_reach_the_case(study, tmp_path):
    runs = plan(
        study(
            "parameters:\n"
            "  phi: [20, 40]\n"
            "  interfaces.default.cohesion: {values: [2], unit: kPa}\n"
            f"set: {{{FRICTION}: = atan(tan(phi) / 2), loads.gravity: [0, = -phi, 0]}}"
        ),
        tmp_path,
    )
    case = runs[1].task["case"]
    assert case["interfaces"]["default"]["cohesion"] == "2 kPa"
    half = math.degrees(math.atan(math.tan(math.radians(40)) / 2))
    assert case["interfaces"]["default"]["friction_angle"] == pytest.approx(half)
    assert case["loads"]["gravity"] == [0, -40.0, 0]


def test_identity_is_that_of_case_and_action(study, tmp_path):
    """The same case by another way is the same run; another title of the study changes nothing."""
    (tmp_path / "cube.yaml").write_text(STATIC)
    [one] = plan(study(f"parameters: {{{FRICTION}: [20]}}"), tmp_path)
    [same] = plan(
        study(f"title: x\nparameters: {{a: [10]}}\nset: {{{FRICTION}: = 2 * a}}"), tmp_path
    )
    [other] = plan(study(f"parameters: {{{FRICTION}: [21]}}"), tmp_path)
    [sought] = plan(
        study(f"parameters: {{{FRICTION}: [20]}}\ncritical: {{factor: true, between: [1, 2]}}"),
        tmp_path,
    )
    assert one.identity == same.identity
    assert len({run.identity for run in (one, other, sought)}) == 3


def test_a_mesh_counts_by_what_it_holds(tmp_path):
    """Another folder is the same run; another mesh in a file of the same name is not."""
    home = Path(cdem.__file__).parent / "templates"

    def identity(folder: str, more: str) -> str:
        (tmp_path / folder).mkdir()
        for name in ("landslide.yaml", "slope.msh"):
            (tmp_path / folder / name).write_text((home / name).read_text() + more)
        study = Study(
            case=str(tmp_path / folder / "landslide.yaml"), parameters={"time.safety": [0.5]}
        )
        return plan(study, tmp_path)[0].identity

    assert identity("a", "") == identity("b", "") != identity("c", "\n")


@pytest.mark.parametrize(
    ("combine", "expected"),
    [
        ("product", [(1, 5), (1, 6), (1, 7), (2, 5), (2, 6), (2, 7), (3, 5), (3, 6), (3, 7)]),
        ("together", [(1, 5), (2, 6), (3, 7)]),
        ("one-at-a-time", [(1, 5), (2, 5), (3, 5), (1, 6), (1, 7)]),
    ],
)
def test_lists_and_grids_combine(study, combine, expected):
    found = rows(
        study(
            "parameters: {a.b: [1, 2, 3], c.d: {grid: {first: 5, last: 7, count: 3}}}\n"
            f"combine: {combine}"
        )
    )
    assert [(row["a.b"], row["c.d"]) for row in found] == expected


def test_formula():
    assert Formula("= 2 * sin(30) + a.b ** 2").value({"a.b": 3}) == pytest.approx(10)
    assert Formula("= max(a, 2, 1) - atan2(1, 1)").value({"a": 50}) == pytest.approx(5)
    assert math.isnan(Formula("= 1 / a").value({"a": 0}))
    assert math.isnan(Formula("= (0 - 8) ** 0.5").value({}))
    with pytest.raises(ValueError, match="sin takes 1"):
        Formula("= sin(1, 2)")
    with pytest.raises(ValueError, match="phi is no number"):
        Formula("= phi").value({"phi": "10 deg"})


KINDS = {
    "uniform": ({"low": 2, "high": 4}, 3, 2 / math.sqrt(12)),
    "normal": ({"mean": 5, "deviation": 2}, 5, 2),
    "lognormal": ({"mean": 5, "deviation": 2}, 5, 2),
    "triangular": ({"low": 0, "mode": 1, "high": 5}, 2, math.sqrt((25 + 1 - 5) / 18)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_latin_hypercube_takes_one_value_of_each_stratum(kind):
    """And so mean and deviation come close to those of the distribution."""
    numbers, mean, deviation = KINDS[kind]
    parameter = Parameter(**{kind: numbers})
    count = 200
    drawn = draw({"x": parameter, "y": parameter}, Sampling(count=count, seed=3))
    x, y = (np.array([row[name] for row in drawn]) for name in "xy")
    edges = [quantile(parameter, i / count) for i in range(count)] + [np.inf]
    for values in (x, y):
        assert (np.histogram(values, edges)[0] == 1).all()
        assert values.mean() == pytest.approx(mean, rel=0.01)
        assert values.std() == pytest.approx(deviation, rel=0.05)
    assert abs(np.corrcoef(x, y)[0, 1]) < 0.2  # the strata of two parameters meet at random


def test_draws_are_those_of_seed_and_method():
    parameters = {"x": Parameter(uniform={"low": 0, "high": 1})}
    latin = Sampling(count=50, seed=3)
    assert draw(parameters, latin) == draw(parameters, latin)
    assert draw(parameters, latin) != draw(parameters, Sampling(count=50, seed=4))
    free = [row["x"] for row in draw(parameters, Sampling(method="monte-carlo", count=50))]
    assert (np.histogram(free, 50, (0, 1))[0] != 1).any()


def test_limits_cut_a_distribution_off():
    normal = Parameter(normal={"mean": 0, "deviation": 1, "low": 0.5, "high": 1})
    assert quantile(normal, 0.0) == pytest.approx(0.5)
    assert quantile(normal, 0.999999) == pytest.approx(1, abs=1e-5)
    lognormal = Parameter(lognormal={"mean": 1, "deviation": 1, "low": 0.5})
    assert quantile(lognormal, 0.0) == pytest.approx(0.5)


def table_of(study: Study, of) -> Table:
    """The table of a study whose runs gave the number that `of` makes of their parameters."""
    runs = plan(study, Path("out"))
    for run in runs:
        result = {"f": of(*run.parameters.values()), "text": "x", "list": [1.0, None]}
        run.result = {"status": "finished", "summary": result, "histories": {"toe.x [m]": 2.0}}
    return Table(study, runs)


def test_effects_of_lists_and_of_drawn_values(study):
    """One at a time: the other parameter stays at its first value. Drawn: rank correlations."""
    alone = study(
        "parameters: {a: [1, 2, 4], b: [10, 30]}\ncombine: one-at-a-time\n"
        "set: {loads.gravity: [0, = a, = b]}\nresults: [f]"
    )
    assert effects(table_of(alone, lambda a, b: a * b), "f") == {"a": (10, 40), "b": (10, 30)}
    drawn = study(
        "parameters: {a: {uniform: {low: 1, high: 2}}, b: {uniform: {low: 0, high: 1}}}\n"
        "sampling: {count: 100}\nset: {loads.gravity: [0, = a, = b]}\nresults: [f]"
    )
    found = effects(table_of(drawn, lambda a, b: math.exp(-5 * a) + 1e-9 * b), "f")
    assert found["a"] == (0, pytest.approx(-1))  # however curved
    assert abs(found["b"][1]) < 0.3


def test_the_table_reads_back_to_the_same_bits(study, tmp_path):
    whole = study(
        "parameters: {loads.gravity.2: {values: [-10, -0.1], unit: m/s2}}\n"
        "results: {f: f, toe: histories.toe.x, none: list.1, root: = sqrt(f)}"
    )
    table = table_of(whole, lambda g: g / 3)
    paths = table.write(tmp_path)
    first, second = csv.DictReader(paths[0].open())
    assert first["loads.gravity.2 [m/s2]"] == "-10"
    assert (float(second["f"]), second["toe"], second["none"]) == (-0.1 / 3, "2.0", "")
    assert first["root"] == ""  # of a number below zero
    if len(paths) > 1:  # with pyarrow
        from pyarrow import parquet

        columns = parquet.read_table(paths[1]).to_pydict()
        assert columns["f"] == [-10 / 3, -0.1 / 3] and columns["none"] == [None, None]
    assert set(collect(study("parameters: {loads.gravity.2: [1]}"), table.runs[0])) == {
        "f", "list.0", "list.1", "histories.toe.x",
    }  # fmt: skip


def test_a_kept_run_goes_on_from_its_checkpoint(study, tmp_path):
    """To the bit as if it had not been broken off; a second time it is not executed at all."""
    text = "parameters: {stages.fall.duration: [0.1]}\nkeep: true"
    [broken] = plan(study(text), tmp_path / "broken")
    [whole] = plan(study(text), tmp_path / "whole")
    folder = tmp_path / "broken/runs" / broken.name / "results"
    half = Simulation(Case.from_dict(broken.task["case"]), threads=1, output=folder)
    assert half.run(should_stop=lambda: half.time > 0.02) == "stopped"
    before = half.step_count

    found, expected = execute(broken.task), execute(whole.task)
    assert f"resumed at step {before}" in (folder / "run.log").read_text()
    for key in ("groups", "energies", "steps"):
        assert found["summary"][key] == expected["summary"][key]
    stamp = (folder / "summary.json").stat().st_mtime
    assert execute(broken.task) == found
    assert (folder / "summary.json").stat().st_mtime == stamp
