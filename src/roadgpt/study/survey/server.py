"""The survey's own small HTTP server: limits, headers and files; what is answered says ``desk``."""

import os
import re
import socket
import sqlite3
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from roadgpt.errors import UsageError
from roadgpt.study.survey.desk import JSON, Asked, Desk, Told

MOST_BYTES = 64 * 1024  # of a body: a page of remarks in any alphabet, many times over
MOST_ADDRESS = 2048  # bytes
MOST_AT_ONCE = 600  # connections; a browser opens up to six
PATIENCE = 15.0  # s that a connection may say nothing
SLOWEST = 60.0  # s in which a whole request must have come, however slowly it drips in
PIECE = 64 * 1024  # bytes of a file that are sent at once
BUSY = b"HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nRetry-After: 2\r\nContent-Length: 0\r\n\r\n"
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",  # the address is the rater's key
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=()",
    "X-Robots-Tag": "noindex, nofollow",
}
OUR_PAGES = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; media-src 'self'; "
    "frame-src 'self'; connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
FRAMES = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'; sandbox allow-scripts"
)
"""A 3-D view carries its scripts in itself; it may neither fetch nor reach the page around it."""
KEPT, SEEN_ANEW = "private, max-age=3600", "no-store"


class Server(ThreadingHTTPServer):
    """Answers many raters at once, each in a thread of its own; ends without waiting for them."""

    daemon_threads = True
    request_queue_size = 128

    def __init__(self, desk: Desk, host: str = "127.0.0.1", port: int = 0, most: int = MOST_AT_ONCE) -> None:
        self.desk = desk
        self._free = threading.BoundedSemaphore(most)
        try:
            self.address_family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
            super().__init__((host, port), Handler)
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            raise UsageError(
                f"cannot listen on {host}, port {port} ({reason}); name another with --port or --host"
            ) from error

    def process_request(self, request: Any, client_address: Any) -> None:
        """Hand a connection to a thread, unless too many are at work."""
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
            return
        with suppress(OSError):
            request.sendall(BUSY)
        self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """A connection's whole life."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A rater who went away is no error; anything else is told without saying whose."""
        error = sys.exc_info()[1]
        if not isinstance(error, OSError):
            sys.stderr.write(f"roadgpt: a request could not be answered ({error!r})\n")


def _stop_listening(connection: socket.socket) -> None:
    with suppress(OSError):  # it is closed already
        connection.shutdown(socket.SHUT_RD)


class Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: Server
    protocol_version = "HTTP/1.1"
    timeout = PATIENCE

    def handle_one_request(self) -> None:
        """The next request; one that drips in for longer than ``SLOWEST`` is cut off, what is sent is not."""
        cut = threading.Timer(SLOWEST, _stop_listening, [self.connection])
        cut.daemon = True
        cut.start()
        try:
            super().handle_one_request()
        finally:
            cut.cancel()

    def version_string(self) -> str:
        """No versions: nobody needs to know them."""
        return "roadgpt"

    def log_message(self, *said: Any) -> None:
        """Nothing is logged: addresses are raters' keys, and network addresses are nobody's business."""

    def do_GET(self) -> None:
        """A page or a file."""
        self._answer(b"")

    def do_HEAD(self) -> None:
        """As GET, without the body."""
        self._answer(b"")

    def do_POST(self) -> None:
        """Answers."""
        length = self.headers.get("Content-Length", "")
        if "Transfer-Encoding" in self.headers or not re.fullmatch("[0-9]{1,9}", length, re.ASCII):
            self.send_error(411)
        elif int(length) > MOST_BYTES:
            self.send_error(413)
        else:
            body = self.rfile.read(int(length))
            if len(body) == int(length):  # else whoever sent it went away in the middle
                self._answer(body)

    def __getattr__(self, name: str) -> Any:
        """Methods of other names are answered as well; http.server asks for do_METHOD."""
        if name.startswith("do_"):
            return self._refuse
        raise AttributeError(name)

    def _refuse(self) -> None:
        self.close_connection = True  # it may bring a body, which nobody reads
        self._answer(b"")

    def _answer(self, body: bytes) -> None:
        if len(self.path) > MOST_ADDRESS:
            self.send_error(414)
            return
        method = "GET" if self.command == "HEAD" else self.command
        kind = self.headers.get("Content-Type", "").split(";")[0].strip().lower()
        try:
            told = self.server.desk.answer(Asked(method, self.path, kind, body))
        except sqlite3.Error as error:
            sys.stderr.write(f"roadgpt: an answer could not be saved ({error})\n")
            self.send_error(503, explain="Your answer could not be saved. Please try again in a moment.")
            return
        if told.file is not None:
            self._send_file(told)
        else:
            self._head(told.status, len(told.body), told.kind, told.headers)
            self._write(told.body)

    def _send_file(self, told: Told) -> None:
        """A file, or the part of it that was asked for: some phones play no film otherwise."""
        assert told.file is not None
        try:
            file = told.file.open("rb")
        except OSError:
            self.send_error(404)
            return
        with file:
            size = os.fstat(file.fileno()).st_size
            first, last = 0, size - 1
            headers = {"Accept-Ranges": "bytes", "Cache-Control": KEPT}
            if told.is_frame:
                headers["Content-Security-Policy"] = FRAMES
            status, wanted = 200, _range_of(self.headers.get("Range", ""), size)
            if wanted is not None:
                first, last = wanted
                if first > last:
                    self._head(416, 0, told.kind, headers | {"Content-Range": f"bytes */{size}"})
                    return
                status = 206
                headers["Content-Range"] = f"bytes {first}-{last}/{size}"
            self._head(status, last - first + 1, told.kind, headers)
            file.seek(first)
            left = last - first + 1
            while left > 0 and self.command != "HEAD":
                piece = file.read(min(PIECE, left))
                if not piece:
                    self.close_connection = True
                    return
                self.wfile.write(piece)
                left -= len(piece)

    def _head(self, status: int, length: int, kind: str, headers: Mapping[str, str]) -> None:
        self.send_response(status)
        usual = {"Cache-Control": SEEN_ANEW, "Content-Security-Policy": OUR_PAGES, "Content-Type": kind}
        for name, value in (HEADERS | usual | {"Content-Length": str(length)} | dict(headers)).items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()

    def _write(self, body: bytes) -> None:
        if self.command != "HEAD":
            self.wfile.write(body)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """A sentence; nothing of the request stands in it. The connection is closed."""
        self.close_connection = True
        said = explain or f"{HTTPStatus(code).phrase}."
        body, kind = (said.encode(), "text/plain; charset=utf-8")
        if getattr(self, "path", "").endswith("/answer"):
            body, kind = (b'{"error": "' + said.encode() + b'"}', JSON)
        self.request_version = self.protocol_version  # a broken first line is answered in words, too
        self._head(code, len(body), kind, {})
        self._write(body)


def _range_of(asked: str, size: int) -> tuple[int, int] | None:
    """First and last byte of a single range; None where there is none that we take; first > last: beyond."""
    found = re.fullmatch(r"bytes=(\d{0,15})-(\d{0,15})", asked.strip(), re.ASCII)
    if found is None or not any(found.groups()):
        return None
    first, last = found.groups()
    if not first:
        return max(0, size - int(last)), size - 1
    if last and int(last) < int(first):
        return None
    return int(first), min(int(last), size - 1) if last else size - 1
