"""Extracts the answer from the JSON that a server sends. Any field may be missing or have the wrong type."""

from dataclasses import dataclass
from typing import Any

from roadgpt.chat.model import Usage
from roadgpt.chat.strict_json import plain

NOTHING = Usage()
MOST_TOKENS = 100_000_000  # of one exchange; a larger number is not taken for a count


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
    choice = choices[0] if isinstance(choices, list) and choices and isinstance(choices[0], dict) else {}
    message = choice.get("message")
    message = message if isinstance(message, dict) else {}
    finish = _word(choice.get("finish_reason")) or "stop"
    refusal = message.get("refusal")
    refusal = refusal if isinstance(refusal, str) and refusal.strip() else None
    if finish == "content_filter" and refusal is None:
        refusal = "the server's filter stopped the answer"
    return Answer(
        _text_of(message.get("content")),
        _word(body.get("model")),
        finish,
        _usage(body.get("usage"), "prompt_tokens", "completion_tokens"),
        refusal,
    )


def from_responses(body: dict[str, Any]) -> Answer:
    """Extracts the answer from a response of the Responses API."""
    said: list[str] = []
    refusal: str | None = None
    output = body.get("output")
    for item in output if isinstance(output, list) else []:
        content = item.get("content") if isinstance(item, dict) and item.get("type") == "message" else None
        for part in content if isinstance(content, list) else []:
            if isinstance(part, dict) and part.get("type") == "refusal":
                refusal = str(part.get("refusal") or "no reason given")
        said.append(_text_of(content))
    finish = "stop"
    if body.get("status") == "incomplete":
        details = body.get("incomplete_details")
        reason = _word(details.get("reason")) if isinstance(details, dict) else ""
        finish = "length" if "token" in reason else reason or "length"
    if finish == "content_filter" and refusal is None:
        refusal = "the server's filter stopped the answer"
    usage = _usage(body.get("usage"), "input_tokens", "output_tokens")
    return Answer("".join(said), _word(body.get("model")), finish, usage, refusal)


def _text_of(content: Any) -> str:
    """Returns a text, or the joined texts of a list of parts."""
    if isinstance(content, str):
        return content
    parts = content if isinstance(content, list) else []
    return "".join(
        part["text"] for part in parts if isinstance(part, dict) and isinstance(part.get("text"), str)
    )


def _word(value: Any) -> str:
    return plain(value, 100) if isinstance(value, str) else ""


def _usage(told: Any, prompt: str, completion: str) -> Usage:
    told = told if isinstance(told, dict) else {}
    return Usage(prompt=_count(told.get(prompt)), completion=_count(told.get(completion)))


def _count(value: Any) -> int:
    is_count = isinstance(value, (int, float)) and not isinstance(value, bool) and 0 <= value <= MOST_TOKENS
    return int(value) if is_count else 0
