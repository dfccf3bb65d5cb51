"""An HTTP client for the library ``openai`` that takes no more of a response than a limit of size and time.

It follows no redirects, so that neither the question nor the key goes to another server, and takes no
compressed answers, of which a megabyte may unpack to a gigabyte."""

import time
from collections.abc import Iterator
from typing import Any

import httpx2
from openai import DefaultHttpxClient

from roadgpt.chat.answer import NotReadableError, RequestError, plain

OF_AN_ERROR = 100_000  # bytes; the message of an error is at its beginning


def limited_client(most: int, seconds: float) -> DefaultHttpxClient:
    """Returns a client for responses of at most ``most`` bytes; each must be complete after ``seconds``."""

    def limit(response: Any) -> None:
        host = f"{response.request.url.scheme}://{response.request.url.netloc.decode()}"
        if response.has_redirect_location:
            there = plain(response.headers["location"], 60)
            raise RequestError(
                f"{host} redirects to {there}, which is sent neither the question nor the key; if that is "
                "the right server, name it with --base-url"
            )
        packing = response.headers.get("content-encoding", "identity").strip().lower()
        if packing not in ("", "identity"):
            raise RequestError(
                f"{host} compresses its answer as '{plain(packing, 20)}', which was not requested"
            )
        response.stream = _Within(response, most, time.monotonic() + seconds)

    return DefaultHttpxClient(event_hooks={"response": [limit]}, follow_redirects=False)


class _Within(httpx2.SyncByteStream):
    """The bytes of a response up to the limit; for an error response, only those at the beginning."""

    def __init__(self, response: Any, most: int, deadline: float) -> None:
        self.stream, self.most, self.deadline = response.stream, most, deadline
        self.is_error = response.status_code >= 400

    def __iter__(self) -> Iterator[bytes]:
        """Yields the pieces of the response."""
        left = OF_AN_ERROR if self.is_error else self.most
        for part in self.stream:
            if time.monotonic() > self.deadline:
                raise httpx2.ReadTimeout("no complete response")
            if len(part) > left and not self.is_error:
                raise NotReadableError(
                    f"it has more than {self.most:,} bytes, which is far more than was asked for"
                )
            yield part[:left]
            left -= len(part)
            if left <= 0:
                return

    def close(self) -> None:
        """Closes the connection."""
        self.stream.close()
