"""The room of language models: a question goes out, a Reply comes back. Verb: ``ask``.

    chat = open_chat(ChatSettings(model="gpt-4.1-mini"))
    reply = chat.ask([Message(role="user", text="A road with 3 turns, please.")], schema=Road)
    reply.data      # a Road, validated; or one sentence was raised

A provider is a part on the shelf ``providers``: a class that is made with ChatSettings and has ``ask``.
What it gives back is data: validated against the schema, and nothing of it is run, formatted into a path,
or trusted beyond its schema. Keys come from the environment, a .env file or the user's settings, and go
nowhere but to the server.
"""

import inspect
from collections.abc import Sequence
from typing import Any, Protocol

from pydantic import BaseModel

from roadgpt import plugins
from roadgpt.chat.config import configured
from roadgpt.chat.meter import Meter, counting
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent, Usage
from roadgpt.errors import BudgetError, ChatError, RefusedError, ReplyError, UnparsableError, UsageError

__all__ = [
    "BudgetError",
    "Chat",
    "ChatError",
    "ChatSettings",
    "Message",
    "Meter",
    "RefusedError",
    "Reply",
    "ReplyError",
    "Spent",
    "UnparsableError",
    "Usage",
    "asks_a_model",
    "configured",
    "counting",
    "instantiate",
    "open_chat",
    "settings_for",
]


class Chat(Protocol):
    """Someone who answers."""

    @property
    def spent(self) -> Spent:
        """What all questions to this Chat have cost, those that came to nothing included."""
        ...

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        """The answer to the last of the messages; with a schema, ``reply.data`` is an instance of it.

        Raises:
            BudgetError: the limit of tokens or money would be passed; nothing was asked.
            RefusedError: the model declined.
            UnparsableError: no reply fits the schema.
            ChatError: the server cannot be reached, refuses the key, or fails.
        """
        ...


def open_chat(settings: ChatSettings) -> Chat:
    """A Chat with the model of the settings: its provider, a meter, and the recording where one is wanted.

    Raises:
        ChatError: no key, no model, or the library of the provider is not installed.
        PartError: no such provider.
    """
    if settings.record is not None and settings.replay is not None:
        raise UsageError("an exchange is recorded or replayed, not both; say --record or --replay")
    if settings.replay is not None:
        replayed: Chat = plugins.find("providers", "replay")(settings)
        return replayed
    settings = _filled(settings)
    live: Chat = plugins.find("providers", settings.provider)(settings)
    if settings.record is None:
        return live
    from roadgpt.chat.recording import Recorder

    return Recorder(settings, live)


def _filled(settings: ChatSettings) -> ChatSettings:
    """With the model and the server that the user has settled on elsewhere, where none are given here."""
    usual = configured()
    names = [name for name in ("model", "base_url") if getattr(settings, name) is None]
    return settings.model_copy(update={name: getattr(usual, name) for name in names})


def asks_a_model(part: Any) -> bool:
    """Does a reader or a designer take ChatSettings, as ``__init__(self, settings)``?"""
    return isinstance(part, type) and "settings" in inspect.signature(part).parameters


def settings_for(part: Any, settings: ChatSettings | None) -> ChatSettings | None:
    """What a part is made with: the user's own settings where none are given, None where it takes none."""
    return (settings or configured()) if asks_a_model(part) else None


def instantiate(part: Any, settings: ChatSettings | None = None) -> Any:
    """An object of a part: made with the settings where its class takes some, else without arguments."""
    if asks_a_model(part):
        return part(settings)
    return part() if callable(part) else part
