"""Sends requests through the library ``openai``, and turns its errors into plain sentences.

The library repeats requests that failed. RoadGPT reads the answer as bytes, with limits of time and size.
RoadGPT also parses the answer itself, because servers that claim to be compatible omit fields and add others.
The API key is removed from everything that a server returns."""

import json
import logging
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from roadgpt.chat.answer import BUSY, NotReadableError, RequestError, is_spent_up, plain
from roadgpt.chat.config import DEFAULT, configured, key_for, settings_with_origin, untrusted_source
from roadgpt.chat.meter import has_openai_prices
from roadgpt.chat.model import ChatSettings, address_of
from roadgpt.chat.secret import NO_KEY, Key, redacted
from roadgpt.errors import ChatError, to_install

PAGE = ("<!doctype", "<html")  # how a web page begins, in lower case
CONNECT = 10.0  # s, to connect
TALKATIVE = ("openai", "httpx2", "httpcore2")  # their debug logs may show keys
BYTES_PER_TOKEN = 24  # generous: JSON that escapes every character
ROOM = 200_000  # bytes, for everything around a reply
PATIENCE = 5.0  # s


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
                f"language models need the package 'openai'; install it with: {to_install('chat')}"
            ) from None
        for name in TALKATIVE:
            logging.getLogger(name).setLevel(logging.WARNING)
        from roadgpt.chat.response_limits import ASK_FOR, LimitedClient

        limit = self.settings.timeout
        most = ROOM + BYTES_PER_TOKEN * self.settings.max_completion
        try:
            return openai.OpenAI(
                api_key=self._key.value,
                base_url=self.place,
                timeout=openai.Timeout(limit, connect=min(CONNECT, limit)),
                max_retries=self.settings.retries,
                default_headers={"Accept-Encoding": ASK_FOR},
                http_client=LimitedClient(most, limit),
            )
        except Exception as error:
            why = plain(redacted(str(error), self._key), 200)
            raise ChatError(f"a connection to {self.place} cannot be made: {why}") from None

    def send(self, body: dict[str, Any]) -> dict[str, Any]:
        """Sends a request for a chat completion and returns the response. The library repeats a failed
        request if this may help. Raises RequestError if no attempt succeeds, and NotReadableError if the
        response is too large."""
        return self._sent(self._client.chat.completions.with_raw_response.create, body)

    def models(self) -> list[dict[str, Any]]:
        """Returns the models of the server, each as the dictionary that the server sends."""
        found = self._sent(self._client.models.with_raw_response.list, {}).get("data")
        return [one for one in found if isinstance(one, dict)] if isinstance(found, list) else []

    def _sent(self, call: Callable[..., Any], body: dict[str, Any]) -> dict[str, Any]:
        try:
            content: bytes = call(**body).content
        except Exception as error:
            raise self._fault_of(error) from None
        try:
            found = json.loads(content)
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict):
            start = plain(self.redacted(content[:400].decode("utf-8", "replace")), 60)
            raise RequestError(
                f"{self.place} did not answer with JSON ('{start}'); does the base URL end in /v1?"
            )
        answer: dict[str, Any] = self.redacted(found)
        return answer

    def redacted(self, value: Any) -> Any:
        """Returns a copy of a text, list or dictionary from which the API key has been removed."""
        return redacted(value, self._key)

    def _fault_of(self, error: Exception) -> Exception:
        import openai

        from roadgpt.chat.response_limits import BrokenOffError

        if isinstance(error, (RequestError, NotReadableError)):
            return error
        if isinstance(error, openai.APIStatusError):
            return self._refusal(error)
        cause = error.__cause__ or error
        why = plain(redacted(str(cause), self._key), 100) or type(cause).__name__
        if isinstance(error, openai.APITimeoutError):
            said = f"gave no complete answer within {self.settings.timeout:g} s"
        elif isinstance(cause, BrokenOffError):
            said = f"broke off its answer ({why})"
        elif isinstance(error, openai.APIConnectionError):
            said = f"cannot be reached ({why}); is the server running?"
        else:
            return RequestError(f"the request to {self.place} failed ({type(error).__name__}: {why})")
        return RequestError(f"{self.place} {said}{_tries(error)}")

    def _refusal(self, error: Any) -> RequestError:
        status, body = error.status_code, redacted(error.body, self._key)
        told = body if isinstance(body, dict) else {"message": body}
        message = str(told.get("message") or "")
        if not message and isinstance(body, dict):
            message = json.dumps(body)
        message = message or plain(redacted(str(error.message), self._key))
        if message.lstrip().lower().startswith(PAGE):
            message = "it answered with a web page, so it is not a language model server"
        said = f"{message} {told.get('code') or ''} {told.get('type') or ''}".lower()
        used_up = is_spent_up(status, said)
        sentence = self._sentence(status, plain(message, 200), used_up)
        if status in BUSY and not used_up:
            wait = error.response.headers.get("retry-after", "")
            asked = f"; it asks to wait {wait[:9]} s, so try again later" if wait.isdecimal() else ""
            sentence += _tries(error) + asked
        return RequestError(sentence, status, said, str(told.get("param") or ""))

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


def _tries(error: Any) -> str:
    """Returns how often the library sent a request, as an addition to a sentence; empty if only once."""
    retries = int(error.request.headers.get("x-stainless-retry-count", 0))
    return f" (tried {retries + 1} times)" if retries else ""


def diagnose() -> str:
    """Returns a text that names the model, the server and the library, or says that no model is configured.

    Raises:
        ChatError: a model or a server is configured but cannot be asked.
        UsageError: a setting is not valid."""
    found = settings_with_origin()
    if all(found[name].origin == DEFAULT for name in ("model", "base_url")):
        return "none is configured, and none is needed; see roadgpt config show"
    try:
        library = f"openai {version('openai')}"
    except PackageNotFoundError:
        raise ChatError(f"the package 'openai' is missing; install it with: {to_install('chat')}") from None
    settings = configured().model_copy(update={"timeout": PATIENCE, "retries": 0})
    place, wanted = address_of(settings.base_url), settings.model
    try:
        models = ApiClient(settings, key_for(settings.base_url)).models()
    except RequestError as fault:
        raise ChatError(fault.sentence) from None
    names = [str(one.get("id")) for one in models]
    if wanted and names and wanted not in names:
        shown = ", ".join(plain(name, 40) for name in names[:5])
        raise ChatError(f"{place} has no model '{plain(wanted)}'; it has {shown}")
    ends = next((one.get("shutdown_date") for one in models if one.get("id") == wanted), None)
    told = f"; it will be switched off on {plain(str(ends), 20)}" if ends else ""
    return f"{wanted or 'any'} of {len(names)} at {place}, through {library}{told}"
