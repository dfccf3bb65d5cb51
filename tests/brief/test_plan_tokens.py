"""Tokens of change requests and refusals: what the network may write can be read, and nothing gets lost."""

import json
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from random_plans import random_plan
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.grammar import (
    END,
    Numbers,
    PlanAutomaton,
    Symbol,
    any_change,
    change_request,
)
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.vocabulary import NUMBER_OF, change_of, plan_of
from roadgpt.brief.refusal import refused
from roadgpt.errors import EditError
from roadgpt_training.tokens import tokens_of
from tables import rows as table_rows

DATA = Path(__file__).resolve().parents[2] / "training" / "data" / "changes"
CHANGES = sorted(path for name in ("train", "validation") for path in (DATA / name).glob("*.jsonl"))
OF_SCENES = sorted(DATA.glob("scenes*/*.jsonl"))


def normal(line: str) -> str:
    """A plan of changes in the form in which it is printed."""
    return line if line.startswith("!") else change_plan(read_change_plan(line))


@pytest.mark.parametrize(
    ("paths", "every", "whole"), [(CHANGES, 120, change_request), (OF_SCENES, 12, any_change)]
)
def test_plans_of_changes_survive_being_cut_into_tokens(
    paths: Sequence[Path], every: int, whole: Callable[[Numbers], Symbol]
) -> None:
    """Nearly all: a few labels have a number that the text does not have, such as a sum."""
    lines = [line for path in paths for line in path.read_text(encoding="utf-8").splitlines()[::every]]
    cut, written = 0, 0
    for row in map(json.loads, lines):
        text = slotted(row["text"], is_change=True)
        tokens = tokens_of(normal(row["plan"]), text.slots, is_change=True)
        if tokens is None:
            continue
        cut += 1
        assert normal(change_of(tokens, text.slots)) == normal(row["plan"]), row
        writer = PlanAutomaton(text.slots, frozenset(word.text for word in text.words), whole=whole)
        for token in (*tokens, END):
            if NUMBER_OF[token] not in writer.allowed():
                break
            writer.push(token)
        else:
            written += 1
    assert cut >= 0.99 * len(lines)  # so that one file alone would be noticed
    assert written >= 0.99 * len(lines)


@given(
    st.integers(0, 10_000), st.lists(st.floats(1, 140).map(lambda x: round(x, 1)), max_size=5), st.booleans()
)
def test_whatever_the_network_may_write_of_changes_can_be_read(
    seed: int, values: list[float], is_change: bool
) -> None:
    line = random_plan(seed, values, is_change)
    if line.startswith("!"):
        assert "has no refusal" not in str(refused(line))
    elif line and is_change:
        try:
            read = normal(line)
        except EditError as error:  # what a place must be for a wish is no matter of grammar
            if not re.search("which part climbs|only the whole road", str(error)):
                raise
        else:
            assert normal(read) == read


@pytest.mark.parametrize(("line", "text", "again"), table_rows(__file__, "amounts_changes_copied"))
def test_amounts_of_changes_are_copied_from_the_text(line: str, text: str, again: str) -> None:
    slots = slotted(text, is_change=True).slots
    tokens = tokens_of(line, slots)
    assert tokens is not None
    assert normal(plan_of(tokens, slots)) == again


@pytest.mark.parametrize(("line", "tokens"), table_rows(__file__, "token_order_reverses"))
def test_the_token_for_order_reverses_a_road_and_swaps_what_lies_on_it(line: str, tokens: str) -> None:
    found = tokens_of(line, ())
    assert found == tokens.split()
    assert plan_of(found, ()).replace(" ", "") == line.replace(" ", "")


@pytest.mark.parametrize(("line", "text"), table_rows(__file__, "network_can_write"))
def test_the_network_can_write_the_signs_and_the_ways_of_a_map(line: str, text: str) -> None:
    said = slotted(text)
    tokens = tokens_of(line, said.slots)
    assert tokens is not None
    assert plan_of(tokens, said.slots) == plan(read_plan(line)) == line
    writer = PlanAutomaton(said.slots, frozenset(word.text for word in said.words))
    for token in (*tokens, END):
        assert NUMBER_OF[token] in writer.allowed()
        writer.push(token)
