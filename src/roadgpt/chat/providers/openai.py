"""Any server that speaks OpenAI's protocol: OpenAI, Azure, Ollama, llama.cpp, vLLM, LM Studio and others.

A server may not know schemas, may ignore them in silence, or may refuse a parameter: what it takes is found
out by asking, from the strictest way down, and is remembered. Whatever way was taken, the reply is
validated.
"""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary

from pydantic import BaseModel

from roadgpt.chat.answer import Answer, of_chat
from roadgpt.chat.config import key_for
from roadgpt.chat.fault import FaultError
from roadgpt.chat.flat import schema_of
from roadgpt.chat.habits import Rung, habits_of
from roadgpt.chat.meter import Account, Meter, tokens_in
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent, Usage
from roadgpt.chat.strict import NotReadableError, plain, read_as
from roadgpt.chat.talk import FULL, Talk
from roadgpt.chat.wire import Wire
from roadgpt.errors import ChatError, RefusedError, UnparsableError

ABOUT_FORMAT = ("response_format", "json", "schema", "grammar", "format", "structured", "guided")
OTHER_WAY = {400, 404, 415, 422, 500, 501}  # statuses after which another way of asking may do
MOST_REQUESTS = 8  # for one question: three rungs, a second try, and parameters that are dropped
SAMPLING = ("temperature",)


class OpenAI:
    """Asks a server that speaks OpenAI's protocol."""

    def __init__(self, settings: ChatSettings) -> None:
        self._wire = Wire(settings, key_for(settings.base_url))
        self._settings = (
            settings if settings.model else settings.model_copy(update={"model": self._only_model()})
        )
        self._account = Account(self._settings)
        self._model = self._settings.model or ""
        self._habits = habits_of(self._wire.place, self._model, settings.api)
        self._talks: WeakKeyDictionary[Meter, Talk] = WeakKeyDictionary()

    @property
    def spent(self) -> Spent:
        """What all questions have cost."""
        return self._account.spent

    def _only_model(self) -> str:
        """The one model that a server has; which of many is for the user to say."""
        advice = "say which with --model or ROADGPT_MODEL"
        try:
            names = [str(one.get("id")) for one in self._wire.models() if one.get("id")]
        except FaultError as fault:
            raise ChatError(f"no model is named ({advice}), and {fault.sentence}") from None
        if len(names) != 1:
            shown = f": {', '.join(plain(name, 40) for name in names[:8])}" if names else ""
            raise ChatError(f"{self._wire.place} has {len(names)} models{shown}; {advice}")
        return names[0]

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        """The answer, in whatever way the server can be brought to give it; raises as ``Chat.ask``."""
        before = self.spent
        way = Way(list(messages), self._habits.rung if schema is not None else Rung.TEXT, schema is None)
        answer = Answer()
        for _ in range(MOST_REQUESTS):
            try:
                answer = self._exchange(way.messages, schema, way.rung)
                data = _data(answer, schema)
            except FaultError as fault:
                if not self._adapts(fault) and not way.goes_down(fault):
                    raise ChatError(fault.sentence) from None
            except NotReadableError as error:
                self._habits.failed(way.rung)
                if not way.tries_again(messages, str(error)):
                    break
            else:
                self._habits.worked(way.rung, way.refused)
                self._talk().keep(messages, answer.text)
                return self._reply(answer, data, before)
        sentence = f"no answer of the model '{plain(self._model)}' can be used: {way.why}"
        raise UnparsableError(sentence, answer.text)

    def _reply(self, answer: Answer, data: BaseModel | None, before: Spent) -> Reply:
        spent = self.spent.since(before)
        if data is not None:
            data = type(data).model_validate(self._wire.cleaned(data.model_dump()))
        return Reply(
            text=answer.text,
            data=data,
            model=answer.model or self._model,
            usage=spent.usage,
            seconds=spent.seconds,
            cost=spent.cost,
            finish=answer.finish,
            conversation=self._talk().name,
        )

    def _talk(self) -> Talk:
        """The conversation of the campaign that asks now."""
        return self._talks.setdefault(self._account.meter, Talk())

    def _exchange(self, messages: Sequence[Message], schema: type[BaseModel] | None, rung: Rung) -> Answer:
        """One request, counted."""
        form = None if schema is None else schema_of(schema)
        told = [*messages, *([_instruction(form)] if form is not None and rung > Rung.SCHEMA else [])]
        room = self._account.room(told, self._model)
        begun = time.perf_counter()
        try:
            answer = self._sent(told, self._body(form, rung, room))
        except NotReadableError:  # a flood: what it cost is not told
            usage = Usage(prompt=sum(tokens_in(one.text) for one in told), completion=room)
            self._account.count(self._model, usage, time.perf_counter() - begun)
            raise
        usage = answer.usage if answer.usage.total else _guessed(told, answer)
        self._account.count(answer.model, usage, time.perf_counter() - begun)
        return answer

    def _sent(self, messages: Sequence[Message], body: dict[str, Any]) -> Answer:
        """One request, through the door that the settings name."""
        if self._settings.api == "responses":
            return self._talk().respond(self._wire, self._habits, messages, body)
        turns = [{"role": message.role, "content": message.text} for message in messages]
        return of_chat(self._wire.chat({**body, "messages": turns}))

    def _body(self, form: dict[str, Any] | None, rung: Rung, room: int) -> dict[str, Any]:
        """All of a request but the messages."""
        habits = self._habits
        body: dict[str, Any] = {"model": self._model}
        if habits.caps:
            body[habits.caps[0]] = room
        if self._settings.temperature is not None and "temperature" not in habits.dropped:
            body["temperature"] = self._settings.temperature
        if form is None or rung == Rung.TEXT:
            return body
        named: dict[str, Any] = {"name": "answer", "schema": form, "strict": True}
        if self._settings.api == "responses":
            kind = {"type": "json_schema", **named} if rung == Rung.SCHEMA else {"type": "json_object"}
            return {**body, "text": {"format": kind}}
        kind = (
            {"type": "json_schema", "json_schema": named} if rung == Rung.SCHEMA else {"type": "json_object"}
        )
        return {**body, "response_format": kind}

    def _adapts(self, fault: FaultError) -> bool:
        """Was a parameter refused that can be left out or named otherwise? It is then, from now on."""
        if fault.status not in (400, 422):
            return False
        habits = self._habits
        said = f"{fault.parameter} {fault.said}"
        for name in SAMPLING:
            if name in said and name not in habits.dropped and getattr(self._settings, name) is not None:
                habits.dropped.add(name)
                return True
        if habits.caps and (habits.caps[0] == fault.parameter or habits.caps[0] in fault.said):
            habits.caps = habits.caps[1:]
            return True
        return False


@dataclass
class Way:
    """How one question is put: from rung to rung, until an answer can be used."""

    messages: list[Message]
    rung: Rung
    is_last: bool
    """Is this the last try? A plain text is not asked for twice."""
    refused: set[Rung] = field(default_factory=set)
    why: str = ""
    """Why the last answer could not be used."""

    def goes_down(self, fault: FaultError) -> bool:
        """Is this way of asking at fault, and is there another?"""
        if self.rung == Rung.TEXT or not _is_about_format(fault):
            return False
        self.refused.add(self.rung)
        self.rung = Rung(self.rung + 1)
        return True

    def tries_again(self, messages: Sequence[Message], why: str) -> bool:
        """Asks on the next rung, on the last one twice; False where that is done."""
        self.why = why
        if self.rung == Rung.TEXT and self.is_last:
            return False
        self.is_last = self.rung == Rung.TEXT
        self.rung = Rung(min(self.rung + 1, Rung.TEXT))
        self.messages = [*messages, _complaint(why)]
        return True


def _is_about_format(fault: FaultError) -> bool:
    """Can the way of asking be at fault? A plain 400 says too little to rule it out."""
    if fault.status not in OTHER_WAY or any(word in fault.said for word in FULL):
        return False
    names_it = any(word in f"{fault.parameter} {fault.said}" for word in ABOUT_FORMAT)
    return names_it or fault.status in (400, 422)


def _data(answer: Answer, schema: type[BaseModel] | None) -> BaseModel | None:
    """The validated answer; RefusedError and NotReadableError where there is none."""
    if answer.refusal is not None:
        told = plain(answer.refusal, 160) or "no reason given"
        raise RefusedError(f"the model declined: {told}", answer.refusal)
    if schema is None:
        if not answer.text.strip():
            raise NotReadableError("it is blank")
        return None
    try:
        return read_as(schema, answer.text)
    except NotReadableError as error:
        if answer.finish == "length":
            raise NotReadableError(f"it was cut off (see --max-completion), and {error}") from None
        raise


def _instruction(form: dict[str, Any]) -> Message:
    """The schema in words, for servers that do not take it otherwise."""
    return Message(
        role="user",
        text="Answer with one JSON object and nothing else. It must fit this JSON schema, with every field:\n"
        + json.dumps(form, separators=(",", ":")),
    )


def _complaint(why: str) -> Message:
    return Message(
        role="user", text=f"(The answer before this could not be used: {why}. Answer with JSON alone.)"
    )


def _guessed(messages: Sequence[Message], answer: Answer) -> Usage:
    """Tokens where the server counts none."""
    return Usage(prompt=sum(tokens_in(one.text) for one in messages), completion=tokens_in(answer.text))
