"""What a server sends back: an error, or JSON from which the answer is extracted. Any field of this JSON may
be missing or have the wrong type.
"""

from dataclasses import dataclass
from typing import Any

from roadgpt.chat.model import Usage
from roadgpt.chat.strict_json import plain

NOTHING = Usage()
MOST_TOKENS = 100_000_000  # of one exchange; a larger number is not taken for a count
BUSY = {408, 409, 425, 429, 500, 502, 503, 504, 529}  # statuses after which a retry may help
SPENT_UP = ("insufficient_quota", "billing", "credit")  # words in a 429 for which waiting does not help


@dataclass
class RequestError(Exception):
    """Raised if a request to a server fails."""

    sentence: str
    status: int | None = None
    details: str = ""
    """The server's own error message in lower case."""
    parameter: str = ""


def is_spent_up(status: int, message: str) -> bool:
    """Returns True if a server's error message says that the account has no credit left."""
    return status == 429 and any(word in message.lower() for word in SPENT_UP)


@dataclass(frozen=True)
class Answer:
    """The answer of a server to one request."""

    text: str = ""
    model: str = ""
    finish: str = "stop"
    usage: Usage = NOTHING
    refusal: str | None = None


def from_chat(body: dict[str, Any]) -> Answer:
    """Extracts the answer from a response of the Chat Completions API."""
    choices = body.get("choices")
    choice = _fields(choices[0]) if isinstance(choices, list) and choices else {}
    message = _fields(choice.get("message"))
    finish = _word(choice.get("finish_reason")) or "stop"
    refusal = message.get("refusal")
    refusal = refusal if isinstance(refusal, str) and refusal.strip() else None
    usage = _usage(body, "prompt_tokens", "completion_tokens")
    return _answer(body, _text_of(message.get("content")), finish, usage, refusal)


def from_responses(body: dict[str, Any]) -> Answer:
    """Extracts the answer from a response of the Responses API."""
    said: list[str] = []
    refusal: str | None = None
    output = body.get("output")
    for item in output if isinstance(output, list) else []:
        content = item.get("content") if _fields(item).get("type") == "message" else None
        for part in content if isinstance(content, list) else []:
            if _fields(part).get("type") == "refusal":
                refusal = str(part.get("refusal") or "no reason given")
        said.append(_text_of(content))
    finish = "stop"
    if body.get("status") == "incomplete":
        reason = _word(_fields(body.get("incomplete_details")).get("reason"))
        finish = "length" if "token" in reason else reason or "length"
    return _answer(body, "".join(said), finish, _usage(body, "input_tokens", "output_tokens"), refusal)


def _answer(body: dict[str, Any], text: str, finish: str, usage: Usage, refusal: str | None) -> Answer:
    if finish == "content_filter" and refusal is None:
        refusal = "the server's filter stopped the answer"
    return Answer(text, _word(body.get("model")), finish, usage, refusal)


def _fields(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def _text_of(content: Any) -> str:
    """Returns a text, or the joined texts of a list of parts."""
    if isinstance(content, str):
        return content
    parts = content if isinstance(content, list) else []
    texts = [_fields(part).get("text") for part in parts]
    return "".join(text for text in texts if isinstance(text, str))


def _word(value: Any) -> str:
    return plain(value, 100) if isinstance(value, str) else ""


def _usage(body: dict[str, Any], prompt: str, completion: str) -> Usage:
    told = _fields(body.get("usage"))
    return Usage(prompt=_count(told.get(prompt)), completion=_count(told.get(completion)))


def _count(value: Any) -> int:
    is_count = isinstance(value, (int, float)) and not isinstance(value, bool) and 0 <= value <= MOST_TOKENS
    return int(value) if is_count else 0
