"""`cdem view`: the page into a file, to a browser, or one line of what is wrong."""

from __future__ import annotations

from http.server import ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from cdem.cli import result_commands


@pytest.fixture
def results(run_cli, cube_folder) -> Path:
    """The results of a cube that falls."""
    assert run_cli("run", "cube.yaml", "--quiet", "--threads", "1")[0] == 0
    return Path("cube.results")


def test_the_page_into_a_file(run_cli, results):
    status, out, err = run_cli("view", str(results), "--save", "page.html", "--budget", "0.5")
    assert (status, out, err) == (0, "page.html\n", "")
    assert run_cli("view", str(results), "--budget", "0.5")[0] == 2
    assert 60_000 < Path("page.html").stat().st_size < 500_000


def test_the_address_is_told_and_opened_where_there_is_a_screen(run_cli, results, monkeypatch):
    def interrupted(server):
        raise KeyboardInterrupt

    opened = []

    def open_browser(address):
        """Other users see what the browser is called with, but cannot read that file."""
        path = Path(urlsplit(address).path)
        assert "http" not in address and path.stat().st_mode & 0o077 == 0
        assert path.parent.stat().st_mode & 0o077 == 0
        opened.append((path, path.read_text()))

    monkeypatch.setattr(ThreadingHTTPServer, "serve_forever", interrupted)
    monkeypatch.setattr(result_commands.webbrowser, "open", open_browser)
    for screen, options, found in (("", [], 0), (":0", [], 1), (":0", ["--no-browser"], 1)):
        monkeypatch.setenv("DISPLAY", screen)
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        status, out, err = run_cli("view", str(results), *options)
        assert (status, err, len(opened)) == (0, "", found)
        assert out.startswith("http://127.0.0.1:") and "Ctrl-C" in out
        if found:
            assert not opened[0][0].exists() and "url=http://127.0.0.1:" in opened[0][1]


def test_other_folders_are_one_line(run_cli, tmp_path):
    for folder, why in (
        (tmp_path / "none", "no such folder"),
        (tmp_path, "is not a result folder"),
    ):
        status, out, err = run_cli("view", str(folder))
        assert (status, out) == (1, "") and why in err and err.count("\n") == 1
