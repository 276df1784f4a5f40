"""The verification manual."""

from __future__ import annotations


def test_a_manual_without_the_extra_says_what_is_missing(fall, run_cli, monkeypatch):
    from cdem.errors import CdemError
    from cdem.verification import manual

    def missing(*_):
        raise CdemError("plots need matplotlib")

    monkeypatch.setattr(manual, "pyplot", missing)
    status, _, _ = run_cli("verify", str(fall), "--report", "manual.html")
    assert status == 0
    assert "not drawn, plots need matplotlib" in (fall.parent / "manual.html").read_text()
