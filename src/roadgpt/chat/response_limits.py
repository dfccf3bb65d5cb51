"""Replies under a limit of size and time, whatever their status; and redirects that stay with their server.

A server may answer with a gigabyte, also where it says that something went wrong, and a megabyte that is
packed may hold a gigabyte. So every reply is unpacked here, piece by piece, and no further than the limit.
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
GZIP = 31  # zlib's word for gzip with the largest window
OF_AN_ERROR = 100_000  # bytes; what is said of an error stands at its beginning
FIRST_ERROR = 400


class ResponseLimits:
    """Looks at every response before it is read."""

    def __init__(self, most: int, seconds: float, late: Callable[[], Exception]) -> None:
        self.most, self.seconds, self.late = most, seconds, late

    def __call__(self, response: Any) -> None:
        """Give a response its limits.

        Raises:
            FaultError: it leads to another server, or is packed in a way that was not asked for.
        """
        if "location" in response.headers and 300 <= response.status_code < FIRST_ERROR:
            _stay(str(response.request.url), response.headers["location"])
        packing = response.headers.get("content-encoding", "identity").strip().lower()
        if packing not in PACKED | {"identity", ""}:
            raise RequestError(
                f"{_host(str(response.request.url))} packs its answer as '{plain(packing, 20)}', "
                "which was not asked for"
            )
        if "content-encoding" in response.headers:
            del response.headers["content-encoding"]
        response.stream = _Within(response.stream, self, packing in PACKED, response.status_code)


class _Within(SyncByteStream):
    """The bytes of a response, unpacked and up to a limit."""

    def __init__(self, stream: Any, bound: ResponseLimits, is_packed: bool, status: int) -> None:
        self.stream, self.bound = stream, bound
        self.unpacker = zlib.decompressobj(GZIP) if is_packed else None
        self.is_error = status >= FIRST_ERROR
        self.most = min(OF_AN_ERROR, bound.most) if self.is_error else bound.most
        self.deadline = time.monotonic() + bound.seconds

    def __iter__(self) -> Iterator[bytes]:
        """Pieces; of an error no more than its beginning.

        Raises:
            NotReadableError: it is longer than the limit.
            FaultError: it takes longer.
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
                raise NotReadableError(f"it has more than {self.most:,} bytes, and a short one was asked for")
            left -= len(piece)
            yield piece

    def _unpacked(self, part: bytes, most: int) -> bytes:
        if self.unpacker is None:
            return part
        try:
            return self.unpacker.decompress(part, most)
        except zlib.error as error:
            raise RequestError(f"the answer is packed, and cannot be unpacked ({error})") from None

    def close(self) -> None:
        """Let go of the connection."""
        self.stream.close()


def _stay(here: str, location: str) -> None:
    """FaultError where a redirect leads away from its server; the same over https is the same."""
    try:
        there = urljoin(here, location)
        (scheme, host, port), target = origin_of(here), origin_of(there)
    except ValueError:
        raise RequestError(f"{_host(here)} sends the question on to no address") from None
    secured = ("https", host, 443)
    if target != (scheme, host, port) and not (scheme == "http" and port == 80 and target == secured):
        raise RequestError(
            f"{_host(here)} sends the question on to {plain(_host(there), 60)}, which gets neither the "
            "question nor the key; if that is the right server, name it with --base-url"
        )


def _host(url: str) -> str:
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}"
