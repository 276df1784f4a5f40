"""Rest of blocks: their rigid motion, how long it lasts, and blocks that left the model."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

import cdem
from cdem.output.page_facts import page_facts
from cdem.run.rest import (
    REST_ENERGY,
    REST_SPAN,
    REST_SPEED,
    SLOW_SPEED,
    STILL_SPEED,
    Motion,
    Quiet,
    fallen,
    rigid_motion,
)

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def motion(*speeds: float, at: float = 0.0) -> Motion:
    """Blocks of 1 kg with these speeds, their middles at x = `at`."""
    speed = np.array(speeds)
    return Motion(speed, 0.5 * speed**2, np.full((len(speed), 3), [at, 0, 0]))


def test_a_rigid_motion_has_its_whole_energy():
    """A cube that turns and moves: sum of m v2 / 2, to round-off."""
    rng = np.random.default_rng(3)
    mass = rng.uniform(1, 2, 16)
    position = np.concatenate([CUBE, CUBE + [3, 0, 0]])
    spin, speed = rng.normal(size=3), rng.normal(size=3)
    velocity = np.cross(spin, position) + speed
    found = rigid_motion(np.array([0, 8, 16], np.int32), mass, position, velocity)
    exact = 0.5 * mass * (velocity**2).sum(axis=1)
    np.testing.assert_allclose(found.energy, exact.reshape(2, 8).sum(axis=1), rtol=1e-12)
    of_block = np.sqrt(2 * found.energy / mass.reshape(2, 8).sum(axis=1))
    np.testing.assert_allclose(found.speed, of_block, rtol=1e-12)


def test_vibration_is_no_motion():
    """A cube that breathes about its centre: no rigid motion."""
    found = rigid_motion(np.array([0, 8], np.int32), np.ones(8), CUBE, CUBE - 0.5)
    assert found.speed[0] < 1e-12


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_a_motion_that_blew_up_is_summed_up_without_a_word(bad, recwarn):
    velocity = np.zeros((8, 3))
    velocity[0, 0] = bad
    found = rigid_motion(np.array([0, 8], np.int32), np.ones(8), CUBE, velocity)
    assert not np.isfinite(found.speed[0])
    assert not recwarn.list


def test_rest_must_last():
    quiet = Quiet()
    quiet.look(0.0, motion(5.0))
    quiet.look(1.0, motion(0.5 * SLOW_SPEED))
    assert not quiet.rests
    quiet.look(1.0 + 0.9 * REST_SPAN, motion(2 * SLOW_SPEED))  # one block starts again
    quiet.look(1.0 + 1.1 * REST_SPAN, motion(0.5 * SLOW_SPEED))
    assert not quiet.rests
    quiet.look(1.0 + 2.2 * REST_SPAN, motion(0.5 * SLOW_SPEED))
    assert quiet.rests


def test_slow_creep_is_no_rest_but_rocking_is():
    creeps, rocks = Quiet(peak=1e3), Quiet(peak=1e3)
    for time in np.arange(0.0, 5.0, 0.1):
        creeps.look(time, motion(1.5 * REST_SPEED, at=1.5 * REST_SPEED * time))
        assert not creeps.rests
        rocks.look(time, motion(0.5 * SLOW_SPEED, at=1e-4 * np.sin(40 * time)))
    assert rocks.rests


def test_a_slow_start_is_no_rest_but_what_never_moves_rests():
    """A slide that begins at 0.01 m/s2 is slow for a second, and has its largest energy then."""
    quiet = Quiet()
    for time in np.arange(0.2, 0.9, 0.1):
        quiet.look(time, motion(0.01 * time))
    assert not quiet.rests
    quiet = Quiet()
    for time in np.arange(0.0, 1.0, 0.1):
        quiet.look(time, motion(0.5 * STILL_SPEED))
    assert quiet.rests


def test_most_of_the_energy_must_be_gone():
    quiet = Quiet()
    for time in (0.0, 1.0, 2.0):
        quiet.look(time, motion(*([0.9 * SLOW_SPEED] * 10)))
    assert not quiet.rests
    least = replace(quiet, peak=1.1 * quiet.peak / REST_ENERGY)
    for time in (3.0, 4.0):
        least.look(time, motion(*([0.9 * SLOW_SPEED] * 10)))
    assert least.rests


def test_fallen_blocks_lie_whole_below_the_start():
    first = np.array([0, 8, 16], np.int32)
    start = np.concatenate([CUBE, CUBE + [0, 0, 1]])
    for drop, expected in ((1.9, []), (2.1, [1])):
        now = np.concatenate([CUBE, CUBE + [0, 0, 1 - drop]])
        assert fallen(first, start, now, [0, 0, -9.81]).tolist() == expected
        assert fallen(first, start, now, [0, 0, 0]).tolist() == []
    aside = np.concatenate([CUBE, CUBE + [2.1, 0, 1]])
    assert fallen(first, start, aside, [1, 0, 0]).tolist() == [1]


SLIDE = """\
title: One block slides to rest, the other off the edge
model:
  blocks:
    - {group: bed, box: {size: [12, 4, 1]}, translate: [0, 0, -1]}
    - {group: stays, box: {size: [1, 1, 1]}, translate: [1, 1, 0]}
    - {group: goes, box: {size: [1, 1, 1]}, translate: [10, 1.5, 0]}
materials: {rock: {density: 2700, young_modulus: "20 MPa", poisson_ratio: 0.25}}
groups:
  bed: {material: rock, fix: [x, y, z]}
  stays: {material: rock, velocity: [1, 0, 0]}
  goes: {material: rock, velocity: [6, 0, 0]}
interfaces: {default: {friction_angle: 30}}
loads: {gravity: [0, 0, -9.81]}
stages:
  - {name: slide, mode: dynamic, duration: 5, until: rest, damping: {contact: 0.5, stiffness: 0.1}}
output: {every: 0.2}
"""


@pytest.fixture
def slide(cube_folder, no_sheets):
    (cube_folder / "slide.yaml").write_text(SLIDE)
    return cube_folder


def test_a_stage_ends_with_rest_and_says_who_left(run_cli, slide):
    status, out, err = run_cli("run", "slide.yaml", "--threads", "1")
    assert status == 0
    assert err.count("fell past the edge of the model") == 1
    assert "warning: block 2 of group goes fell past the edge" in err
    assert (slide / "slide.results/run.log").read_text().count("fell past the edge") == 1
    summary = json.loads((slide / "slide.results/summary.json").read_text())
    assert summary["status"] == summary["stages"][0]["status"] == "at rest"
    # at rest after v / (mu g) = 0.18 s and the span, but not before the other left, then at a row
    assert 0.18 + REST_SPAN < summary["time"] < 2.0
    assert summary["groups"]["stays"]["fastest_block"] < SLOW_SPEED
    assert summary["groups"]["bed"]["fastest_block"] == 0
    told = run_cli("info", "slide.results")[1]
    speed = summary["groups"]["goes"]["fastest_block"]
    moves = f"at rest, still moving at {speed:.3g} m/s (a block of group goes)"
    assert out == f"{moves}; results are in slide.results\n"
    assert told.splitlines()[0].endswith(
        f": at rest, still moving at {speed:.3g} m/s (a block of group goes)"
    )
    assert "warning: block 2 of group goes fell past the edge of the model" in told
    told = run_cli("runout", "slide.results", "--groups", "stays", "--direction", "90")[1]
    assert "deposit: " in told and "still moving" not in told
    told = run_cli("runout", "slide.results")[1]
    assert "deposit: " not in told
    assert "still moving at" in told and "no deposit yet; front and reach are not final" in told


def test_what_left_the_domain_is_not_told_to_be_at_rest(run_cli, slide):
    """Its speed is that of its energy: 6 m/s, less friction over 1.5 m, and 3.5 m of fall or little more."""
    text = SLIDE.replace("model:\n", "model:\n  domain: {min: [null, null, -3]}\n")
    (slide / "slide.yaml").write_text(text)
    status, out, err = run_cli("run", "slide.yaml", "--threads", "1")
    but = "at rest, but for 1 block of group goes that left the domain"
    assert (status, out) == (0, f"{but}; results are in slide.results\n")
    said = r"block 2 of group goes left model.domain at (\S+) m/s: it was at .* m at t = (\S+) s"
    speed, time = map(float, re.search(said, err).groups())
    told = run_cli("info", "slide.results")[1]
    assert told.splitlines()[0].endswith(f": {but}")
    assert re.search(said, told) and re.search(said, (slide / "slide.results/run.log").read_text())
    summary = json.loads((slide / "slide.results/summary.json").read_text())
    slowest = math.sqrt(6**2 - 2 * 9.81 * math.tan(math.radians(30)) * 1.5 + 2 * 9.81 * 3.5)
    assert slowest < speed < math.sqrt(6**2 + 2 * 9.81 * 4) and 0.8 < time < summary["time"]
    assert but.partition(", ")[2] in page_facts(slide / "slide.results")["subtitle"]


def test_rest_is_the_same_for_any_split(slide):
    """Stopped after each report and resumed: the same end, and the edge is told once."""
    case = cdem.Case.load("slide.yaml")
    whole = cdem.Simulation(case, threads=1, output="whole")
    assert whole.run() == "at rest"
    split = cdem.Simulation(case, threads=1, output="split")
    for time in (0.3, 0.9, 1.1):
        split.run_until(time)
        split.checkpoint()
        split.close()
        split = cdem.Simulation(case, threads=1, output="split", resume=True)
    assert split.stage.quiet.peak > 0
    assert split.run() == "at rest"
    assert split.step_count == whole.step_count
    assert split.departures == whole.departures
    np.testing.assert_array_equal(split.motion, whole.motion)
    assert (slide / "split/run.log").read_text().count("fell past the edge") == 1


def test_until_belongs_to_dynamic_stages(run_cli, slide):
    status, _, err = run_cli(
        "check", "slide.yaml", "--set", "stages=[{name: a, mode: static, until: rest}]"
    )
    assert status == 1
    assert "until has no effect in a static stage; remove it" in err


def test_info_of_a_run_that_failed(run_cli, slide):
    """Null where a speed is not finite; a blow-up is no fall past the edge."""
    bad = ("--set", "time.step=0.02", "--set", "stages.0.until=null")
    status, _, err = run_cli("run", "slide.yaml", "--threads", "1", *bad)
    assert status == 3
    assert "fell past the edge" not in err
    assert "failed" in run_cli("info", "slide.results")[1].splitlines()[0]


def test_a_fall_as_fast_as_a_wave_is_said_to_be_a_fall(run_cli, slide):
    rock = ("materials.rock.young_modulus=1 MPa", "stages.0.until=null", "stages.0.duration=20")
    words = [word for setting in rock for word in ("--set", setting)]
    status, _, err = run_cli("run", "slide.yaml", "--threads", "1", *words)
    assert status == 3
    assert "of block 2 (group goes) fell past the edge of the model and now falls at" in err
