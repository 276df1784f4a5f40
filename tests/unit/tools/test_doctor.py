"""What works on this machine."""

from __future__ import annotations

from cdem import __version__
from cdem.tools import doctor


def test_doctor_says_what_works(run_cli, monkeypatch):
    monkeypatch.setattr(doctor, "_opengl", lambda: "not tried")  # takes seconds
    status, out, _ = run_cli("doctor")
    assert status == 0
    assert f"cdem      {__version__}" in out
    assert " is used; built for " in out


def test_doctor_says_who_chose_the_core(monkeypatch):
    monkeypatch.setenv("CDEM_ISA", doctor._core()[0].split()[0])
    core, usable = doctor._core()
    assert usable
    assert " is used, as CDEM_ISA says; built for " in core
