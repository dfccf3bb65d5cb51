"""The schema that is sent: flat, and with nothing in it that some server chokes on."""

import re
from enum import StrEnum
from typing import Annotated, Any, Literal

import pytest
from pydantic import BaseModel, Field

from roadgpt.brief.change.chatting import ChangeAnswer
from roadgpt.brief.readers.chat import PlanAnswer
from roadgpt.chat.answer import schema_of

TAKEN = {"type", "enum", "description", "properties", "required", "additionalProperties", "items", "anyOf"}


class Hand(StrEnum):
    LEFT = "left"
    RIGHT = "right"


class Inner(BaseModel):
    distance: Annotated[float, Field(gt=0, le=1000)]
    direction: Literal["left", "right"]
    hand: Hand = Hand.LEFT


class Outer(BaseModel):
    """A road."""

    name: Annotated[str, Field(max_length=20, pattern="^a+$")] = "a"
    kind: Literal["road"] = "road"
    maybe: float | None = None
    inner: Inner | None = None
    parts: Annotated[list[Inner], Field(min_length=1, max_length=9, description="In driving order.")]


def keywords(schema: dict[str, Any]) -> set[str]:
    found = {*schema}
    for field in schema.get("properties", {}).values():
        found |= keywords(field)
    for inner in [schema.get("items"), *schema.get("anyOf", [])]:
        found |= keywords(inner) if inner else set()
    return found


def objects(schema: dict[str, Any]) -> list[dict[str, Any]]:
    inner = [
        *schema.get("properties", {}).values(),
        *schema.get("anyOf", []),
        *([schema["items"]] if "items" in schema else []),
    ]
    return ([schema] if schema.get("type") == "object" else []) + [o for one in inner for o in objects(one)]


@pytest.mark.parametrize("model", [Outer, Inner, PlanAnswer, ChangeAnswer])
def test_only_keywords_that_every_server_takes_are_sent(model: type[BaseModel]) -> None:
    schema = schema_of(model)
    assert keywords(schema) <= TAKEN
    for one in objects(schema):
        assert one["additionalProperties"] is False
        assert one["required"] == [*one["properties"]]


def test_types_enumerations_and_descriptions_stay() -> None:
    schema = schema_of(Outer)
    fields = schema["properties"]
    assert fields["maybe"] == {"anyOf": [{"type": "number"}, {"type": "null"}]}
    assert fields["kind"] == {"type": "string", "enum": ["road"]}
    assert fields["parts"]["description"] == "In driving order."
    inner = fields["parts"]["items"]["properties"]
    assert inner["direction"]["enum"] == inner["hand"]["enum"] == ["left", "right"]
    assert fields["inner"]["anyOf"][1] == {"type": "null"}


def test_patterns_are_for_servers_that_take_them() -> None:
    plain, full = schema_of(PlanAnswer), schema_of(PlanAnswer, patterns=True)
    pattern = full["properties"]["scene"]["items"].pop("pattern")
    assert (full, keywords(plain) & {"pattern"}) == (plain, set())
    assert re.fullmatch(pattern, "truck ahead gap=30 v=50: brake 6 after turn 1, keep")
    assert not re.search(r"\(\?|\\[bdwBDW]", pattern), "servers' grammars know no such things"
