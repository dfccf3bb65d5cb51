"""An HTTP client that limits the size and time of every response and refuses redirects to other servers.

Any response, even an error message, may be a gigabyte long, and a compressed response of a megabyte may
unpack to a gigabyte. So every response is decompressed piece by piece, and only up to the limit. The library
``openai`` uses this client and repeats requests that failed; a response header, added by this client, tells
the library which failures may be temporary."""

import contextvars
import json
import threading
import time
import zlib
from collections.abc import Iterator
from typing import Any
from urllib.parse import urljoin, urlsplit

import httpx2
from openai import DefaultHttpxClient

from roadgpt.chat.answer import BUSY, NotReadableError, RequestError, is_spent_up, plain
from roadgpt.chat.model import origin_of

PACKED = {"gzip", "x-gzip"}
ASK_FOR = "gzip"
GZIP = 31  # zlib's window bits for gzip with the largest window
OF_AN_ERROR = 100_000  # bytes; the message of an error is at its beginning
FIRST_ERROR = 400
GRACE = 0.2  # s after the time limit, in which the request itself may report the problem


class BrokenOffError(httpx2.ReadError):
    """Raised if the connection ends in the middle of a response."""


class LimitedClient(DefaultHttpxClient):
    """An HTTP client that returns only complete responses, within limits of size and time."""

    def __init__(self, most: int, seconds: float) -> None:
        """Takes the size limit of a decompressed response in bytes, and the time limit of one attempt in
        seconds."""
        self.most, self.seconds = most, seconds
        super().__init__(event_hooks={"response": [self._limited]})

    def send(self, request: httpx2.Request, **how: Any) -> httpx2.Response:
        """Sends one request and returns the response; gives up at the time limit, even if data are still
        arriving slowly.

        Raises:
            httpx2.TransportError: the response is missing or incomplete; the library ``openai`` may send the
                request again.
            RequestError: the server redirects to another server, or compresses its answer by a method that
                was not requested.
            NotReadableError: the response is larger than the size limit."""
        box: list[Any] = []
        context, send = contextvars.copy_context(), super().send

        def work() -> None:
            try:
                box.append(send(request, **how))
            except BaseException as error:  # passed to the waiting thread
                box.append(error)

        thread = threading.Thread(target=context.run, args=(work,), daemon=True)
        thread.start()
        thread.join(self.seconds + GRACE)
        if not box:
            raise httpx2.ReadTimeout("no complete response", request=request)
        if isinstance(box[0], BaseException):
            raise box[0]
        return _graded(box[0])

    def _limited(self, response: Any) -> None:
        here = str(response.request.url)
        if "location" in response.headers and 300 <= response.status_code < FIRST_ERROR:
            _stay(here, response.headers["location"])
        packing = response.headers.get("content-encoding", "identity").strip().lower()
        if packing not in PACKED | {"identity", ""}:
            raise RequestError(
                f"{_host(here)} compresses its answer as '{plain(packing, 20)}', which was not requested"
            )
        if "content-encoding" in response.headers:
            del response.headers["content-encoding"]
        most = min(OF_AN_ERROR, self.most) if response.status_code >= FIRST_ERROR else self.most
        response.stream = _Within(response, most, self.seconds, packing in PACKED)


class _Within(httpx2.SyncByteStream):
    """The bytes of a response, decompressed and limited."""

    def __init__(self, response: Any, most: int, seconds: float, is_packed: bool) -> None:
        self.stream, self.most = response.stream, most
        self.is_error = response.status_code >= FIRST_ERROR
        self.unpacker = zlib.decompressobj(GZIP) if is_packed else None
        self.deadline = time.monotonic() + seconds

    def __iter__(self) -> Iterator[bytes]:
        """Yields the pieces of a response; for an error response, only those at the beginning."""
        left = self.most
        try:
            for part in self.stream:
                if time.monotonic() > self.deadline:
                    raise httpx2.ReadTimeout("no complete response")
                piece = self._unpacked(part, left + 1)
                if len(piece) > left and not self.is_error:
                    raise NotReadableError(
                        f"it has more than {self.most:,} bytes, which is far more than was asked for"
                    )
                yield piece[:left]
                left -= len(piece)
                if left < 0:
                    return
        except httpx2.TimeoutException:
            raise
        except httpx2.TransportError as error:
            raise BrokenOffError(str(error)) from error

    def _unpacked(self, part: bytes, most: int) -> bytes:
        if self.unpacker is None:
            return part
        try:
            return self.unpacker.decompress(part, most)
        except zlib.error as error:
            raise RequestError(f"the compressed answer cannot be decompressed ({error})") from None

    def close(self) -> None:
        """Closes the connection."""
        self.stream.close()


def _graded(response: httpx2.Response) -> httpx2.Response:
    """Corrects the status of an error that was sent with a status of success, and sets the header that tells
    the library whether to try again."""
    if response.status_code < FIRST_ERROR:
        try:
            body = json.loads(response.content)
        except (ValueError, RecursionError):
            return response
        error = body.get("error") if isinstance(body, dict) else None
        if not error or body.get("choices") or body.get("output"):
            return response
        code = error.get("code") if isinstance(error, dict) else None
        response.status_code = code if isinstance(code, int) and FIRST_ERROR <= code < 600 else 500
    may_pass = response.status_code in BUSY and not is_spent_up(response.status_code, response.text)
    response.headers["x-should-retry"] = str(may_pass).lower()
    return response


def _stay(here: str, location: str) -> None:
    """Raises a RequestError if a redirect leads to another server; the same server over https is allowed."""
    try:
        there = urljoin(here, location)
        (scheme, host, port), target = origin_of(here), origin_of(there)
    except ValueError:
        raise RequestError(f"{_host(here)} redirects to an invalid address") from None
    secured = ("https", host, 443)
    if target != (scheme, host, port) and not (scheme == "http" and port == 80 and target == secured):
        raise RequestError(
            f"{_host(here)} redirects to {plain(_host(there), 60)}, which is sent neither the "
            "question nor the key; if that is the right server, name it with --base-url"
        )


def _host(url: str) -> str:
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}"
