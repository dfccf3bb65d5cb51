"""Limits every request to the survey's server and adds security headers to every response."""

import json
import re
import sys
from http import HTTPStatus

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MOST_BYTES = 64 * 1024  # of a body: a page of remarks in any alphabet, many times over
MOST_ADDRESS = 2048  # bytes
OUR_PAGES = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; media-src 'self'; "
    "frame-src 'self'; connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
FRAMES = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'; sandbox allow-scripts"
)
"""Content security policy of a 3-D view. The page contains its scripts; it may neither fetch anything nor
reach the page around it."""
HEADERS = {
    "Server": "roadgpt",
    "Cache-Control": "no-store",
    "Content-Security-Policy": OUR_PAGES,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",  # the address is the rater's key
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=()",
    "X-Robots-Tag": "noindex, nofollow",
}
"""Headers of every response, unless the response sets them itself."""


class RequestGuard:
    """ASGI middleware that refuses requests beyond the limits, adds ``HEADERS`` and reports errors."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers one request."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        status = _refused_with(scope)
        app = refusal(scope["path"], status) if status else self.app
        try:
            await app(scope, receive, send_with_headers)
        except ClientDisconnect:
            pass  # the rater went away; nobody is there to be answered
        except Exception as error:  # Starlette has answered with status 500 by now
            sys.stderr.write(f"roadgpt: a request could not be answered ({error!r})\n")


def _refused_with(scope: Scope) -> int:
    """Returns the status with which a request is refused; 0 if it is within the limits."""
    if len(scope["raw_path"]) + len(scope["query_string"]) > MOST_ADDRESS:
        return 414
    if scope["method"] == "POST":
        headers = Headers(scope=scope)
        length = headers.get("content-length", "")
        if "transfer-encoding" in headers or not re.fullmatch("[0-9]{1,20}", length, re.ASCII):
            return 411
        if int(length) > MOST_BYTES:
            return 413
    return 0


def refusal(path: str, status: int, sentence: str = "") -> Response:
    """Returns a response that consists of one sentence, by default the standard phrase of the HTTP status,
    and closes the connection. The sentence must not quote the request. Requests to ``/answer`` come from the
    pages' script and are answered in JSON."""
    sentence = sentence or f"{HTTPStatus(status).phrase}."
    if path.endswith("/answer"):
        content, kind = json.dumps({"error": sentence}), "application/json"
    else:
        content, kind = sentence, "text/plain"
    return Response(content, status, {"Connection": "close"}, media_type=kind)
