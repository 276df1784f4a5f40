"""The page of a run, served to a browser on this machine; it follows a run that goes on.

Who wants to see it needs the address: it holds a token. Other machines cannot reach it, and pages of
other sites neither, though they may make the browser ask (the token, and the name of the host).
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
"""Bytes that are sent at once at most; else digits and frames are left out."""
MOST_THREADS = 32
"""Requests that are answered at a time; a browser has six."""
PATIENCE = 30.0
"""Wall time of a request from its first byte to the last of the answer [s]."""


class ViewServer(ThreadingHTTPServer):
    """Serves the page of one result folder until `shutdown`.

    Args:
        folder: Result folder.
        port: Where to listen; 0 for any that is free.

    Attributes:
        address: Where the page is.

    Raises:
        CdemError: The port is in use, or may not be used.
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
        """Answer in a thread, if one is free; else close."""
        if not self._free.acquire(blocking=False):
            self.shutdown_request(request)
            return
        try:
            super().process_request(request, client_address)
        except RuntimeError:  # the system has no more threads
            self._free.release()
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer a request; who takes longer than `PATIENCE` to ask or to take is cut off."""
        late = threading.Timer(PATIENCE, _cut, [request])
        late.daemon = True
        late.start()
        try:
            super().process_request_thread(request, client_address)
        finally:
            late.cancel()
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a browser that went away."""
        if not isinstance(sys.exc_info()[1], OSError | ValueError):
            super().handle_error(request, client_address)


def _cut(request: socket.socket) -> None:
    """End a connection, whoever waits for it."""
    with contextlib.suppress(OSError):
        request.shutdown(socket.SHUT_RDWR)


class _Handler(BaseHTTPRequestHandler):
    """Answers one request."""

    server: ViewServer
    server_version, sys_version = "cdem", ""

    def do_GET(self) -> None:
        """Send the page, the state of the run, or what is new."""
        try:
            url = urlsplit(self.path)
        except ValueError:
            self._send(400, "text/plain", b"no address\n")
            return
        _, token, *rest = (*url.path.split("/"), "")[:3]
        known = hmac.compare_digest(token.encode(), self.server.token.encode())
        if not known or self.headers.get("Host") not in self.server.hosts:
            self._send(403, "text/plain", b"wrong address: take that which cdem view has printed\n")
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
        except OSError:  # the browser has closed the page meanwhile, or was too slow
            self.close_connection = True

    def log_message(self, format: str, *args: object) -> None:
        """Keep quiet."""
