"""Returns recorded answers instead of asking a server. It needs no network and no API key, and always returns
the same answers."""

from collections.abc import Sequence

from pydantic import BaseModel

from roadgpt.chat.meter import Account, occasion
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent
from roadgpt.chat.recording import ExchangeStore, question_of
from roadgpt.errors import ChatError, RefusedError, ReplyError, UnparsableError, UsageError

FAILURES = {kind.__name__: kind for kind in (RefusedError, UnparsableError, ReplyError)}


class Replay:
    """A provider that takes its answers from a folder that was recorded with ``--record``."""

    def __init__(self, settings: ChatSettings) -> None:
        if settings.replay is None:
            raise UsageError("no recording is named; give its folder with --replay FOLDER")
        self._store = ExchangeStore(settings.replay)
        self._account = Account(settings)
        models = self._store.models()
        if not models:
            raise UsageError(f"there is no recording in {settings.replay}; make one with --record")
        if settings.provider == "replay":  # chosen by that name; recordings are made of servers
            settings = settings.model_copy(update={"provider": "openai"})
        if settings.model is None and len(models) == 1:
            settings = settings.model_copy(update={"model": models[0]})
        self._settings = settings

    @property
    def spent(self) -> Spent:
        """The costs that were recorded with the exchanges replayed so far."""
        return self._account.spent

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        """Returns the answer that was recorded for this question, or raises the recorded error again. Raises
        ChatError if no answer to it was recorded, and UsageError if the recording cannot be read."""
        self._account.meter.reply_tokens(messages, self._settings, self._settings.model or "")
        question = question_of(self._settings, messages, schema)
        kept = self._store.take(question, occasion(), self._account.meter.turns)
        if kept is None:
            models = ", ".join(str(model) for model in self._store.models())
            raise ChatError(
                f"the recording in {self._settings.replay} holds no answer to this question; use the same "
                f"description, seed and options as when it was made (model {models}), or record it with "
                "--record"
            )
        try:
            self._account.add(Spent.model_validate(kept["spent"]))
            if "failure" in kept:
                failure = kept["failure"]
                raise FAILURES[failure["kind"]](failure["sentence"], failure["text"])
            data = None if schema is None else schema.model_validate(kept["reply"]["data"])
            return Reply.model_validate({**kept["reply"], "data": data})
        except (KeyError, TypeError, ValueError):
            raise UsageError(
                f"a recording in {self._settings.replay} cannot be read; record it again with --record"
            ) from None
