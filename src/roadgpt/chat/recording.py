"""Stores every exchange with a provider, so that it can be replayed later."""

import hashlib
import json
import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from roadgpt.chat.answer import schema_of
from roadgpt.chat.meter import Account, occasion
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent
from roadgpt.errors import ChatError, ReplyError, UsageError, explained
from roadgpt.reading import read_json

FORMAT = 1
Turns = Counter[tuple[str, str, str]]
"""How often each question was stored or answered in a campaign; keys: ('kept' or 'taken', name, occasion)."""


class ExchangeStore:
    """A folder of recorded exchanges."""

    def __init__(self, folder: str) -> None:
        self.folder = Path(folder)

    def keep(self, question: dict[str, Any], occasion: str, answer: dict[str, Any], turns: Turns) -> None:
        """Stores an answer to a question under its occasion. The first answer that a campaign stores for this
        question and occasion replaces all answers from earlier campaigns. Raises ChatError if the folder
        cannot be written to."""
        name = name_of(question)
        there = self._answers(name)
        mine = there.get(occasion, []) if turns["kept", name, occasion] else []
        turns["kept", name, occasion] += 1
        whole = {"format": FORMAT, "question": question, "answers": {**there, occasion: [*mine, answer]}}
        path = self._path(name)
        draft = path.with_name(f"{path.name}.{os.getpid()}.part")
        with explained(ChatError, f"cannot record into {self.folder}", "name another folder"):
            path.parent.mkdir(parents=True, exist_ok=True)
            draft.write_text(text_of(whole, indent=1) + "\n", encoding="utf-8")
            draft.replace(path)

    def take(self, question: dict[str, Any], occasion: str, turns: Turns) -> dict[str, Any] | None:
        """Returns the next recorded answer to a question for an occasion; None if no answer is left.

        If no answers were recorded for the occasion, those recorded without an occasion are used. If
        ``occasion`` is empty and no answers were recorded without an occasion, the answers of all occasions
        are used, one after another."""
        name = name_of(question)
        answers = self._answers(name)
        listed = answers.get(occasion) or answers.get("")
        if listed is None and not occasion:
            listed = [answer for one in answers.values() for answer in one]
        turn = turns["taken", name, occasion]
        if not listed or turn >= len(listed):
            return None
        turns["taken", name, occasion] += 1
        return listed[turn]

    def models(self) -> list[str | None]:
        """Returns the names of the models to which the recorded questions were sent."""
        names = {self._read(path).get("question", {}).get("model") for path in self.folder.glob("??/*.json")}
        return sorted(names, key=str)

    def _answers(self, name: str) -> dict[str, list[dict[str, Any]]]:
        path = self._path(name)
        return dict(self._read(path)["answers"]) if path.is_file() else {}

    def _path(self, name: str) -> Path:
        return self.folder / name[:2] / f"{name}.json"

    def _read(self, path: Path) -> dict[str, Any]:
        try:
            found = read_json(path, 10_000_000, "a recording")
            if found["format"] == FORMAT and isinstance(found["answers"], dict):
                return dict(found)
        except (OSError, ValueError, KeyError, TypeError):
            pass
        raise UsageError(f"{path} is not a readable recording; record it again with --record")


def name_of(question: dict[str, Any]) -> str:
    """Returns the SHA-256 of a question as 64 hexadecimal digits."""
    return hashlib.sha256(text_of(question).encode("utf-8", "backslashreplace")).hexdigest()


def text_of(value: Any, indent: int | None = None) -> str:
    """Returns a value as JSON in one canonical form."""
    return json.dumps(value, sort_keys=True, ensure_ascii=True, indent=indent, allow_nan=False)


def question_of(
    settings: ChatSettings, messages: Sequence[Message], schema: type[BaseModel] | None
) -> dict[str, Any]:
    """Returns everything that defines a question, including the name of the model, as a dictionary."""
    return {
        "provider": settings.provider,
        "model": settings.model,
        "messages": [message.model_dump() for message in messages],
        "schema": None if schema is None else schema_of(schema),
        "parameters": {"api": "chat", **settings.model_dump(include={"temperature", "max_completion"})},
    }


class Recorder:
    """Wraps a Chat and stores every answer, whether or not the answer could be used."""

    def __init__(self, settings: ChatSettings, live: Any) -> None:
        assert settings.record is not None
        self._settings, self._live = settings, live
        self._store = ExchangeStore(settings.record)
        self._account = Account(settings)

    @property
    def spent(self) -> Spent:
        """The costs of the wrapped Chat so far."""
        spent: Spent = self._live.spent
        return spent

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        """Asks the wrapped Chat, stores its answer and returns it; raises the same errors as ``Chat.ask``."""
        question = question_of(self._settings, messages, schema)
        before = self.spent
        try:
            reply: Reply = self._live.ask(messages, schema)
        except ReplyError as error:
            failure = {"kind": type(error).__name__, "sentence": str(error), "text": error.text}
            self._keep(question, {"failure": failure, "spent": self.spent.since(before).model_dump()})
            raise
        kept = {"reply": reply.model_dump(mode="json"), "spent": self.spent.since(before).model_dump()}
        self._keep(question, kept)
        return reply

    def _keep(self, question: dict[str, Any], answer: dict[str, Any]) -> None:
        self._store.keep(question, occasion(), answer, self._account.meter.turns)
