"""The server of the page: who has no token gets nothing, and what is sent is only what is new."""

from __future__ import annotations

import contextlib
import http.client
import json
import socket
import threading
import time
from urllib.parse import urlsplit

import pytest
from scenes import case
from shared.served import served

import cdem
from cdem.errors import CdemError
from cdem.output import view
from cdem.output.view import HERE, ViewServer
from cdem.output.web_page import RunPage


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Results of a box that falls."""
    blocks = [{"group": "box", "box": {"size": [1, 1, 1]}}]
    stages = [{"name": "fall", "mode": "dynamic", "duration": 0.01}]
    path = tmp_path_factory.mktemp("view") / "fall.results"
    cdem.Simulation(
        case(blocks, {"box": {}}, stages=stages, output={"every": 0.005}), output=path, threads=1
    ).run()
    return path


@pytest.fixture
def server(folder):
    with served(folder) as server:
        yield server


def ask(server, path, **headers):
    """Status, headers and body of an answer; the path follows the token."""
    connection = http.client.HTTPConnection(HERE, server.server_port, timeout=10)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    return answer.status, answer.headers, answer.read()


def test_the_page_is_sent_with_its_policy(server):
    status, headers, body = ask(server, urlsplit(server.address).path)
    assert status == 200 and body.startswith(b"<!doctype html>") and b"data-live" in body
    assert b"default-src &#39;none&#39;" in body and b"unsafe" not in body
    assert headers["Referrer-Policy"] == "no-referrer" and headers["X-Frame-Options"] == "DENY"
    assert server.address.startswith("http://127.0.0.1:")


@pytest.mark.parametrize("path", ["/", "/wrong/", "/wrong/state", "//", "/%C3%A9"])
def test_without_the_token_nothing_is_told(server, path):
    status, _, body = ask(server, path)
    assert (status, body) == (403, b"wrong address: use the address printed by cdem view\n")


def test_a_name_that_another_site_has_bent_to_this_machine_is_refused(server):
    page = urlsplit(server.address).path
    assert ask(server, page, Host=f"evil.example:{server.server_port}")[0] == 403
    assert ask(server, page, Host=f"localhost:{server.server_port}")[0] == 200


def test_only_what_is_new_is_sent(server, folder):
    base = urlsplit(server.address).path
    state = json.loads(ask(server, f"{base}state")[2])
    assert (state["frames"], state["over"]) == (3, True)
    sizes = [len(ask(server, f"{base}data?frames={k}&rows=0")[2]) for k in (0, 2, 3)]
    assert sizes[0] > sizes[1] > sizes[2]
    assert ask(server, f"{base}data?frames=many")[0] == 500
    assert ask(server, f"{base}../../etc/passwd")[0] == 404
    assert RunPage(folder).state() == state


def test_a_port_in_use_is_one_line(server, folder):
    with pytest.raises(CdemError, match=r"port \d+: Address already in use; name another"):
        ViewServer(folder, server.server_port)


def raw(server, request: bytes) -> bytes:
    """What is answered to these bytes."""
    with socket.create_connection((HERE, server.server_port), timeout=10) as connection:
        connection.sendall(request)
        return connection.recv(1000)


def test_an_address_that_is_none_is_answered_in_silence(server, capfd):
    assert b" 400 " in raw(server, b"GET http://[::1/x HTTP/1.1\r\nHost: a\r\n\r\n")
    raw(server, b"\xff\x00 GET\r\n\r\n")
    assert capfd.readouterr().err == ""


def test_connections_that_stay_open_keep_few_threads_and_not_for_long(server, monkeypatch):
    """120 of them ask for nothing, or for a letter now and then."""
    monkeypatch.setattr(view, "PATIENCE", 1.0)
    before = threading.active_count()
    there = [socket.create_connection((HERE, server.server_port)) for _ in range(120)]
    try:
        time.sleep(0.5)
        assert threading.active_count() <= before + 2 * view.MOST_THREADS
        began = time.monotonic()
        while time.monotonic() < began + 5 and threading.active_count() > before:
            for connection in there:
                with contextlib.suppress(OSError):
                    connection.send(b"G")
            time.sleep(0.1)
        assert threading.active_count() <= before
        assert ask(server, urlsplit(server.address).path)[0] == 200
    finally:
        for connection in there:
            connection.close()
