"""Reads files of descriptions, with the requirements (``truth``) that people wrote down for each: JSON
lines with the keys ``id``, ``prompt`` and ``truth``."""

from importlib.resources import files
from pathlib import Path

from pydantic import Field, ValidationError

from roadgpt.brief.model import Frozen
from roadgpt.errors import UsageError
from roadgpt.reading import json_of, read_text
from roadgpt.study.truth import Truth

MOST = 10_000  # prompts in a file


class Prompt(Frozen):
    """A description of a road, with the requirements that people wrote down for it, if any."""

    id: str = Field(min_length=1, max_length=80)
    prompt: str = Field(min_length=1, max_length=10_000)
    truth: Truth | None = None
    """The requirements that people wrote down; None: roads are checked against the requirements that the
    reader finds."""


def read_prompts(path: Path) -> tuple[Prompt, ...]:
    """Returns the prompts of a file, in the order of the file.

    Raises:
        UsageError: the file cannot be read, has no prompts or more than 10,000, or has an invalid line; the
            message says what is wrong.
    """
    try:
        lines = read_text(path, 4_000_000, "a file of prompts", "utf-8-sig").splitlines()
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}; give a file of JSON lines") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} is no text in UTF-8; give a file of JSON lines") from error
    return _prompts([(number, text) for number, text in enumerate(lines, 1) if text.strip()], str(path))


def thesis_prompts() -> tuple[Prompt, ...]:
    """Returns the three descriptions of the thesis' table of valid roads, and two more from its survey."""
    text = files("roadgpt.study").joinpath("data/thesis.jsonl").read_text(encoding="utf-8")
    return _prompts(list(enumerate(text.splitlines(), 1)), "thesis.jsonl")


def _prompts(lines: list[tuple[int, str]], name: str) -> tuple[Prompt, ...]:
    found: dict[str, Prompt] = {}
    for number, text in lines:
        prompt = _prompt(number, text, f"{name}, line {number}")
        if prompt.id in found:
            raise UsageError(f"{name}, line {number}: the id '{prompt.id}' stands there twice")
        found[prompt.id] = prompt
    if not found:
        raise UsageError(f'{name} holds no prompt; give lines such as {{"id": "1", "prompt": "a road"}}')
    if len(found) > MOST:
        raise UsageError(f"{name} holds {len(found)} prompts; give {MOST:,} at most")
    return tuple(found.values())


def _prompt(number: int, text: str, where: str) -> Prompt:
    try:
        data = json_of(text)
    except ValueError as error:
        raise UsageError(f"{where} is no JSON ({error})") from error
    if not isinstance(data, dict):
        raise UsageError(f'{where} is no object; give lines such as {{"id": "1", "prompt": "a road"}}')
    data.setdefault("id", str(number))
    if isinstance(data["id"], int):
        data["id"] = str(data["id"])
    try:
        return Prompt.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise UsageError(f"{where}, {place}: {first['msg'].removeprefix('Value error, ')}") from error
