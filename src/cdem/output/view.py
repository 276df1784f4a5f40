"""The page of a run, served to a browser on this machine, live while it runs.

A viewer needs the address, which contains a token. Other machines cannot reach it; neither can
pages
of other sites, although they can make the browser send requests (token and host name prevent this).
"""

from __future__ import annotations

import contextlib
import hmac
import json
import secrets
import socket
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from cdem.errors import CdemError
from cdem.output.web_page import RunPage

HERE = "127.0.0.1"
MOST = 100_000_000
"""Most bytes sent at once; else digits and frames are dropped."""
MOST_THREADS = 32
"""Requests answered at the same time; a browser sends six."""
PATIENCE = 30.0
"""Wall time of a request from its first byte to the last of the answer [s]."""


class ViewServer(ThreadingHTTPServer):
    """Serves the page of one result folder until `shutdown`.

    Args:
        folder: Result folder.
        port: Port to listen on; 0 for any free port.

    Attributes:
        address: Address of the page.

    Raises:
        CdemError: The port is in use, or not allowed.
    """

    daemon_threads = True
    request_queue_size = MOST_THREADS

    def __init__(self, folder: Path, port: int = 0) -> None:
        try:
            super().__init__((HERE, port), _Handler)
        except (OSError, OverflowError) as error:
            why = getattr(error, "strerror", None) or error
            raise CdemError(f"port {port}: {why}; name another with --port") from None
        self.page = RunPage(folder)
        self.lock = threading.Lock()
        self._free = threading.BoundedSemaphore(MOST_THREADS)
        self.token = secrets.token_urlsafe(16)
        self.hosts = {f"{name}:{self.server_port}" for name in (HERE, "localhost")}
        self.address = f"http://{HERE}:{self.server_port}/{self.token}/"

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread, if one is free; else close the connection."""
        if not self._free.acquire(blocking=False):
            self.shutdown_request(request)
            return
        try:
            super().process_request(request, client_address)
        except RuntimeError:  # the system has no more threads
            self._free.release()
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer a request; a client slower than `PATIENCE` is cut off."""
        late = threading.Timer(PATIENCE, _cut, [request])
        late.daemon = True
        late.start()
        try:
            super().process_request_thread(request, client_address)
        finally:
            late.cancel()
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore a browser that closed the connection."""
        if not isinstance(sys.exc_info()[1], OSError | ValueError):
            super().handle_error(request, client_address)


def _cut(request: socket.socket) -> None:
    """End a connection, even while a thread waits for it."""
    with contextlib.suppress(OSError):
        request.shutdown(socket.SHUT_RDWR)


class _Handler(BaseHTTPRequestHandler):
    """Answers one request."""

    server: ViewServer
    server_version, sys_version = "cdem", ""

    def do_GET(self) -> None:
        """Send the page, the state of the run, or new data."""
        try:
            url = urlsplit(self.path)
        except ValueError:
            self._send(400, "text/plain", b"no address\n")
            return
        _, token, *rest = (*url.path.split("/"), "")[:3]
        known = hmac.compare_digest(token.encode(), self.server.token.encode())
        if not known or self.headers.get("Host") not in self.server.hosts:
            self._send(403, "text/plain", b"wrong address: use the address printed by cdem view\n")
            return
        try:
            self._answer(rest[0], parse_qs(url.query))
        except (CdemError, ValueError, OSError) as error:
            self._send(500, "text/plain", f"{error}\n".encode())

    def _answer(self, what: str, query: dict[str, list[str]]) -> None:
        page = self.server.page
        if what == "":
            self._send(200, "text/html", page.html().encode())
        elif what == "state":
            self._send(200, "application/json", json.dumps(page.state()).encode())
        elif what == "data":
            frames, rows = (max(0, int(query.get(key, ["0"])[0])) for key in ("frames", "rows"))
            with self.server.lock:
                data = page.pack(frames, rows, MOST)
            self._send(200, "application/octet-stream", data)
        else:
            self._send(404, "text/plain", b"no such page\n")

    def _send(self, status: int, kind: str, body: bytes) -> None:
        headers = {
            "Content-Type": f"{kind}; charset=utf-8",
            "Content-Length": str(len(body)),
            "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "X-Frame-Options": "DENY",
            "Cross-Origin-Resource-Policy": "same-origin",
        }
        try:
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)
        except OSError:  # the browser closed the page, or was too slow
            self.close_connection = True

    def log_message(self, format: str, *args: object) -> None:
        """Keep quiet."""
