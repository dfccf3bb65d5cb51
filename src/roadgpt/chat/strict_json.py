"""Reads JSON from the text that a model wrote. The JSON is read strictly, but any text around it is ignored.

Code fences, text before and after, and a model's reasoning are skipped. NaN and infinities, keys that occur
twice with different values, extreme nesting and extreme length are rejected, with the reason in a few words.
Nothing is evaluated.
"""

import json
import math
import re
from collections.abc import Iterator
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

MOST_CHARACTERS = 1_000_000
MOST_DEPTH = 32  # nested brackets; our schemas need 3
MOST_TRIES = 20  # places tried as the beginning of an object
MOST_DIGITS = 30
THOUGHTS_END = ("</think>", "</thinking>")
FENCE = re.compile(r"```[ \t]*[\w-]*[ \t]*\r?\n(.*?)(?:```|\Z)", re.DOTALL)
NUMBER = re.compile(
    r"\s*([-+−]?\d{1,15}(?:[.,]\d{1,15})?)\s*(?:°|%|m|deg|degs|degrees?|percent|met(?:er|re)s?)?\s*"
)
NUMERIC = {"int_parsing", "float_parsing", "int_type", "float_type"}
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
    is none, or it does not fit the schema.
    """
    data = read_object(text)
    try:
        return _finite(schema.model_validate(data))
    except ValidationError as error:
        first = error
    if _with_numbers(data, first):
        try:
            return _finite(schema.model_validate(data))
        except ValidationError as error:
            first = error
    problem = first.errors(include_url=False, include_input=False, include_context=False)[0]
    place = plain(".".join(str(part) for part in problem["loc"])) or "the whole"
    raise NotReadableError(f"{place}: {plain(problem['msg'], 120)}") from None


def read_object(text: str) -> dict[str, Any]:
    """Returns the first JSON object in a text; raises NotReadableError if the text is blank, too long, or has
    no readable object.
    """
    if not text.strip():
        raise NotReadableError("it is blank")
    if len(text) > MOST_CHARACTERS:
        raise NotReadableError(f"it has more than {MOST_CHARACTERS:,} characters")
    why = NotReadableError("it holds no JSON object")
    for number, candidate in enumerate(_candidates(text.lstrip("\ufeff"))):
        try:
            found = _loads(candidate)
        except NotReadableError as error:
            why = error if number == 0 or candidate.startswith("{") else why
            continue
        if isinstance(found, dict):
            return found
        why = NotReadableError("it is JSON, but not an object")
    raise why


def _candidates(text: str) -> Iterator[str]:
    """Yields the whole text if it begins with a bracket, the contents of code fences, and the parts in
    balanced braces.
    """
    said = text
    for end_mark in THOUGHTS_END:
        said = said.rpartition(end_mark)[2]
    if said.lstrip()[:1] in ("{", "["):
        yield said.strip()
    for fence in FENCE.findall(said):
        yield fence.strip()
    tries, at = 0, said.find("{")
    while at >= 0 and tries < MOST_TRIES:
        end = next((end for end, depth in _depths(said, "{}", at) if depth == 0), None)
        if end is not None:
            yield said[at:end]
        tries, at = tries + 1, said.find("{", end or at + 1)


def _depths(text: str, brackets: str, start: int = 0) -> Iterator[tuple[int, int]]:
    """Yields, for each opening or closing bracket outside of strings, the index behind it and how many
    brackets are open there.
    """
    depth, in_string = 0, False
    for match in re.compile(rf'\\.|["{re.escape(brackets)}]', re.DOTALL).finditer(text, start):
        sign = match.group()
        if sign == '"':
            in_string = not in_string
        elif not in_string and sign in brackets:
            depth += 1 if sign in "{[" else -1
            yield match.end(), depth


def _loads(text: str) -> Any:
    if any(depth > MOST_DEPTH for _, depth in _depths(text, "{}[]")):
        raise NotReadableError(f"it has brackets inside brackets, more than {MOST_DEPTH} deep")
    try:
        return json.loads(
            text,
            object_pairs_hook=_object,
            parse_constant=_number,
            parse_float=_number,
            parse_int=_whole_number,
        )
    except json.JSONDecodeError as error:
        raise NotReadableError(f"it is not JSON ({error.msg} at character {error.pos:,})") from None


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


def _whole_number(text: str) -> int:
    if len(text) > MOST_DIGITS:
        raise NotReadableError(f"it holds a number of {len(text):,} digits")
    return int(text)


def _finite(found: Schema) -> Schema:
    """Returns the object; raises NotReadableError if a number in it is not finite.

    Pydantic accepts the text "NaN" and numbers that are too large for a float.
    """
    try:
        json.dumps(found.model_dump(), allow_nan=False, default=str)
    except ValueError:
        raise NotReadableError("it holds a number that is not finite") from None
    return found


def _with_numbers(data: dict[str, Any], error: ValidationError) -> bool:
    """Converts texts like "15 %" to numbers where the schema wants them; returns True if it changed any."""
    turned = False
    for problem in error.errors(include_url=False, include_context=False):
        if problem["type"] not in NUMERIC or not isinstance(problem["input"], str):
            continue
        match = NUMBER.fullmatch(problem["input"])
        if match:
            turned |= _put(data, problem["loc"], float(match[1].replace(",", ".").replace("−", "-")))
    return turned


def _put(data: Any, place: tuple[int | str, ...], number: float) -> bool:
    """Replaces the text at ``place`` by a number; names of union branches in ``place`` are skipped. Returns
    False if there is no text.
    """
    holder: Any = None
    last: int | str = ""
    for part in place:
        inside = isinstance(data, dict) and part in data
        inside = inside or (isinstance(data, list) and isinstance(part, int) and 0 <= part < len(data))
        if inside:
            holder, last, data = data, part, data[part]
    if holder is None or not isinstance(data, str):
        return False
    holder[last] = number
    return True
