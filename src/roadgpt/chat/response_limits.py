"""Limits the size and time of every HTTP response, including errors, and refuses redirects to other servers.

A server may answer with a gigabyte even when it reports an error, and a compressed megabyte may contain a
gigabyte. So every response is decompressed piece by piece, and only up to the limit.
"""

import time
import zlib
from collections.abc import Callable, Iterator
from typing import Any
from urllib.parse import urljoin, urlsplit

from httpx2 import SyncByteStream

from roadgpt.chat.address import origin_of
from roadgpt.chat.request_error import RequestError
from roadgpt.chat.strict_json import NotReadableError, plain

PACKED = {"gzip", "x-gzip"}
ASK_FOR = "gzip"
GZIP = 31  # zlib's window bits for gzip with the largest window
OF_AN_ERROR = 100_000  # bytes; the message of an error is at its beginning
FIRST_ERROR = 400


class ResponseLimits:
    """A response hook of the HTTP client: limits the size and time of every response before it is read."""

    def __init__(self, most: int, seconds: float, late: Callable[[], Exception]) -> None:
        self.most, self.seconds, self.late = most, seconds, late

    def __call__(self, response: Any) -> None:
        """Limits a response.

        Raises:
            RequestError: it redirects to another server, or has a content encoding that was not requested.
        """
        if "location" in response.headers and 300 <= response.status_code < FIRST_ERROR:
            _stay(str(response.request.url), response.headers["location"])
        packing = response.headers.get("content-encoding", "identity").strip().lower()
        if packing not in PACKED | {"identity", ""}:
            raise RequestError(
                f"{_host(str(response.request.url))} compresses its answer as '{plain(packing, 20)}', "
                "which was not requested"
            )
        if "content-encoding" in response.headers:
            del response.headers["content-encoding"]
        response.stream = _Within(response.stream, self, packing in PACKED, response.status_code)


class _Within(SyncByteStream):
    """The bytes of a response, decompressed and limited."""

    def __init__(self, stream: Any, bound: ResponseLimits, is_packed: bool, status: int) -> None:
        self.stream, self.bound = stream, bound
        self.unpacker = zlib.decompressobj(GZIP) if is_packed else None
        self.is_error = status >= FIRST_ERROR
        self.most = min(OF_AN_ERROR, bound.most) if self.is_error else bound.most
        self.deadline = time.monotonic() + bound.seconds

    def __iter__(self) -> Iterator[bytes]:
        """Yields pieces; of an error response only its beginning.

        Raises:
            NotReadableError: the response exceeds the limit of size.
            RequestError: it exceeds the limit of time.
        """
        left = self.most
        for part in self.stream:
            if time.monotonic() > self.deadline:
                raise self.bound.late()
            piece = self._unpacked(part, left + 1)
            if len(piece) > left:
                if self.is_error:
                    yield piece[:left]
                    return
                raise NotReadableError(
                    f"it has more than {self.most:,} bytes, which is far more than was asked for"
                )
            left -= len(piece)
            yield piece

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
