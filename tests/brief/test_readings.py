"""Tables: what is read in words, which numbers they have, how plans are said, and why plans are refused."""

import json
from pathlib import Path
from typing import Any

import pytest

from roadgpt.brief import normal, read, sentence
from roadgpt.brief.expressions import said_map_size, says_left_hand
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.before import negative_number
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError

Row = dict[str, Any]


def rows(name: str) -> list[Row]:
    """The rows of a table beside this file."""
    text = Path(__file__).with_name(f"{name}.jsonl").read_text(encoding="utf-8")
    return [json.loads(line) for line in text.splitlines()]


def name_of(row: Row) -> str:
    return f"{row['why']}: {row.get('words', row.get('plan'))[:40]}"


def param_of(row: Row) -> Any:
    """A row, which is expected to fail where the present networks are known to miss it."""
    why = "the networks of 30 November 2026 miss it; those before them did not"
    marks = [pytest.mark.xfail(reason=why, strict=True)] if row.get("is_missed") else []
    return pytest.param(row, id=name_of(row), marks=marks)


@pytest.mark.parametrize("row", [*map(param_of, rows("readings"))])
def test_words_are_read_as_they_are_meant(row: Row) -> None:
    assert plan(normal(read(row["words"]))) == plan(normal(read_plan(row["plan"])))


@pytest.mark.parametrize("row", rows("numbers"), ids=name_of)
def test_numbers_in_words_have_their_values_and_units(row: Row) -> None:
    found = slotted(row["words"])
    values, units = [slot.value for slot in found.slots], [slot.unit for slot in found.slots]
    assert row.get("text", found.text) == found.text
    assert row.get("values", values) == values
    assert row.get("units", units) == units
    slots = [[*slot] for slot in zip(values, units, strict=True)]
    assert row.get("slots", slots) == slots


@pytest.mark.parametrize("row", rows("heard"), ids=name_of)
def test_words_ask_for_traffic_on_the_left_a_size_of_the_map_or_less_than_nothing(row: Row) -> None:
    words = row["words"]
    assert row.get("left_hand", says_left_hand(words)) == says_left_hand(words)
    assert "map" not in row or row["map"] == [*(said_map_size(words) or ())]
    assert "below" not in row or row["below"] == negative_number(slotted(words))


@pytest.mark.parametrize("row", rows("said"), ids=name_of)
def test_plans_are_said_in_sentences(row: Row) -> None:
    said = sentence(read_plan(row["plan"]))
    assert row.get("sentence", said) == said
    assert row.get("part", "") in said


@pytest.mark.parametrize("row", rows("refused"), ids=name_of)
def test_plans_that_cannot_be_are_refused_in_one_line(row: Row) -> None:
    with pytest.raises(BriefError, match=row["reason"]) as refusal:
        read(row["plan"], "plan")
    assert "\n" not in str(refusal.value)


def test_a_road_of_which_only_the_traffic_is_said_has_it() -> None:
    assert read("left-hand traffic").left_hand
