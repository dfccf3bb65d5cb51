"""Sends requests through the library ``openai``, with time limits, retries, and plain sentences as errors.

The answer is read as bytes under limits of time and size, and parsed by RoadGPT's own rules, because servers
that claim to be compatible omit fields and add others. The API key is removed from everything that a server
returns.
"""

import contextvars
import json
import logging
import threading
import time
from collections.abc import Callable
from typing import Any

from roadgpt.chat.address import address_of
from roadgpt.chat.config import untrusted_source
from roadgpt.chat.model import ChatSettings
from roadgpt.chat.prices import has_openai_prices
from roadgpt.chat.request_error import BUSY, SPENT_UP, RequestError, retry_after, retry_delay
from roadgpt.chat.secret import NO_KEY, Key, redacted
from roadgpt.chat.strict_json import NotReadableError, plain
from roadgpt.errors import ChatError

PAGE = ("<!doctype", "<html")  # how a web page begins, in lower case
CONNECT = 10.0  # s, to connect
TALKATIVE = ("openai", "httpx2", "httpcore2")  # their debug logs may show keys
GRACE = 0.2  # s after the time limit, in which the request itself may report the problem
BYTES_PER_TOKEN = 24  # generous: JSON that escapes every character
ROOM = 200_000  # bytes, for everything around a reply

sleep = time.sleep


class ApiClient:
    """Sends requests to one server, with one API key."""

    def __init__(self, settings: ChatSettings, key: Key | None) -> None:
        self.place = address_of(settings.base_url)
        self.settings = settings
        if key is None and has_openai_prices(self.place):
            raise ChatError(
                f"there is no key for {self.place}; put one into the environment as OPENAI_API_KEY or into "
                "a file .env, or name another server with --base-url"
            )
        self._key = key or NO_KEY
        self._client = self._opened()

    def _opened(self) -> Any:
        try:
            import openai
        except ImportError:
            raise ChatError(
                "language models need the package 'openai'; install it with:"
                " python -m pip install 'roadgpt[chat]'"
            ) from None
        for name in TALKATIVE:
            logging.getLogger(name).setLevel(logging.WARNING)
        from roadgpt.chat.response_limits import ASK_FOR, ResponseLimits

        limit = self.settings.timeout
        most = ROOM + BYTES_PER_TOKEN * self.settings.max_completion
        try:
            return openai.OpenAI(
                api_key=self._key.value,
                base_url=self.place,
                timeout=openai.Timeout(limit, connect=min(CONNECT, limit)),
                max_retries=0,
                default_headers={"Accept-Encoding": ASK_FOR},
                http_client=openai.DefaultHttpxClient(
                    event_hooks={"response": [ResponseLimits(most, limit, self._late)]}
                ),
            )
        except Exception as error:
            why = plain(redacted(str(error), self._key), 200)
            raise ChatError(f"a connection to {self.place} cannot be made: {why}") from None

    def chat(self, body: dict[str, Any]) -> dict[str, Any]:
        """Sends a request to the Chat Completions API and returns the response."""
        return self._with_patience(self._client.chat.completions.with_streaming_response.create, body)

    def respond(self, body: dict[str, Any]) -> dict[str, Any]:
        """Sends a request to the Responses API and returns the response."""
        return self._with_patience(self._client.responses.with_streaming_response.create, body)

    def begin_conversation(self) -> dict[str, Any]:
        """Starts a conversation that the server stores, and returns the server's description of it."""
        return self._with_patience(self._client.conversations.with_streaming_response.create, {})

    def models(self) -> list[dict[str, Any]]:
        """Returns the models of the server, each as the dictionary that the server sends."""
        found = self._with_patience(self._client.models.with_streaming_response.list, {}).get("data")
        return [one for one in found if isinstance(one, dict)] if isinstance(found, list) else []

    def _with_patience(self, call: Callable[..., Any], body: dict[str, Any]) -> dict[str, Any]:
        """Repeats a request with growing delays, as long as that may help.

        Raises:
            RequestError: it failed for good.
        """
        for attempt in range(self.settings.retries + 1):
            try:
                return self._once(call, body)
            except RequestError as fault:
                wait = retry_delay(fault, attempt)
                if not fault.is_retryable or wait is None:
                    raise
                if attempt == self.settings.retries:
                    tries = f" (tried {attempt + 1} times)" if attempt else ""
                    fault.sentence += tries
                    raise
                sleep(wait)
        raise AssertionError("unreachable")

    def _once(self, call: Callable[..., Any], body: dict[str, Any]) -> dict[str, Any]:
        """Sends one request, and gives up after the time limit even if bytes still trickle in."""
        box: list[Any] = []
        context = contextvars.copy_context()

        def work() -> None:
            try:
                box.append(_bytes(call, body))
            except BaseException as error:  # passed to the waiting thread
                box.append(error)

        thread = threading.Thread(target=context.run, args=(work,), daemon=True)
        thread.start()
        thread.join(self.settings.timeout + GRACE)
        if not box:
            raise self._late()
        if isinstance(box[0], BaseException):
            raise self._fault_of(box[0]) from None
        return self._decoded(box[0])

    def _late(self) -> RequestError:
        return RequestError(
            f"{self.place} gave no complete answer within {self.settings.timeout:g} s", is_retryable=True
        )

    def _decoded(self, content: bytes) -> dict[str, Any]:
        try:
            found = json.loads(content)
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict):
            start = plain(redacted(content[:400].decode("utf-8", "replace"), self._key), 60)
            raise RequestError(
                f"{self.place} did not answer with JSON ('{start}'); does the base URL end in /v1?"
            )
        answer: dict[str, Any] = redacted(found, self._key)
        error = answer.get("error")
        if error and not answer.get("choices") and not answer.get("output"):  # an error under status 200
            told = error if isinstance(error, dict) else {"message": error}
            code = told.get("code")
            raise self._fault(code if isinstance(code, int) and 400 <= code < 600 else 500, told, None)
        return answer

    def redacted(self, value: Any) -> Any:
        """Returns a copy of a text, list or dictionary from which the API key has been removed."""
        return redacted(value, self._key)

    def _fault_of(self, error: BaseException) -> BaseException:
        """Returns an error of the library as a sentence without the key."""
        import openai

        if isinstance(error, (RequestError, NotReadableError, KeyboardInterrupt, SystemExit)):
            return error
        if isinstance(error, openai.APIStatusError):
            return self._refusal(error)
        if isinstance(error, openai.APITimeoutError) or "Timeout" in type(error).__name__:
            return self._late()
        cause = error.__cause__ or error
        if isinstance(
            cause, RequestError
        ):  # raised in our hook, which the library reports as a broken connection
            return cause
        why = plain(redacted(str(cause), self._key), 100) or type(cause).__name__
        if isinstance(error, openai.APIConnectionError):
            return RequestError(
                f"{self.place} cannot be reached ({why}); is the server running?", is_retryable=True
            )
        if type(error).__module__.partition(".")[0] in ("httpx2", "httpcore2", "h11", "ssl", "builtins"):
            return RequestError(
                f"{self.place} broke off its answer ({why})", is_retryable=isinstance(error, Exception)
            )
        return RequestError(f"the request to {self.place} failed ({type(error).__name__}: {why})")

    def _refusal(self, error: Any) -> RequestError:
        status, body = error.status_code, redacted(error.body, self._key)
        inner = body.get("error", body) if isinstance(body, dict) else body
        told = inner if isinstance(inner, dict) else {"message": inner}
        message = str(told.get("message") or "")
        if not message and isinstance(body, dict):
            message = json.dumps(body)
        message = message or plain(redacted(str(error.message), self._key))
        return self._fault(status, {**told, "message": message}, retry_after(error.response.headers))

    def _fault(self, status: int, told: dict[str, Any], wait: float | None) -> RequestError:
        """Returns a server's error message as an error with a sentence."""
        message = str(told.get("message") or "")
        if message.lstrip().lower().startswith(PAGE):
            message = "it answered with a web page, so it is not a language model server"
        said = f"{message} {told.get('code') or ''} {told.get('type') or ''}".lower()
        used_up = status == 429 and any(word in said for word in SPENT_UP)
        return RequestError(
            self._sentence(status, plain(message, 200), used_up),
            status,
            said,
            str(told.get("param") or ""),
            wait,
            is_retryable=status in BUSY and not used_up,
        )

    def _sentence(self, status: int, message: str, used_up: bool) -> str:
        told = f": {message}" if message else ""
        if status == 401 and self._key is NO_KEY:
            if file := untrusted_source(self.settings.base_url):
                return (
                    f"{self.place} wants a key but is sent none, because only {file} names it; if you "
                    f"trust it, set in your environment: OPENAI_BASE_URL={self.place}{told}"
                )
            return f"{self.place} wants a key, and none is set; put one into OPENAI_API_KEY{told}"
        if status == 401:
            return f"{self.place} rejects the key from {self._key.origin}{told}"
        if status == 403:
            return f"{self.place} does not allow this with the key from {self._key.origin}{told}"
        if status == 404:
            return f"{self.place} does not know this model or address{told}; see --model and --base-url"
        if used_up:
            return f"the account at {self.place} has no credit left{told}"
        if status == 429:
            return f"{self.place} is overloaded{told}"
        if status >= 500:
            return f"{self.place} failed with status {status}{told}"
        return f"{self.place} rejects the question with status {status}{told}"


def _bytes(call: Callable[..., Any], body: dict[str, Any]) -> bytes:
    """Returns the whole answer; the client's hook keeps it within limits."""
    with call(**body) as response:
        return b"".join(response.iter_bytes())
