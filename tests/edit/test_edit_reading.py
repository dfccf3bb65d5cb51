"""The reader of change requests: words, and the plan of changes that says what they ask for.

Rows are compared by meaning, so that any reader can be measured on them.
"""

import json
import re
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edit_truth import requests
from roadgpt.brief import SURE as SURE_ENOUGH
from roadgpt.brief.change import read_request
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.change.request import Change, EditRequest, Target
from roadgpt.errors import EditError
from tables import rows

TRAINING = Path(__file__).resolve().parents[2] / "training" / "data" / "changes" / "train"
RIGHT = 0.82
"""Share of all rows that must be read right; they were collected for an earlier reader."""
LEAST_REFUSED = 0.35
"""Share of the refusals among them that must be refused."""

SURE = rows(__file__, "sure") + rows(__file__, "parts")
"""Plain requests; each of them must be read right."""
TABLES = ("sure", "parts", "places", "amounts", "shapes", "additions", "several", "languages")

REVERSALS = rows(__file__, "reversals")

REORDERED = rows(__file__, "reordered")
"""Requests with words such as "reverse" and "swap" that are not for the road's direction."""

SWAPPED = [
    *rows(__file__, "swapped"),
    pytest.param(
        "scambia i due rettilinei",
        "straight all: swap",
        marks=pytest.mark.xfail(strict=True, reason="the networks do not know which two"),
    ),
]
"""Two turns or straights that change places, or exchange a value, some of which rules read or complete."""

HEIGHTS = rows(__file__, "heights")

ALONG = rows(__file__, "along")
"""Metres along the road, which are no heights."""

REFUSED = [*rows(__file__, "refused"), "x" * 7000]

ROWS = sorted(
    {
        *((words, plan) for name in TABLES for words, plan in rows(__file__, name)),
        *((words, "!") for words in REFUSED),
        *((row["request"], row["plan"]) for row in requests()),
    }
)


@pytest.mark.parametrize("words", REVERSALS)
def test_a_road_to_be_driven_the_other_way_is_reversed(words: str) -> None:
    assert read(words) == "road: reverse"


@pytest.mark.parametrize(("words", "plan"), REORDERED)
def test_other_exchanges_are_no_reversals(words: str, plan: str) -> None:
    assert meaning(read(words)) == meaning(plan)


@pytest.mark.parametrize(("words", "plan"), SWAPPED)
def test_turns_change_places(words: str, plan: str) -> None:
    assert read(words) == plan


@pytest.mark.parametrize(("words", "plan"), HEIGHTS)
def test_heights_are_climbs_with_the_sign_of_the_words(words: str, plan: str) -> None:
    assert read(words) == plan


@pytest.mark.parametrize(("words", "plan"), ALONG)
def test_metres_along_the_road_are_no_heights(words: str, plan: str) -> None:
    assert meaning(read(words)) == meaning(plan)


@pytest.mark.parametrize(
    "words",
    [
        "climb no more than 8 m",
        "climb at least 8 m",
        "let it climb for 20 m",  # along the road
    ],
)
def test_a_climb_that_the_words_do_not_give_is_doubted(words: str) -> None:
    assert read_request(words).confidence < SURE_ENOUGH


def read(words: str) -> str:
    """The plan that the reader makes of words, or '!' where it refuses them."""
    return answer(words)[0]


@cache
def answer(words: str) -> tuple[str, str]:
    """The plan; or '!' and what is said where words are refused."""
    try:
        return change_plan(read_request(words)), ""
    except EditError as error:
        return "!", str(error)


def meaning(plan: str) -> tuple[str, ...]:
    """The changes of a plan in one form each: plans that mean the same are the same then."""
    if plan == "!":
        return ()
    changes = [_plain(change) for change in read_change_plan(plan).changes]
    return tuple(sorted(change_plan(EditRequest("", (change,))) for change in changes))


def _plain(change: Change) -> Change:
    return replace(
        change,
        target=change.target and _target(change.target),
        to=None if change.to is None else round(change.to, 1),
        by=None if change.by is None else round(change.by, 1),
        times=None if change.times is None else round(change.times, 2),
    )


def _target(target: Target) -> Target:
    """'All' says nothing of places that are counted; 'turns 1 to 3 but turn 2' are turns 1 and 3."""
    but, numbers = target.but, {*target.numbers}
    if numbers and but and but == Target(target.noun, numbers=but.numbers, words=but.words):
        but, numbers = None, numbers - {*but.numbers}
    is_counted = bool(numbers) or target.most is not None or target.noun in ("road", "start", "end")
    every = target.every and not is_counted
    return replace(target, numbers=tuple(sorted(numbers)), but=but, every=every)


@pytest.mark.parametrize(("words", "plan"), SURE)
def test_plain_requests_are_read_right(words: str, plan: str) -> None:
    assert meaning(read(words)) == meaning(plan)


def test_requests_are_read_right() -> None:
    sample = ROWS[::10]
    wrong = [f"{words[:90]}: {read(words)} and not {plan}"
             for words, plan in sample if meaning(read(words)) != meaning(plan)]  # fmt: skip
    assert len(wrong) <= (1 - RIGHT) * len(sample), "\n".join(wrong)


def test_what_must_be_refused_is_refused() -> None:
    refused = [*REFUSED, *[words for words, plan in ROWS[::4] if plan == "!" and words not in REFUSED]]
    done = [f"{words}: {read(words)}" for words in refused if read(words) != "!"]
    assert len(done) <= (1 - LEAST_REFUSED) * len(refused), "\n".join(done)


def test_no_row_is_one_that_a_reader_is_trained_on() -> None:
    lines = [line for path in TRAINING.glob("*.jsonl") for line in path.read_text("utf-8").splitlines()]
    taught = {" ".join(re.findall(r"\w+", json.loads(line)["text"].lower())) for line in lines}
    assert len(taught) > 1000
    assert not taught & {" ".join(re.findall(r"\w+", words.lower())) for words, _ in ROWS}


def test_what_cannot_be_read_at_all_is_refused_with_the_reason() -> None:
    with pytest.raises(EditError, match="no change was asked for"):
        read_request("  ")
    with pytest.raises(EditError, match="7000 characters is too long"):
        read_request("x" * 7000)


@pytest.mark.parametrize(
    "words",
    [
        "don't make the second turn sharper",
        "mach die zweite Kurve nicht schärfer",
        "do not swap the radii of turns 1 and 2",
    ],
)
def test_a_denied_change_is_refused_or_doubted(words: str) -> None:
    try:
        request = read_request(words)
    except EditError:
        return
    assert request.confidence < SURE_ENOUGH


def test_words_that_are_not_understood_are_told() -> None:
    assert read_request("make the second turn sharper pronto").unused == ("pronto",)


few = settings(max_examples=12, deadline=None)


@few
@given(st.text(max_size=60))
def test_any_text_is_read_or_refused(words: str) -> None:
    with suppress(EditError):
        assert read_request(words).changes


@pytest.mark.parametrize(
    ("words", "plan"),
    rows(__file__, "wishes_that_are_made_one_after_the_other"),
)
def test_wishes_that_are_made_one_after_the_other(words: str, plan: str) -> None:
    assert meaning(read(words)) == meaning(plan)
