"""Asks any server with OpenAI's protocol: OpenAI, Azure, Ollama, llama.cpp, vLLM, LM Studio and others.

A server may not support schemas, may silently ignore them, or may reject a parameter. The provider tries one
response format after another, beginning with the strictest, and remembers which of them the server supports.
The reply is always validated.
"""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary

from pydantic import BaseModel

from roadgpt.chat.account import Account, tokens_in
from roadgpt.chat.answer import Answer, from_chat, from_responses
from roadgpt.chat.client import ApiClient
from roadgpt.chat.config import key_for
from roadgpt.chat.json_schema import schema_of
from roadgpt.chat.meter import Meter
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent, Usage
from roadgpt.chat.request_error import RequestError
from roadgpt.chat.server_quirks import ResponseFormat, ServerQuirks, quirks_of
from roadgpt.chat.strict_json import NotReadableError, plain, read_as
from roadgpt.errors import ChatError, RefusedError, UnparsableError

MOST_TURNS = 20  # messages that are sent along if the server stores none
FULL = ("context_length", "context window", "too long", "maximum context")


class Conversation:
    """The conversation of one campaign with a model: its most recent messages and, if the server stores the
    conversation, its id there.
    """

    def __init__(self) -> None:
        self.name: str | None = None
        """Id of the conversation on the server."""
        self._turns: list[Message] = []

    def keep(self, messages: Sequence[Message], answer: str) -> None:
        """Stores the messages and the answer of one successful exchange."""
        said = [message for message in messages if message.role != "system"]
        self._turns = [*self._turns, *said, Message(role="assistant", text=answer)][-MOST_TURNS:]

    def respond(
        self, client: ApiClient, quirks: ServerQuirks, messages: Sequence[Message], body: dict[str, Any]
    ) -> Answer:
        """Sends messages that continue the conversation, and returns the answer."""
        rules = "\n\n".join(message.text for message in messages if message.role == "system")
        asked = [message for message in messages if message.role != "system"]
        if rules:
            body = {**body, "instructions": rules}
        if self.name is None and quirks.keeps_conversations:
            self._begin(client, quirks)
        if self.name is None:
            asked = [*self._turns, *asked]
            return from_responses(client.respond({**body, "input": _input(asked), "store": False}))
        try:
            return from_responses(client.respond({**body, "input": _input(asked), "conversation": self.name}))
        except RequestError as fault:
            if not any(word in fault.details for word in FULL):
                raise
            self.name = None  # it has grown too long: start a new one
            self._begin(client, quirks)
            rest = {"conversation": self.name} if self.name else {"store": False}
            return from_responses(client.respond({**body, "input": _input(asked), **rest}))

    def _begin(self, client: ApiClient, quirks: ServerQuirks) -> None:
        try:
            name = client.begin_conversation().get("id")
        except RequestError as fault:
            if fault.status not in (400, 403, 404, 405, 422, 501):
                raise
            name = None
        self.name = name if isinstance(name, str) and name else None
        quirks.keeps_conversations = self.name is not None


def _input(messages: Sequence[Message]) -> list[dict[str, str]]:
    return [{"role": message.role, "content": message.text} for message in messages]


ABOUT_FORMAT = ("response_format", "json", "schema", "grammar", "format", "structured", "guided")
OTHER_WAY = {400, 404, 415, 422, 500, 501}  # statuses after which another response format may work
MOST_REQUESTS = 8  # for one question: three response formats, a second try, and dropped parameters


class OpenAI:
    """A provider for servers with OpenAI's protocol."""

    def __init__(self, settings: ChatSettings) -> None:
        self._client = ApiClient(settings, key_for(settings.base_url))
        self._model = settings.model or self._only_model()
        self._settings = settings.model_copy(update={"model": self._model})
        self._account = Account(self._settings)
        self._quirks = quirks_of(self._client.place, self._model, settings.api)
        self._conversations: WeakKeyDictionary[Meter, Conversation] = WeakKeyDictionary()

    @property
    def spent(self) -> Spent:
        """The total cost of all questions so far."""
        return self._account.spent

    def _only_model(self) -> str:
        """Returns the name of the server's only model; raises ChatError if it has several models or none."""
        advice = "say which with --model or ROADGPT_MODEL"
        try:
            names = [str(one.get("id")) for one in self._client.models() if one.get("id")]
        except RequestError as fault:
            raise ChatError(f"no model is named ({advice}), and {fault.sentence}") from None
        if len(names) != 1:
            shown = f": {', '.join(plain(name, 40) for name in names[:8])}" if names else ""
            raise ChatError(f"{self._client.place} has {len(names)} models{shown}; {advice}")
        return names[0]

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        """Returns the answer, in whatever format the server supports; raises the errors of ``Chat.ask``."""
        before = self.spent
        first = self._quirks.response_format if schema is not None else ResponseFormat.TEXT
        way = FormatFallback(list(messages), first, schema is None)
        answer = Answer()
        for _ in range(MOST_REQUESTS):
            try:
                answer = self._exchange(way.messages, schema, way.response_format)
                data = _data(answer, schema)
            except RequestError as fault:
                if not self._adapts(fault) and not way.goes_down(fault):
                    raise ChatError(fault.sentence) from None
            except NotReadableError as error:
                self._quirks.failed(way.response_format)
                if not way.tries_again(messages, str(error)):
                    break
            else:
                self._quirks.worked(way.response_format, way.refused)
                self._conversation().keep(messages, answer.text)
                return self._reply(answer, data, before)
        sentence = f"no answer of the model '{plain(self._model)}' can be used: {way.why}"
        raise UnparsableError(sentence, answer.text)

    def _reply(self, answer: Answer, data: BaseModel | None, before: Spent) -> Reply:
        spent = self.spent.since(before)
        if data is not None:
            data = type(data).model_validate(self._client.redacted(data.model_dump()))
        return Reply(
            text=answer.text,
            data=data,
            model=answer.model or self._model,
            usage=spent.usage,
            seconds=spent.seconds,
            cost=spent.cost,
            finish=answer.finish,
            conversation=self._conversation().name,
        )

    def _conversation(self) -> Conversation:
        """Returns the conversation of the current campaign."""
        return self._conversations.setdefault(self._account.meter, Conversation())

    def _exchange(
        self, messages: Sequence[Message], schema: type[BaseModel] | None, response_format: ResponseFormat
    ) -> Answer:
        """Sends one request and counts it."""
        form = None if schema is None else schema_of(schema)
        told = list(messages)
        if form is not None and response_format > ResponseFormat.SCHEMA:
            told.append(_instruction(form))
        room = self._account.reply_tokens(told, self._model)
        begun = time.perf_counter()
        try:
            answer = self._sent(told, self._body(form, response_format, room))
        except NotReadableError:  # too long an answer: its cost is not known
            usage = Usage(prompt=sum(tokens_in(one.text) for one in told), completion=room)
            self._account.count(self._model, usage, time.perf_counter() - begun)
            raise
        usage = answer.usage if answer.usage.total else _guessed(told, answer)
        self._account.count(answer.model, usage, time.perf_counter() - begun)
        return answer

    def _sent(self, messages: Sequence[Message], body: dict[str, Any]) -> Answer:
        """Sends one request through the API that the settings select."""
        if self._settings.api == "responses":
            return self._conversation().respond(self._client, self._quirks, messages, body)
        turns = [{"role": message.role, "content": message.text} for message in messages]
        return from_chat(self._client.chat({**body, "messages": turns}))

    def _body(
        self, form: dict[str, Any] | None, response_format: ResponseFormat, room: int
    ) -> dict[str, Any]:
        """Returns everything in a request except the messages."""
        quirks = self._quirks
        body: dict[str, Any] = {"model": self._model}
        if quirks.caps:
            body[quirks.caps[0]] = room
        if self._settings.temperature is not None and quirks.takes_temperature:
            body["temperature"] = self._settings.temperature
        if form is None or response_format == ResponseFormat.TEXT:
            return body
        is_schema = response_format == ResponseFormat.SCHEMA
        named: dict[str, Any] = {"name": "answer", "schema": form, "strict": True}
        if self._settings.api == "responses":
            kind = {"type": "json_schema", **named} if is_schema else {"type": "json_object"}
            return {**body, "text": {"format": kind}}
        kind = {"type": "json_schema", "json_schema": named} if is_schema else {"type": "json_object"}
        return {**body, "response_format": kind}

    def _adapts(self, fault: RequestError) -> bool:
        """Returns True if a rejected parameter can be left out or renamed; later requests then do this."""
        if fault.status not in (400, 422):
            return False
        quirks = self._quirks
        said = f"{fault.parameter} {fault.details}"
        is_sent = self._settings.temperature is not None and quirks.takes_temperature
        if is_sent and "temperature" in said:
            quirks.takes_temperature = False
            return True
        if quirks.caps and (quirks.caps[0] == fault.parameter or quirks.caps[0] in fault.details):
            quirks.caps = quirks.caps[1:]
            return True
        return False


@dataclass
class FormatFallback:
    """Asks one question in different response formats, from the strictest to the loosest, until one works."""

    messages: list[Message]
    response_format: ResponseFormat
    is_last: bool
    """True if the next unusable reply in plain text ends the attempts."""
    refused: set[ResponseFormat] = field(default_factory=set)
    why: str = ""
    """The reason why the last answer was not usable."""

    def goes_down(self, fault: RequestError) -> bool:
        """Changes to the next looser format after a failed request, if the server may have rejected the
        request because of its format.

        Returns:
            True if the format was changed; False if the format was not the cause or there is no looser one.
        """
        if self.response_format == ResponseFormat.TEXT or not _is_about_format(fault):
            return False
        self.refused.add(self.response_format)
        self.response_format = ResponseFormat(self.response_format + 1)
        return True

    def tries_again(self, messages: Sequence[Message], why: str) -> bool:
        """Prepares another attempt after an unusable answer: with the next looser format or, if there is
        none, once more as plain text.

        Args:
            messages: the original question.
            why: the reason why the answer was not usable; it is included in the next request to the model.

        Returns:
            False if no attempt is left.
        """
        self.why = why
        if self.response_format == ResponseFormat.TEXT and self.is_last:
            return False
        self.is_last = self.response_format == ResponseFormat.TEXT
        self.response_format = ResponseFormat(min(self.response_format + 1, ResponseFormat.TEXT))
        self.messages = [*messages, _complaint(why)]
        return True


def _is_about_format(fault: RequestError) -> bool:
    """True if the response format may be the cause; status 400 or 422 alone says too little to exclude it."""
    if fault.status not in OTHER_WAY or any(word in fault.details for word in FULL):
        return False
    names_it = any(word in f"{fault.parameter} {fault.details}" for word in ABOUT_FORMAT)
    return names_it or fault.status in (400, 422)


def _data(answer: Answer, schema: type[BaseModel] | None) -> BaseModel | None:
    """Returns the validated answer; None if no schema was given.

    Raises:
        RefusedError: the model declined to answer.
        NotReadableError: the answer is blank or does not fit the schema.
    """
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
    """Returns a message that contains the schema, for servers that do not support schemas otherwise."""
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
    """Returns estimated numbers of tokens, for servers that do not report them."""
    return Usage(prompt=sum(tokens_in(one.text) for one in messages), completion=tokens_in(answer.text))
