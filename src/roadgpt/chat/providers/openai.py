"""Asks any server with OpenAI's protocol: OpenAI, Azure, Ollama, llama.cpp, vLLM, LM Studio and others.

A server may not support schemas, may silently ignore them, or may reject a parameter. There are three ways of
asking for JSON: with a schema that the server enforces; as any JSON object, with the schema in the prompt; as
plain text, from which the JSON is extracted. The provider tries these ways in turn, beginning with the
strictest, and remembers which parameters and formats the server accepts, so that each process has to find
this out only once. The reply is always validated."""

import json
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cache
from typing import Any

from pydantic import BaseModel

from roadgpt.chat.answer import Answer, NotReadableError, RequestError, from_chat, plain, read_as, schema_of
from roadgpt.chat.client import ApiClient
from roadgpt.chat.config import key_for
from roadgpt.chat.meter import Account, has_openai_prices, tokens_in
from roadgpt.chat.model import ChatSettings, Message, Reply, Spent, Usage
from roadgpt.errors import ChatError, RefusedError, UnparsableError

FULL = ("context_length", "context window", "too long", "maximum context")
# after so many unusable replies in a row in one format, the server is taken not to support it
UNUSABLE_IN_A_ROW = 2


class ResponseFormat(IntEnum):
    """The ways of asking for JSON, from the strictest to the loosest."""

    SCHEMA = 0
    OBJECT = 1
    TEXT = 2


@dataclass
class ServerQuirks:
    """What has been found out about one model on one server."""

    caps: tuple[str, ...]
    """Names that the server may use for the parameter that limits the length of a reply; the first is
    tried first."""
    response_format: ResponseFormat = ResponseFormat.SCHEMA
    takes_temperature: bool = True
    unusable: Counter[int] = field(default_factory=Counter)
    """How many replies in a row were unusable, by response format."""

    def worked(self, response_format: ResponseFormat, refused: set[ResponseFormat]) -> None:
        """Notes that a reply in this response format was usable. If all stricter formats were rejected or
        failed repeatedly, this one is tried first from now on."""
        self.unusable[response_format] = 0
        above = range(self.response_format, response_format)
        if all(one in refused or self.unusable[one] >= UNUSABLE_IN_A_ROW for one in above):
            self.response_format = max(self.response_format, response_format)


@cache
def quirks_of(place: str, model: str) -> ServerQuirks:
    """Returns what has been found out about a model on a server. ``model`` is only a key of the cache: the
    models of a server may differ."""
    # OpenAI's newer models reject the old name, most other servers silently ignore the new one
    caps = ("max_completion_tokens", "max_tokens")
    return ServerQuirks(caps if has_openai_prices(place) else caps[::-1])


forget = quirks_of.cache_clear
"""Forgets everything about all servers, as if the process had just started."""


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
        self._quirks = quirks_of(self._client.place, self._model)

    @property
    def spent(self) -> Spent:
        """The total cost of all questions so far."""
        return self._account.spent

    def _only_model(self) -> str:
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
        """Returns the answer, in whatever format the server supports; raises the errors of ``Chat.ask``.

        If the server may have rejected the format of a request, or the answer is not usable, the question is
        asked in the next looser format. If an answer in plain text lacks the JSON, the
        question is asked once more in plain text."""
        before = self.spent
        answer, why = Answer(), ""
        way = self._quirks.response_format if schema is not None else ResponseFormat.TEXT
        refused = set[ResponseFormat]()
        asked = messages
        is_last = schema is None  # the next unusable reply in plain text ends the attempts
        for _ in range(MOST_REQUESTS):
            try:
                answer = self._exchange(asked, schema, way)
                data = _data(answer, schema)
            except RequestError as fault:
                if self._adapts(fault):
                    continue
                if way == ResponseFormat.TEXT or not _is_about_format(fault):
                    raise ChatError(fault.sentence) from None
                refused.add(way)
                way = ResponseFormat(way + 1)
            except NotReadableError as error:
                why = str(error)
                self._quirks.unusable[way] += 1
                if way == ResponseFormat.TEXT and is_last:
                    break
                is_last = way == ResponseFormat.TEXT
                way = ResponseFormat(min(way + 1, ResponseFormat.TEXT))
                complaint = f"(The answer before this could not be used: {why}. Answer with JSON alone.)"
                asked = [*messages, Message(role="user", text=complaint)]
            else:
                self._quirks.worked(way, refused)
                return self._reply(answer, data, before)
        raise UnparsableError(
            f"no answer of the model '{plain(self._model)}' can be used: {why}", answer.text
        )

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
        )

    def _exchange(
        self, messages: Sequence[Message], schema: type[BaseModel] | None, response_format: ResponseFormat
    ) -> Answer:
        form = None if schema is None else schema_of(schema)
        told = list(messages)
        if form is not None and response_format > ResponseFormat.SCHEMA:
            told.append(_instruction(form))
        prompt = tokens_in(*(message.text for message in told))
        room = self._account.meter.reply_tokens(told, self._settings, self._model)
        begun = time.perf_counter()
        try:
            answer = self._sent(told, self._body(form, response_format, room))
        except NotReadableError:  # too long an answer: its cost is not known
            usage = Usage(prompt=prompt, completion=room)
            self._account.count(self._model, usage, time.perf_counter() - begun)
            raise
        guessed = Usage(prompt=prompt, completion=tokens_in(answer.text))  # not all servers report them
        usage = answer.usage if answer.usage.total else guessed
        self._account.count(answer.model, usage, time.perf_counter() - begun)
        return answer

    def _sent(self, messages: Sequence[Message], body: dict[str, Any]) -> Answer:
        said = [{"role": message.role, "content": message.text} for message in messages]
        return from_chat(self._client.send({**body, "messages": said}))

    def _body(
        self, form: dict[str, Any] | None, response_format: ResponseFormat, room: int
    ) -> dict[str, Any]:
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


def _is_about_format(fault: RequestError) -> bool:
    """True if the response format may be the cause; status 400 or 422 alone says too little to exclude it."""
    if fault.status not in OTHER_WAY or any(word in fault.details for word in FULL):
        return False
    names_it = any(word in f"{fault.parameter} {fault.details}" for word in ABOUT_FORMAT)
    return names_it or fault.status in (400, 422)


def _data(answer: Answer, schema: type[BaseModel] | None) -> BaseModel | None:
    """Returns the validated answer; None if no schema was given. Raises RefusedError if the model declined to
    answer, and NotReadableError if the answer is blank or does not fit the schema."""
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
    return Message(
        role="user",
        text="Answer with one JSON object and nothing else. It must fit this JSON schema, with every field:\n"
        + json.dumps(form, separators=(",", ":")),
    )
