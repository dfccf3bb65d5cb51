"""Asks any server with OpenAI's protocol: OpenAI, Azure, Ollama, llama.cpp, vLLM, LM Studio and others.

A server may not support schemas, may silently ignore them, or may reject a parameter. JSON is asked for with
a schema that the server enforces and, if that does not work, as plain text with the schema in the prompt.
What the server accepts is remembered, so that each process has to find it out only once. The reply is always
validated."""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
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
UNUSABLE_IN_A_ROW = 2  # replies, after which the server is taken not to support schemas


@dataclass
class ServerQuirks:
    """What has been found out about one model on one server."""

    caps: tuple[str, ...]
    """Names that the server may use for the parameter that limits the length of a reply; the first is
    tried first."""
    takes_schema: bool = True
    takes_patterns: bool = True
    """Whether texts in a schema may have to fit a regular expression."""
    takes_temperature: bool = True
    unusable: int = 0
    """How many replies in a row did not fit the schema that was sent."""


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
MOST_REQUESTS = 8  # for one question: two formats, a second try, and dropped parameters


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

        If the server may have rejected the schema, or the answer is not usable, the question is asked again
        in plain text; if its answer lacks the JSON, once more."""
        before, quirks = self.spent, self._quirks
        answer, why, asked = Answer(), "", messages
        by_schema = schema is not None and quirks.takes_schema
        is_refused, is_last = False, schema is None
        for _ in range(MOST_REQUESTS):
            try:
                answer = self._exchange(asked, schema, by_schema)
                data = _data(answer, schema)
            except RequestError as fault:
                if self._adapts(fault):
                    continue
                if not (by_schema and _is_about_format(fault)):
                    raise ChatError(fault.sentence) from None
                if quirks.takes_patterns and schema and schema_of(schema, True) != schema_of(schema):
                    quirks.takes_patterns = False
                    continue
                by_schema, is_refused = False, True
            except NotReadableError as error:
                why = str(error)
                if is_last:
                    break
                is_last = not by_schema
                quirks.unusable += by_schema
                by_schema = False
                complaint = f"(The answer before this could not be used: {why}. Answer with JSON alone.)"
                asked = [*messages, Message(role="user", text=complaint)]
            else:
                if by_schema:
                    quirks.unusable = 0
                elif is_refused or quirks.unusable >= UNUSABLE_IN_A_ROW:
                    quirks.takes_schema = False
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
        self, messages: Sequence[Message], schema: type[BaseModel] | None, by_schema: bool
    ) -> Answer:
        form = None if schema is None else schema_of(schema, by_schema and self._quirks.takes_patterns)
        told = list(messages)
        if form is not None and not by_schema:
            text = "Answer with one JSON object and nothing else. It must fit this JSON schema, with every "
            text += f"field:\n{json.dumps(form, separators=(',', ':'))}"
            told.append(Message(role="user", text=text))
        prompt = tokens_in(*(message.text for message in told))
        room = self._account.meter.reply_tokens(told, self._settings, self._model)
        body: dict[str, Any] = {"model": self._model}
        body["messages"] = [{"role": message.role, "content": message.text} for message in told]
        if self._quirks.caps:
            body[self._quirks.caps[0]] = room
        if self._settings.temperature is not None and self._quirks.takes_temperature:
            body["temperature"] = self._settings.temperature
        if by_schema:
            named = {"name": "answer", "schema": form, "strict": True}
            body["response_format"] = {"type": "json_schema", "json_schema": named}
        begun = time.perf_counter()
        try:
            answer = from_chat(self._client.send(body))
        except NotReadableError:  # too long an answer: its cost is not known
            usage = Usage(prompt=prompt, completion=room)
            self._account.count(self._model, usage, time.perf_counter() - begun)
            raise
        guessed = Usage(prompt=prompt, completion=tokens_in(answer.text))  # not all servers report them
        usage = answer.usage if answer.usage.total else guessed
        self._account.count(answer.model, usage, time.perf_counter() - begun)
        return answer

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
