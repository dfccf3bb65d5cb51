"""Asks for JSON and reads it: the schema that a server gets, the answer in what it sends back, and the JSON
in the text that the model wrote.

The schema has only the keywords that all servers accept: every field is required, no other fields are
allowed, and lengths, limits and defaults are left out; patterns of texts are for servers that take them. The
limits still hold, because every reply is validated against the pydantic model. Any field of a server's
response may be missing or have the wrong type. Text around the JSON of the model is ignored: code fences,
text before and after, and a model's reasoning. NaN and infinities, keys that occur twice with different
values, extreme nesting and extreme length are rejected. Nothing is evaluated."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from roadgpt.chat.model import Usage

MOST_CHARACTERS = 1_000_000
MOST_TRIES = 20  # places tried as the beginning of an object
THOUGHTS_END = ("</think>", "</thinking>")
Schema = TypeVar("Schema", bound=BaseModel)


class NotReadableError(ValueError):
    """Raised if a model's text is not in the requested form; the message gives the reason in a few words."""


def plain(text: str, most: int = 80) -> str:
    """Returns text from a model or a server as one line of printable characters, at most ``most`` of them."""
    shown = "".join(letter if letter.isprintable() else " " for letter in text[: 4 * most])
    shown = " ".join(shown.split())
    return shown if len(shown) <= most else f"{shown[:most].rstrip()} ..."


def read_as(schema: type[Schema], text: str) -> Schema:
    """Returns the first JSON object in a text as an instance of the schema; raises NotReadableError if there
    is none, or it does not fit the schema."""
    try:
        return schema.model_validate(read_object(text))
    except ValidationError as error:
        problem = error.errors(include_url=False, include_input=False, include_context=False)[0]
    place = plain(".".join(str(part) for part in problem["loc"])) or "the whole"
    raise NotReadableError(f"{place}: {plain(problem['msg'], 120)}")


def read_object(text: str) -> dict[str, Any]:
    """Returns the first JSON object in a text; raises NotReadableError if the text is blank, too long, or has
    no readable object."""
    if not text.strip():
        raise NotReadableError("it is blank")
    if len(text) > MOST_CHARACTERS:
        raise NotReadableError(f"it has more than {MOST_CHARACTERS:,} characters")
    for end_mark in THOUGHTS_END:
        text = text.rpartition(end_mark)[2]
    decoder = json.JSONDecoder(object_pairs_hook=_object, parse_constant=_number, parse_float=_number)
    why, at = "it holds no JSON object", text.find("{")
    for number in range(MOST_TRIES):
        if at < 0:
            break
        try:
            found: dict[str, Any] = decoder.raw_decode(text, at)[0]
        except json.JSONDecodeError as error:
            why = f"it is not JSON ({error.msg} at character {error.pos:,})" if number == 0 else why
        except NotReadableError:
            raise
        except RecursionError:
            raise NotReadableError("it has too many brackets inside brackets") from None
        except ValueError:
            raise NotReadableError("it holds a number of thousands of digits") from None
        else:
            return found
        at = text.find("{", at + 1)
    raise NotReadableError(why)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found and found[key] != value:
            raise NotReadableError(f"it has '{plain(key, 40)}' twice, with different values")
        found[key] = value
    return found


def _number(text: str) -> float:
    found = float(text)
    if not math.isfinite(found):
        raise NotReadableError(f"it holds {plain(text, 20)}, which is not a number")
    return found


KEYWORDS = ("type", "enum", "description", "pattern")
NESTED = 10  # levels of a schema; OpenAI allows 5 levels of objects


def fixed_description(text: str) -> ConfigDict:
    """Returns a pydantic configuration that makes ``text``, not the docstring, the description in a model's
    schema.

    A recorded answer is found by a hash of the question, and the question includes the schema. So the
    docstring of a model can be edited, but the description in its schema must stay the same."""
    return ConfigDict(json_schema_extra={"description": text})


def schema_of(model: type[BaseModel], patterns: bool = False) -> dict[str, Any]:
    """Returns the flat JSON schema of a model, with or without the patterns of its texts. Raises TypeError if
    the model refers to itself or has objects without named fields (a bug in the caller)."""
    whole = model.model_json_schema()
    return _flat(whole, whole.get("$defs", {}), NESTED, KEYWORDS if patterns else KEYWORDS[:-1])


def _flat(schema: dict[str, Any], named: dict[str, Any], levels: int, kept: Sequence[str]) -> dict[str, Any]:
    if "$ref" in schema:
        schema = named[schema["$ref"].rsplit("/", 1)[1]] | schema
    fields = schema.get("properties", {})
    if not levels or (schema.get("type") == "object" and not fields):
        raise TypeError("a language model needs named fields in every object, and no object in itself")
    flat: dict[str, Any] = {key: schema[key] for key in kept if key in schema}
    if "const" in schema:
        flat["enum"] = [schema["const"]]
    if "anyOf" in schema:
        flat["anyOf"] = [_flat(one, named, levels - 1, kept) for one in schema["anyOf"]]
    if fields:
        flat["properties"] = {name: _flat(field, named, levels - 1, kept) for name, field in fields.items()}
        flat |= {"required": list(fields), "additionalProperties": False}
    if "items" in schema:
        flat["items"] = _flat(schema["items"], named, levels - 1, kept)
    return flat


NOTHING = Usage()
MOST_TOKENS = 100_000_000  # of one exchange; a larger number is not taken for a count


@dataclass
class RequestError(Exception):
    """Raised if a request to a server fails."""

    sentence: str
    status: int | None = None
    details: str = ""  # the server's own error message in lower case
    parameter: str = ""


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
    choices, usage = body.get("choices"), _fields(body.get("usage"))
    choice = _fields(choices[0]) if isinstance(choices, list) and choices else {}
    message = _fields(choice.get("message"))
    finish = _word(choice.get("finish_reason")) or "stop"
    refusal, content = message.get("refusal"), message.get("content")
    refusal = refusal if isinstance(refusal, str) and refusal.strip() else None
    if finish == "content_filter" and refusal is None:
        refusal = "the server's filter stopped the answer"
    parts = content if isinstance(content, list) else [{"text": content}]
    texts = [_fields(part).get("text") for part in parts]
    text = "".join(text for text in texts if isinstance(text, str))
    counted = Usage(
        prompt=_count(usage.get("prompt_tokens")), completion=_count(usage.get("completion_tokens"))
    )
    return Answer(text, _word(body.get("model")), finish, counted, refusal)


def _fields(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def _word(value: Any) -> str:
    return plain(value, 100) if isinstance(value, str) else ""


def _count(value: Any) -> int:
    is_count = isinstance(value, (int, float)) and not isinstance(value, bool) and 0 <= value <= MOST_TOKENS
    return int(value) if is_count else 0
