"""Sends requests through the library ``openai``, which repeats those that failed, and turns its errors into
plain sentences.

RoadGPT parses the answer itself, because servers that claim to be compatible omit fields and add others. The
API key is removed from everything that a server returns."""

import json
import logging
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from roadgpt.chat.answer import NotReadableError, RequestError, plain
from roadgpt.chat.config import (
    DEFAULT,
    NO_KEY,
    Key,
    configured,
    key_for,
    redacted,
    settings_with_origin,
    untrusted_source,
)
from roadgpt.chat.meter import has_openai_prices
from roadgpt.chat.model import ChatSettings, address_of
from roadgpt.errors import ChatError, to_install

PAGE = ("<!doctype", "<html")  # how a web page begins, in lower case
CONNECT = 10.0  # s, to connect
TALKATIVE = ("openai", "httpx2", "httpcore2")  # their debug logs may show keys
BYTES_PER_TOKEN = 24  # generous: JSON that escapes every character
ROOM = 200_000  # bytes, for everything around a reply
PATIENCE = 5.0  # s
SPENT_UP = ("insufficient_quota", "billing", "credit")  # words in a 429 for which waiting does not help


class ApiClient:
    """Sends requests to one server, with one API key."""

    def __init__(self, settings: ChatSettings, key: Key | None) -> None:
        self.place, self.settings = address_of(settings.base_url), settings
        if key is None and has_openai_prices(self.place):
            raise ChatError(
                f"there is no key for {self.place}; put one into the environment as OPENAI_API_KEY or into "
                "a file .env, or name another server with --base-url"
            )
        self._key = key or NO_KEY
        try:
            import openai

            from roadgpt.chat.response_limits import limited_client
        except ImportError:
            raise ChatError(
                f"language models need the package 'openai'; install it with: {to_install('chat')}"
            ) from None
        for name in TALKATIVE:
            logging.getLogger(name).setLevel(logging.WARNING)
        limit = settings.timeout
        try:
            self._client = openai.OpenAI(
                api_key=self._key.value,
                base_url=self.place,
                timeout=openai.Timeout(limit, connect=min(CONNECT, limit)),
                max_retries=settings.retries,
                default_headers={"Accept-Encoding": "identity"},
                http_client=limited_client(ROOM + BYTES_PER_TOKEN * settings.max_completion, limit),
            )
        except Exception as error:
            why = plain(self.redacted(str(error)), 200)
            raise ChatError(f"a connection to {self.place} cannot be made: {why}") from None

    def send(self, body: dict[str, Any]) -> dict[str, Any]:
        """Sends a request for a chat completion and returns the response. Raises RequestError if no attempt
        succeeds, and NotReadableError if the response is too large."""
        return self._sent(self._client.chat.completions.with_raw_response.create, body)

    def models(self) -> list[dict[str, Any]]:
        """Returns the models of the server, each as the dictionary that the server sends."""
        found = self._sent(self._client.models.with_raw_response.list, {}).get("data")
        return [one for one in found if isinstance(one, dict)] if isinstance(found, list) else []

    def _sent(self, call: Callable[..., Any], body: dict[str, Any]) -> dict[str, Any]:
        import openai

        try:
            content: bytes = call(**body).content
        except (RequestError, NotReadableError):
            raise
        except openai.APIStatusError as error:
            wait = error.response.headers.get("retry-after", "")
            asked = f"; it asks to wait {wait[:9]} s, so try again later" if wait.isdecimal() else ""
            raise self._refusal(error.status_code, error.body, f"{_tries(error)}{asked}") from None
        except openai.APITimeoutError as error:
            told = f"gave no complete answer within {self.settings.timeout:g} s{_tries(error)}"
            raise RequestError(f"{self.place} {told}") from None
        except Exception as error:
            cause = error.__cause__ or error
            why = plain(self.redacted(str(cause)), 100) or type(cause).__name__
            told = f"cannot be reached ({why}); is the server running?{_tries(error)}"
            raise RequestError(f"{self.place} {told}") from None
        try:
            found = json.loads(content)
        except (ValueError, RecursionError):
            found = None
        if not isinstance(found, dict):
            start = plain(self.redacted(content[:400].decode("utf-8", "replace")), 60)
            raise RequestError(
                f"{self.place} did not answer with JSON ('{start}'); does the base URL end in /v1?"
            )
        if (fault := found.get("error")) and not found.get("choices"):  # an error in spite of its status
            code = fault.get("code") if isinstance(fault, dict) else None
            raise self._refusal(code if isinstance(code, int) else 500, fault, "")
        answer: dict[str, Any] = self.redacted(found)
        return answer

    def redacted(self, value: Any) -> Any:
        """Returns a copy of a text, list or dictionary from which the API key has been removed."""
        return redacted(value, self._key)

    def _refusal(self, status: int, body: Any, more: str) -> RequestError:
        """Returns the error for a status and the body that explains it; ``more`` ends the sentence if the
        server may work later."""
        body = self.redacted(body)
        told = body if isinstance(body, dict) else {"message": body}
        message = str(told.get("message") or (json.dumps(body) if isinstance(body, dict) else ""))
        if message.lstrip().lower().startswith(PAGE):
            message = "it answered with a web page, so it is not a language model server"
        said = f"{message} {told.get('code') or ''} {told.get('type') or ''}".lower()
        is_spent_up = status == 429 and any(word in said for word in SPENT_UP)
        sentence = self._sentence(status, plain(message, 200), is_spent_up)
        if (status == 429 or status >= 500) and not is_spent_up:
            sentence += more
        return RequestError(sentence, status, said, str(told.get("param") or ""))

    def _sentence(self, status: int, message: str, is_spent_up: bool) -> str:
        told, key = f": {message}" if message else "", f"the key from {self._key.origin}"
        says = {
            401: f"rejects {key}{told}",
            403: f"does not allow this with {key}{told}",
            404: f"does not know this model or address{told}; see --model and --base-url",
            429: f"is overloaded{told}",
        }.get(status, f"{'failed' if status >= 500 else 'rejects the question'} with status {status}{told}")
        if is_spent_up:
            return f"the account at {self.place} has no credit left{told}"
        if status == 401 and self._key is NO_KEY:
            says = f"wants a key, and none is set; put one into OPENAI_API_KEY{told}"
            if file := untrusted_source(self.settings.base_url):
                says = (
                    f"wants a key but is sent none, because only {file} names it; if you trust it, set in "
                    f"your environment: OPENAI_BASE_URL={self.place}{told}"
                )
        return f"{self.place} {says}"


def _tries(error: Any) -> str:
    """Returns how often the library sent a request, as an addition to a sentence; empty if only once."""
    request = getattr(error, "request", None)
    retries = int(request.headers.get("x-stainless-retry-count", 0)) if request else 0
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
