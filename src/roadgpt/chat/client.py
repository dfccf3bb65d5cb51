"""One request and its answer, through the library ``openai``: time limits, retries, and errors as sentences.

The answer is read as bytes under a limit of time and size, and as JSON under our own rules, because servers
that call themselves compatible leave out and add what they like. Whatever comes back is rid of the key
first.
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

PAGE = ("<!doctype", "<html")  # how a web page begins, in small letters
CONNECT = 10.0  # s, to reach it
TALKATIVE = ("openai", "httpx2", "httpcore2")  # debug logs of theirs show headers, and what servers echo
GRACE = 0.2  # s behind the time limit, in which the request itself may say what is wrong
BYTES_PER_TOKEN = 24  # generous: JSON that escapes every letter
ROOM = 200_000  # bytes, for all around a reply

sleep = time.sleep


class ApiClient:
    """To one server, with one key."""

    def __init__(self, settings: ChatSettings, key: Key | None) -> None:
        self.place = address_of(settings.base_url)
        self.settings = settings
        if key is None and has_openai_prices(self.place):
            raise ChatError(
                f"no key for {self.place}; put it into the environment as OPENAI_API_KEY or into a file "
                ".env, or name another server with --base-url"
            )
        self._key = key or NO_KEY
        self._client = self._opened()

    def _opened(self) -> Any:
        try:
            import openai
        except ImportError:
            raise ChatError(
                "language models need the package 'openai'; say python -m pip install 'roadgpt[chat]'"
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
        """The answer of Chat Completions."""
        return self._with_patience(self._client.chat.completions.with_streaming_response.create, body)

    def respond(self, body: dict[str, Any]) -> dict[str, Any]:
        """The answer of Responses."""
        return self._with_patience(self._client.responses.with_streaming_response.create, body)

    def begin_conversation(self) -> dict[str, Any]:
        """A conversation that the server keeps."""
        return self._with_patience(self._client.conversations.with_streaming_response.create, {})

    def models(self) -> list[dict[str, Any]]:
        """The models that the server has, as it describes them."""
        found = self._with_patience(self._client.models.with_streaming_response.list, {}).get("data")
        return [one for one in found if isinstance(one, dict)] if isinstance(found, list) else []

    def _with_patience(self, call: Callable[..., Any], body: dict[str, Any]) -> dict[str, Any]:
        """Ask again, later and later, as long as that may help.

        Raises:
            FaultError: it does not.
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
        """One request, given up after the time limit even where bytes drip in."""
        box: list[Any] = []
        context = contextvars.copy_context()

        def work() -> None:
            try:
                box.append(_bytes(call, body))
            except BaseException as error:  # handed to the thread that waits
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
            f"{self.place} gave no whole answer within {self.settings.timeout:g} s", is_retryable=True
        )

    def _decoded(self, content: bytes) -> dict[str, Any]:
        try:
            found = json.loads(content)
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict):
            start = plain(redacted(content[:400].decode("utf-8", "replace"), self._key), 60)
            raise RequestError(
                f"{self.place} answers with something else than JSON ('{start}'); "
                "does the base URL end in /v1?"
            )
        answer: dict[str, Any] = redacted(found, self._key)
        error = answer.get("error")
        if error and not answer.get("choices") and not answer.get("output"):  # an error under status 200
            told = error if isinstance(error, dict) else {"message": error}
            code = told.get("code")
            raise self._fault(code if isinstance(code, int) and 400 <= code < 600 else 500, told, None)
        return answer

    def redacted(self, value: Any) -> Any:
        """Without the key, wherever it stands."""
        return redacted(value, self._key)

    def _fault_of(self, error: BaseException) -> BaseException:
        """What an error of the library means, in a sentence without the key."""
        import openai

        if isinstance(error, (RequestError, NotReadableError, KeyboardInterrupt, SystemExit)):
            return error
        if isinstance(error, openai.APIStatusError):
            return self._refusal(error)
        if isinstance(error, openai.APITimeoutError) or "Timeout" in type(error).__name__:
            return self._late()
        cause = error.__cause__ or error
        if isinstance(cause, RequestError):  # of a hook, which the library takes for a broken connection
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
        """What a server says about an error, in a sentence."""
        message = str(told.get("message") or "")
        if message.lstrip().lower().startswith(PAGE):
            message = "it answers with a web page, as no server of language models does"
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
                    f"{self.place} wants a key and gets none, because {file} names it and you do not; if you "
                    f"trust it, say so in your environment: OPENAI_BASE_URL={self.place}{told}"
                )
            return f"{self.place} wants a key, and none is set; put one into OPENAI_API_KEY{told}"
        if status == 401:
            return f"{self.place} does not take the key from {self._key.origin}{told}"
        if status == 403:
            return f"{self.place} does not allow this with the key from {self._key.origin}{told}"
        if status == 404:
            return f"{self.place} knows no such model or address{told}; see --model and --base-url"
        if used_up:
            return f"the account at {self.place} has nothing left to spend{told}"
        if status == 429:
            return f"{self.place} has too much to do{told}"
        if status >= 500:
            return f"{self.place} failed with status {status}{told}"
        return f"{self.place} refuses the question with status {status}{told}"


def _bytes(call: Callable[..., Any], body: dict[str, Any]) -> bytes:
    """The whole answer; its client keeps it within limits."""
    with call(**body) as response:
        return b"".join(response.iter_bytes())
