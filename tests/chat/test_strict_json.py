"""JSON out of whatever a model writes: what is there is found, what nobody can have meant is refused."""

import json
import time
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from roadgpt.chat.answer import MOST_CHARACTERS, NotReadableError, plain, read_object


class Part(BaseModel):
    distance: float
    turns: int


class Whole(BaseModel):
    name: str
    parts: list[Part]
    spare: float | None = None


texts = st.text(st.characters(codec="utf-8", exclude_characters="{}`<"), max_size=30)
values = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**9), 10**9) | st.floats(-1e9, 1e9) | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=20,
)
objects = st.dictionaries(st.text(max_size=8), values, max_size=5)


@given(objects, texts, texts, st.sampled_from(["plain", "fence", "named fence", "talk", "thoughts"]))
def test_an_object_is_found_in_whatever_stands_around_it(
    data: dict[str, Any], before: str, after: str, how: str
) -> None:
    inner = json.dumps(data)
    wrapped = {
        "plain": inner,
        "fence": f"{before}\n```\n{inner}\n```\n{after}",
        "named fence": f"{before}\n```json\n{inner}\n```\n{after}",
        "talk": f"{before} {inner} {after}",
        "thoughts": f"<think>{before} {{no}} </think>\n{inner}",
    }[how]
    assert read_object(wrapped) == data


@given(st.text(max_size=400))
def test_any_text_is_an_object_or_refused(text: str) -> None:
    with suppress(NotReadableError):
        assert isinstance(read_object(text), dict)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "blank"),
        (" \n\t" * 10_000, "blank"),
        ("I would rather not.", "no JSON object"),
        ("[1, 2]", "no JSON object"),
        ('{"a": NaN}', "NaN"),
        ('{"a": -Infinity}', "Infinity"),
        ('{"a": 1e999}', "not a number"),
        ('{"a": ' + "9" * 5000 + "}", "digits"),
        ('{"a": 1, "a": 2}', "'a' twice"),
        ('{"a": {"b": 1, "b": "1"}}', "'b' twice"),
        ('{"a": 1', "not JSON"),
        ("{'a': (1, 2)}", "not JSON"),
        ('{"a":' * 100_000, "brackets"),
        ("x" * (MOST_CHARACTERS + 1), "characters"),
    ],
)
def test_what_nobody_can_have_meant_is_refused_with_a_reason(text: str, why: str) -> None:
    with pytest.raises(NotReadableError, match=why):
        read_object(text)


def test_the_first_object_counts() -> None:
    assert read_object('Like {"a": 1}, or rather {"a": 2}.') == {"a": 1}


@pytest.mark.parametrize(
    "text", ["{" * 50_000, "<think>" * 50_000, "```\n" * 50_000, '{"' * 50_000, "\\" * 50_000]
)
def test_no_flood_takes_long(text: str) -> None:
    begun = time.perf_counter()
    with pytest.raises(NotReadableError):
        read_object(text)
    assert time.perf_counter() - begun < 5.0


@given(st.text(max_size=300))
def test_words_of_strangers_become_one_printable_line(text: str) -> None:
    line = plain(text, 40)
    assert line.isprintable()
    assert len(line) <= 44
