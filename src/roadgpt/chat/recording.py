"""Stores every exchange with a provider, so that it can be replayed later."""

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel

from roadgpt.chat.json_schema import schema_of
from roadgpt.chat.meter import Account, occasion
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent
from roadgpt.chat.store import ExchangeStore
from roadgpt.errors import ReplyError


def question_of(
    settings: ChatSettings, messages: Sequence[Message], schema: type[BaseModel] | None
) -> dict[str, Any]:
    """Returns everything that defines a question, including the name of the model, as a dictionary."""
    parameters = {
        "api": settings.api,
        "temperature": settings.temperature,
        "max_completion": settings.max_completion,
    }
    return {
        "provider": settings.provider,
        "model": settings.model,
        "messages": [message.model_dump() for message in messages],
        "schema": None if schema is None else schema_of(schema),
        "parameters": parameters,
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
