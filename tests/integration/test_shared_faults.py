"""What may happen to a run that ranks share: full disks, signals, errors of one rank, odd scripts."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from functools import partial

import numpy as np
import pytest
from ruamel.yaml import YAML
from shared.cases import CUBE, WALL
from shared.mpi import ENVIRONMENT, command, needs_mpi, ranks
from shared.ranks import on_ranks
from shared.stopped import content

from cdem import Case, Simulation
from cdem.errors import CdemError, DiskError
from cdem.ranks.shared_core import SharedCore

END = 15.0  # all ranks end so long after one fails [s]
LONG = WALL.replace('"5 ms"', "100").replace('"1 ms"', "1")
ALONE = """
import sys
from cdem.ranks.launch import launched_rank
from cdem.ranks.shared_core import SharedCore

def run(self, *words, **named):
    if launched_rank() == 1:
        raise RuntimeError("no room for contacts")
    return done(self, *words, **named)

done, SharedCore.run = SharedCore.run, run
sys.argv = ["cdem", "run", "model.yaml"]
from cdem.cli import main
main()
"""
SLOW = """
import sys, time
from cdem.cli import main, run_commands
from cdem.ranks import failures

def write(folder):
    time.sleep(3 * failures.PATIENCE)
    (folder / "report.html").write_text("slow")

failures.PATIENCE = 1.0
run_commands.write_report = write
sys.argv = ["cdem", "run", "model.yaml", "--threads", "1"]
main()
"""


def wall(refresh=None, **how) -> Simulation:
    """A wall that is pushed."""
    data = YAML(typ="safe").load(WALL) | ({"contact": {"refresh": refresh}} if refresh else {})
    return Simulation(Case.from_dict(data), threads=1, **how)


def error_of(act) -> BaseException:
    """The error that something ends with."""
    try:
        act()
    except Exception as error:
        return error
    raise AssertionError("no error")


# ------------------------------------------------------------------ in one process


@pytest.mark.parametrize("count", [pytest.param(2, marks=pytest.mark.slow), 5])
def test_more_ranks_than_elements(count, tmp_path):
    case = Case.from_dict(YAML(typ="safe").load(CUBE))
    Simulation(case, threads=1, output=tmp_path / "one").run()
    on_ranks(count, lambda _: Simulation(case, threads=1, output=tmp_path / "some").run())
    assert content(tmp_path / "some") == content(tmp_path / "one")


@pytest.mark.parametrize("call", ["checkpoint", "record", "finish"])
def test_a_full_disk_ends_all_ranks_alike(call, tmp_path, monkeypatch):
    """The first rank writes; what it fails to do, all fail to do."""

    def full(*_, **__):
        raise DiskError("results/file: cannot be written (No space left on device)")

    def act(exchange):
        simulation = wall(output=tmp_path / "results")
        exchange.share_text("")  # all have begun
        if exchange.rank == 0:
            name = {"record": "write"}.get(call, call)
            monkeypatch.setattr(f"cdem.run.result_folder.Results.{name}", full)
        exchange.share_text("")
        return error_of(simulation.run)

    errors = on_ranks(3, act)
    assert [type(error) for error in errors] == [DiskError] * 3
    assert "No space left on device). Free disk space" in str(errors[0])
    assert len({str(error) for error in errors}) == 1


def test_a_wrong_case_is_wrong_on_all_ranks():
    case = YAML(typ="safe").load(WALL)
    case["model"]["blocks"][0]["box"]["size"] = [6, 3, -1]
    errors = on_ranks(2, lambda _: error_of(lambda: Simulation(case, threads=1)))
    assert len({str(error) for error in errors}) == 1
    assert isinstance(errors[0], CdemError)


def test_a_folder_with_results_is_refused_or_replaced(tmp_path):
    def act(folder, exchange, **how):
        return wall(output=folder, **how).run()

    folder = tmp_path / "results"
    on_ranks(2, partial(act, folder))
    before = content(folder)
    errors = on_ranks(2, lambda exchange: error_of(partial(act, folder, exchange)))
    assert [str(error) for error in errors] == [str(errors[0])] * 2
    assert "--overwrite" in str(errors[0])
    assert on_ranks(2, partial(act, folder, resume=True)) == ["finished"] * 2
    assert content(folder) == before
    assert on_ranks(2, partial(act, folder, overwrite=True)) == ["finished"] * 2
    assert content(folder) == before


def test_a_folder_is_of_one_run_at_a_time(tmp_path):
    folder = tmp_path / "results"
    busy = wall(output=folder)
    errors = on_ranks(2, lambda _: error_of(lambda: wall(output=folder, overwrite=True)))
    assert all("a run is writing into this folder" in str(error) for error in errors)
    busy.close()


def test_scripts_look_change_and_end(tmp_path):
    """`every`, `set` and steps give the same on ranks."""

    def act(_=None):
        simulation, seen = wall(), []

        def look(sim):
            seen.append((sim.time, sim.fields["velocity"].sum(), sim.energies, sim.broken))
            if len(seen) == 3:
                sim.set("interfaces.default.friction_angle", 5)
            return len(seen) == 5

        simulation.every(5e-4, look)
        ended = simulation.run()
        simulation.step(7)
        groups = {
            name: dict(one) for name, one in simulation.groups.items() if isinstance(one, dict)
        }
        return (
            ended,
            seen,
            simulation.motion.tobytes(),
            simulation.contacts["force"].tobytes(),
            groups,
        )

    one = act()
    assert one[0] == "ended"
    assert on_ranks(3, act) == [one] * 3


def test_an_action_ends_the_stage_on_all_ranks_where_it_does_on_the_first():
    """Clocks differ."""

    def act(exchange):
        simulation = wall()
        simulation.every(1e-3, lambda sim: exchange.rank == (0 if sim.time > 2.5e-3 else 1))
        return simulation.run(), simulation.step_count

    first, second = on_ranks(2, act, timeout=END)
    assert first == second
    assert first[0] == "ended"


def test_nodes_are_not_moved_by_hand():
    """Ranks would lose it, so numpy refuses; the message names the array's state."""

    def act(_):
        simulation = wall()
        simulation.step(3)
        with pytest.raises(ValueError, match="read-only"):
            simulation.motion[0, 0] = 1.0
        with pytest.raises(ValueError, match="read-only"):
            simulation.core.fields()["node.motion"][0] = 1.0
        simulation.step(3)
        return simulation.motion.tobytes()

    simulation = wall()
    simulation.step(6)
    assert on_ranks(2, act) == [simulation.motion.tobytes()] * 2


def test_the_error_of_one_rank_within_steps_ends_the_others(monkeypatch):
    run = SharedCore.run

    def failing(core, *words, **named):
        if core.exchange.rank == 1:
            raise RuntimeError("no room for contacts")
        return run(core, *words, **named)

    monkeypatch.setattr(SharedCore, "run", failing)
    with pytest.raises(RuntimeError, match="no room for contacts"):
        on_ranks(3, lambda _: wall().run(), timeout=END)


def test_ghosts_that_are_due_without_a_step_are_told(monkeypatch):
    """No endless loop."""
    from cdem.ranks.parts import Fences

    nowhere = partial(np.full, fill_value=1e9)
    monkeypatch.setattr(Fences, "of_nodes", lambda _, some: nowhere((len(some), 8)))
    with pytest.raises(RuntimeError, match="ghosts are due at once at step 10"):
        on_ranks(2, lambda _: wall(refresh=10).run(), timeout=END)


# ------------------------------------------------------------------ the program


@needs_mpi
def test_the_error_of_the_core_on_one_rank_is_told(wall_folder):
    (wall_folder / "model.yaml").write_text(WALL)
    (wall_folder / "alone.py").write_text(ALONE)
    status, _, errors, took = ranks(2, "alone.py", cwd=wall_folder)
    assert status == 70
    assert "rank 1 of 2: Traceback" in errors
    assert errors.count("RuntimeError: no room for contacts") == 1
    assert took < END


@needs_mpi
def test_an_unstable_run_has_a_report_however_long_it_takes(wall_folder):
    """The ranks that do not write it wait for it; else they would end the one that does."""
    fast = WALL.replace("loose: {material: rock}", "loose: {material: rock, velocity: [0, 0, 1e5]}")
    (wall_folder / "model.yaml").write_text(fast)
    (wall_folder / "slow.py").write_text(SLOW)
    status, _, errors, _ = ranks(2, "slow.py", cwd=wall_folder)
    assert status == 3
    assert errors.count("faster than the P wave of the rock") == 1
    assert "rank 1" not in errors
    assert (wall_folder / "model.results" / "report.html").exists()


@needs_mpi
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_stops_a_run_with_a_checkpoint(wall_folder, number):
    (wall_folder / "model.yaml").write_text(LONG)
    words = ["-m", "cdem", "run", "model.yaml", "--threads", "1", "--quiet"]
    with subprocess.Popen(
        command(2, *words), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | ENVIRONMENT,
    ) as run:  # fmt: skip
        folder, until = wall_folder / "model.results", time.monotonic() + END
        while not (folder / "histories.csv").exists() and time.monotonic() < until:
            time.sleep(0.05)
        run.send_signal(number)
        _, errors = run.communicate(timeout=END)
    assert run.returncode == 4
    assert errors.count("stopped with a checkpoint; continue with: cdem run") == 1
    assert errors.count("once more to stop at once") == 1
    assert (folder / "checkpoint.h5").exists()


@needs_mpi
def test_a_full_disk_is_told_once(wall_folder):
    """The first rank has no room for files above 20 kB."""
    (wall_folder / "limited.py").write_text(
        "import resource, signal, sys\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "from cdem.ranks.launch import launched_rank\n"
        "from cdem.ranks.mpi import world\n"
        "world()\n"
        "if launched_rank() == 0:\n"
        "    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))\n"
        "sys.argv = ['cdem', 'run', 'model.yaml', '--threads', '1']\n"
        "from cdem.cli import main\n"
        "main()\n"
    )
    status, _, errors, took = ranks(2, "limited.py", cwd=wall_folder)
    assert status == 1
    assert errors.count("File too large") == 1
    assert took < END
