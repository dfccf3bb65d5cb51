"""Asks a language model a question and returns a Reply.

    chat = open_chat(ChatSettings(model="gpt-4.1-mini"))
    reply = chat.ask([Message(role="user", text="A road with 3 turns, please.")], schema=Road)
    reply.data      # a validated Road; if the model gave none, ask() raised a ReplyError

A provider is a plug-in registered under the entry point ``roadgpt.providers``: a class that is created with
ChatSettings and has a method ``ask``. The answers of a model are validated against the schema. They are never
executed or used as part of a path. API keys come from the environment, a .env file or the user's settings,
and are sent to the server only."""

import inspect
from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, Protocol

from pydantic import BaseModel

from roadgpt import plugins
from roadgpt.chat.meter import Meter, counting
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent, Usage
from roadgpt.errors import BudgetError, ChatError, RefusedError, ReplyError, UnparsableError, UsageError
from roadgpt.later import load

if TYPE_CHECKING:
    from roadgpt.chat.config import configured

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
    "open_chat",
    "plugin_of",
]


class Chat(Protocol):
    """A language model to which questions can be sent."""

    @property
    def spent(self) -> Spent:
        """The total cost of all questions to this Chat so far, including those that got no usable answer."""
        ...

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        """Returns the answer to the last message; if a schema is given, ``reply.data`` is a validated
        instance of it.

        Raises:
            BudgetError: the question could exceed the limit of tokens or money; it was not asked.
            RefusedError: the model declined to answer.
            UnparsableError: no reply fits the schema.
            ChatError: the server cannot be reached, rejects the key, or fails."""
        ...


def open_chat(settings: ChatSettings) -> Chat:
    """Returns a Chat with the model that the settings name. The Chat counts what its questions cost. The
    user's own model and server are used where the settings name none.

    If the settings name a folder for recording, all exchanges are stored there; if they name a folder to
    replay, the answers come from that folder instead of a server.

    Raises:
        ChatError: the API key that the server needs is missing; no model is named, and the server has none
            or several; or the library of the provider is not installed.
        UsageError: both recording and replay are set, or there is no recording to replay.
        PartError: no provider of that name is installed."""
    if settings.record is not None and settings.replay is not None:
        raise UsageError("exchanges are either recorded or replayed; give --record or --replay, not both")
    if settings.replay is not None:
        replayed: Chat = plugins.find("providers", "replay")(settings)
        return replayed
    from roadgpt.chat.config import configured

    usual = configured()
    open_fields = [name for name in ("model", "base_url") if getattr(settings, name) is None]
    settings = settings.model_copy(update={name: getattr(usual, name) for name in open_fields})
    live: Chat = plugins.find("providers", settings.provider)(settings)
    if settings.record is None:
        return live
    from roadgpt.chat.recording import Recorder

    return Recorder(settings, live)


def asks_a_model(part: Any) -> bool:
    """Returns whether a plug-in asks a language model: whether it is a class whose constructor has a
    parameter ``settings``."""
    return isinstance(part, type) and "settings" in inspect.signature(part).parameters


def plugin_of(kind: str, name: str, settings: ChatSettings | None = None) -> Any:
    """Returns the plug-in of a kind and name, ready for use; it is created once and then reused.

    A class that takes ChatSettings gets ``settings``; if ``settings`` is None, the class gets the settings
    that the user has configured. A plug-in that cannot be called is returned unchanged."""
    if not asks_a_model(plugins.find(kind, name)):
        return _made(kind, name, None)
    from roadgpt.chat.config import configured

    return _made(kind, name, settings or configured())


@cache
def _made(kind: str, name: str, settings: ChatSettings | None) -> Any:
    part = plugins.find(kind, name)
    if settings is not None:
        return part(settings)
    return part() if callable(part) else part


def __getattr__(name: str) -> Any:
    return load(__name__, {"config": "configured"}, name)
