"""How a server is brought to answer: the strictest way first, remembered, with patience where it helps."""

import json
import time
from typing import Any

import pytest
from pydantic import BaseModel, Field

from chat.stub_server import (
    HeardRequest,
    StubServer,
    answers,
    drips,
    drops,
    fails,
    floods,
    only,
    refuses,
    says,
)
from roadgpt.chat import Chat, ChatError, ChatSettings, Message, RefusedError, UnparsableError, open_chat


class Sum(BaseModel):
    total: int


GOOD = '{"total": 4}'
FENCED = f"Sure!\n```json\n{GOOD}\n```"
QUESTION = [Message(role="system", text="You add."), Message(role="user", text="2 + 2 =")]


def chat_with(stub: StubServer, **settings: Any) -> Chat:
    return open_chat(ChatSettings(**{"base_url": stub.url, "model": "m", "timeout": 5.0, **settings}))


def total(chat: Chat) -> int:
    reply = chat.ask(QUESTION, Sum)
    assert isinstance(reply.data, Sum)
    return reply.data.total


def test_a_reply_says_what_it_was_and_what_it_cost(stub: StubServer) -> None:
    stub.play(says(GOOD))
    chat = chat_with(stub, price="1/10")
    reply = chat.ask(QUESTION, Sum)
    assert reply.data == Sum(total=4)
    assert (reply.text, reply.finish, reply.model) == (GOOD, "stop", "stub-model-2026-11-20")
    assert (reply.usage.prompt, reply.usage.completion) == (100, 50)
    assert reply.cost == pytest.approx((100 * 1 + 50 * 10) / 1e6)
    assert 0 < reply.seconds < 5
    assert chat.spent.usage == reply.usage


@pytest.mark.parametrize(
    ("knows", "text", "response_formats"),
    [
        (("json_schema", "json_object", "text"), GOOD, ["json_schema"]),
        (("json_schema", "text"), FENCED, ["json_schema"]),  # llama.cpp, LM Studio: schema ignored
        (("json_object", "text"), GOOD, ["json_schema", "text"]),
        (("text",), FENCED, ["json_schema", "text"]),
    ],
)
def test_plain_text_is_asked_for_where_needed_and_that_is_remembered(
    stub: StubServer, knows: tuple[str, ...], text: str, response_formats: list[str]
) -> None:
    stub.play(only(*knows, text=text, message="'response_format.type' must be 'json_schema' or 'text'"))
    assert total(chat_with(stub)) == 4
    assert stub.response_formats == response_formats
    stub.play(only(*knows, text=text))
    assert total(chat_with(stub)) == 4
    assert stub.response_formats == response_formats[-1:]


class Code(BaseModel):
    code: str = Field(json_schema_extra={"pattern": "^[a-z]{3}$"})


def test_a_server_without_patterns_gets_the_schema_without_them_and_that_is_remembered(
    stub: StubServer,
) -> None:
    def scene(request: HeardRequest, handler: Any) -> None:
        has = '"pattern"' in json.dumps(request.body["response_format"])
        (fails(400, "schema keyword 'pattern' is not supported") if has else says('{"code": "abc"}'))(
            request, handler
        )

    stub.play(scene)
    chat = chat_with(stub)
    assert chat.ask(QUESTION, Code).data == chat.ask(QUESTION, Code).data == Code(code="abc")
    assert [*stub.response_formats] == ["json_schema"] * 3
    assert [json.dumps(each.body).count("[a-z]{3}") for each in stub.requests] == [1, 0, 0]


def test_patterns_are_never_pasted_into_the_words(stub: StubServer) -> None:
    stub.play(only("text", text='{"code": "abc"}'))
    chat_with(stub).ask(QUESTION, Code)
    assert stub.response_formats == ["json_schema", "json_schema", "text"]
    assert ["[a-z]{3}" in json.dumps(each.body) for each in stub.requests] == [True, False, False]


def test_without_a_format_the_schema_stands_in_the_words(stub: StubServer) -> None:
    stub.play(only("text", text=GOOD))
    total(chat_with(stub))
    assert "total" not in str(stub.requests[0].body["messages"])
    assert '"required":["total"]' in stub.requests[-1].last


def test_a_server_that_ignores_schemas_is_asked_otherwise_after_some_failures(stub: StubServer) -> None:
    def scene(request: HeardRequest, handler: Any) -> None:
        says(GOOD if request.response_format == "text" else "Four, I think.")(request, handler)

    for _ in range(2):
        stub.play(scene)
        assert total(chat_with(stub)) == 4
        assert stub.response_formats == ["json_schema", "text"]
    stub.play(scene)
    assert total(chat_with(stub)) == 4
    assert stub.response_formats == ["text"]


@pytest.mark.parametrize(
    ("scene", "why"),
    [
        (says("No."), "no JSON object"),
        (says(" \n" * 4000, "length"), "cut off .*, and it is blank"),
        (says('{"sum": 4}'), "total: Field required"),
        (says(None), "blank"),
        (answers({"choices": [{"message": {"content": 7}}]}), "blank"),
        (floods(3), "bytes"),
    ],
)
def test_after_all_formats_one_sentence_is_left(stub: StubServer, scene: Any, why: str) -> None:
    stub.play(scene)
    with pytest.raises(UnparsableError, match=why) as caught:
        total(chat_with(stub))
    assert stub.response_formats == ["json_schema", "text", "text"]
    assert "\n" not in str(caught.value)
    assert len(caught.value.text) <= 2000


@pytest.mark.parametrize(
    ("scene", "told"),
    [
        (says(None, refusal="I cannot help with roads."), "cannot help with roads"),
        (says("", "content_filter"), "filter"),
        (says(None, refusal="No\n\x1b[31mroads\x00" + "!" * 999), r"No \[31mroads"),
    ],
)
def test_a_refusal_is_told_and_not_argued_with(stub: StubServer, scene: Any, told: str) -> None:
    stub.play(scene)
    with pytest.raises(RefusedError, match=f"the model declined: .*{told}") as caught:
        total(chat_with(stub))
    assert len(stub.requests) == 1
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("parameter", ["temperature", "max_tokens"])
def test_a_parameter_that_is_refused_is_left_out_from_then_on(stub: StubServer, parameter: str) -> None:
    stub.play(refuses(parameter, GOOD))
    assert total(chat_with(stub, temperature=0.5)) == 4
    assert len(stub.requests) == 2
    assert parameter in stub.requests[0].body
    stub.play(refuses(parameter, GOOD))
    assert total(chat_with(stub, temperature=0.5)) == 4
    assert len(stub.requests) == 1


@pytest.mark.parametrize("scene", [fails(500, "boom"), drops(), drops(b'{"id": ')])
def test_patience_ends(stub: StubServer, waits: list[float], scene: Any) -> None:
    stub.play(scene)
    with pytest.raises(ChatError, match=r"\(tried 3 times\)$"):
        total(chat_with(stub, retries=2))
    assert len(stub.requests) == 3


def test_an_account_without_credit_is_told(stub: StubServer, waits: list[float]) -> None:
    stub.play(fails(429, "You exceeded your current quota", code="insufficient_quota"))
    with pytest.raises(ChatError, match=r"has no credit left: You exceeded your current quota$"):
        total(chat_with(stub))


def test_nobody_waits_for_an_hour(stub: StubServer, waits: list[float]) -> None:
    stub.play(fails(429, "", {"retry-after": "3600"}))
    with pytest.raises(ChatError, match="asks to wait 3600 s"):
        total(chat_with(stub))
    assert waits == []


@pytest.mark.parametrize(
    ("scene", "told"),
    [
        (fails(401, "Incorrect API key provided"), "wants a key, and none is set"),
        (fails(403, "Country not supported"), "does not allow this"),
        (fails(404, "The model `m` does not exist"), "does not know this model or address"),
        (fails(413, "too large"), "rejects the question with status 413: too large"),
        (fails(400, "This model's maximum context length is 8192 tokens"), "maximum context length"),
        (answers({"error": {"message": "no such model", "code": 404}}), "does not know this model"),
        (answers(b"<html>Welcome to nginx</html>"), "did not answer with JSON .*base URL"),
        (answers([1, 2]), "did not answer with JSON"),
        (fails(404, "<!DOCTYPE HTML><html><p>File not found"), "it answered with a web page, .*--base-url"),
    ],
)
def test_what_will_not_pass_is_told_at_once(
    stub: StubServer, waits: list[float], scene: Any, told: str
) -> None:
    stub.play(scene)
    with pytest.raises(ChatError, match=told):
        total(chat_with(stub))
    assert len(stub.requests) == 1
    assert waits == []


def test_an_answer_that_drips_in_is_given_up_in_time(stub: StubServer) -> None:
    stub.play(drips(0.05))
    begun = time.perf_counter()
    with pytest.raises(ChatError, match=r"gave no complete answer within 0\.5 s"):
        total(chat_with(stub, timeout=0.5, retries=0))
    assert time.perf_counter() - begun < 2.5


def test_a_server_that_is_not_there_is_told(stub: StubServer, waits: list[float]) -> None:
    chat = open_chat(ChatSettings(base_url="http://127.0.0.1:9/v1", model="m", retries=1))
    with pytest.raises(
        ChatError, match=r"http://127\.0\.0\.1:9/v1 cannot be reached .*is the server running\?"
    ):
        chat.ask(QUESTION)


def test_the_only_model_of_a_server_need_not_be_named(stub: StubServer) -> None:
    stub.play(says(GOOD))
    assert total(chat_with(stub, model=None)) == 4
    assert stub.requests[0].body["model"] == "stub-model"
    stub.models[:] = ["one", "two"]
    with pytest.raises(ChatError, match="has 2 models: one, two; say which with --model"):
        chat_with(stub, model=None)
    with pytest.raises(ChatError, match=r"no model is named \(say which with --model .*cannot be reached"):
        open_chat(ChatSettings(base_url="http://127.0.0.1:9/v1", retries=0))


def test_content_may_come_in_parts(stub: StubServer) -> None:
    stub.play(says([{"type": "text", "text": '{"total":'}, {"type": "text", "text": " 4}"}]))
    assert total(chat_with(stub)) == 4
