"""Tokens of change requests and refusals: what the network may write can be read, and nothing gets lost."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from random_plans import random_plan
from roadgpt.brief.beside import BESIDE
from roadgpt.brief.change import parser as language
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.plan_automaton import END, PlanAutomaton
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.token_grammar import allowed, in_order, list_tail, one_of, pushed, sequel
from roadgpt.brief.readers.model.vocabulary import NUMBER_OF, TOKENS, plan_of, tokens_of
from roadgpt.brief.refusal import OF_CAUSES, refused

CHANGES = sorted((Path(__file__).resolve().parents[2] / "data" / "changes").rglob("*.jsonl"))


def normal(line: str) -> str:
    """A plan of changes in the form in which it is printed."""
    return line if line.startswith("!") else change_plan(read_change_plan(line))


@pytest.mark.parametrize("path", CHANGES, ids=lambda path: path.stem)
def test_plans_of_changes_survive_being_cut_into_tokens(path: Path) -> None:
    """Nearly all: a few labels have a number that the text does not have, such as a sum."""
    whole, cut, written = 0, 0, 0
    for line in path.read_text(encoding="utf-8").splitlines():
        row = json.loads(line)
        text = slotted(row["text"], is_change=True)
        tokens = tokens_of(normal(row["plan"]), text.slots)
        whole += 1
        if tokens is None:
            continue
        cut += 1
        assert normal(plan_of(tokens, text.slots)) == normal(row["plan"]), row
        writer = PlanAutomaton(text.slots, frozenset(word.text for word in text.words), is_change=True)
        for token in (*tokens, END):
            if NUMBER_OF[token] not in writer.allowed():
                break
            writer.push(token)
        else:
            written += 1
    assert cut >= 0.96 * whole
    assert written >= 0.95 * whole


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
        assert normal(normal(line)) == normal(line)


@pytest.mark.parametrize(
    ("line", "text", "again"),
    [
        ("turn 2: radius x0.7", "turn 2, 30 % tighter", "turn 2: radius x0.7"),
        ("turn 2: radius x1.1", "widen turn 2 by 10 %", "turn 2: radius x1.1"),
        ("straight 1: length x0.8", "to 80 % of its length", "straight 1: length x0.8"),
        ("straight -1: length x1.333", "a third longer", "straight -1: length x1.333"),
        ("turn 1,3: slope up =5", "turns 1 and 3 uphill at 5 %", "turn 1,3: slope up =5"),
        (
            "add turn right deg=60 r=25 at_end",
            "a right, 60 degrees, 25 m",
            "add turn right deg=60 r=25 at_end",
        ),
    ],
)
def test_amounts_of_changes_are_copied_from_the_text(line: str, text: str, again: str) -> None:
    slots = slotted(text, is_change=True).slots
    tokens = tokens_of(line, slots)
    assert tokens is not None
    assert normal(plan_of(tokens, slots)) == again


def test_a_factor_that_the_text_does_not_have_has_no_token() -> None:
    assert tokens_of("turn 2: radius x0.37", slotted("turn 2 tighter", is_change=True).slots) is None


def test_a_change_request_is_told_from_a_description_by_its_mark() -> None:
    assert slotted("turn 2 sharper", is_change=True).is_change
    assert not slotted("turn 2 sharper").is_change
    assert not slotted("[unused13] turn 2 sharper").is_change  # a person typed the mark


def test_a_grammar_allows_each_part_once_in_its_order() -> None:
    stack = (
        in_order(one_of("a"), sequel(one_of("b"), one_of("c")), one_of("d"), least=1),
        one_of("end"),
    )
    assert allowed(stack) == ["a", "b", "d"]  # nothing can be left out yet
    stack = pushed(stack, "b")
    assert allowed(stack) == ["c"]
    stack = pushed(stack, "c")
    assert allowed(stack) == ["d", "end"]
    with pytest.raises(ValueError, match="'a' cannot stand here"):
        pushed(stack, "a")


def test_a_list_of_a_grammar_ends_when_it_is_full() -> None:
    stack = (list_tail(",", one_of("x"), 2), one_of("end"))
    for token in (",", "x", ",", "x"):
        stack = pushed(stack, token)
    assert allowed(stack) == ["end"]


def test_every_name_and_cause_has_a_token() -> None:
    named = {*BESIDE, *OF_CAUSES["!contradiction"], *OF_CAUSES["!impossible"]}
    assert named <= {*TOKENS}
    assert len({*TOKENS}) == len(TOKENS)


def test_the_network_has_a_token_for_every_word_of_changes() -> None:
    words = {
        *language.NOUNS,
        *language.KINDS,
        *language.OF_TARGETS,
        *language.OF_NEW,
    }
    words |= {
        *language.ENDS,
        *language.MEASURES,
        *language.ALONE,
        *language.DOSES,
        *language.WAYS,
    }
    words |= {f"{word}(" for word in (*language.POSITIONS, "but")}
    words |= {f"{word}=" for word in language.NUMBERS}
    assert words - {*TOKENS} == {"reverse", "swap"}  # both are the token "order"


@pytest.mark.parametrize(
    ("line", "tokens"),
    [
        ("road: reverse", "road : order"),
        ("turn 1,-1: swap", "turn 1 - 1 : order"),
        ("straight all but(straight 1,-1): swap", "straight all but( straight 1 - 1 ) : order"),
        ("turn 2: angle more; turn 1,3: swap", "turn 2 : angle more ; turn 1 3 : order"),
        ("turn 2: mirror; road: reverse", "turn 2 : mirror ; road : order"),
    ],
)
def test_the_token_for_order_reverses_a_road_and_swaps_what_lies_on_it(line: str, tokens: str) -> None:
    found = tokens_of(line, ())
    assert found == tokens.split()
    assert plan_of(found, ()).replace(" ", "") == line.replace(" ", "")


def test_a_contradiction_about_the_order_keeps_its_name() -> None:
    assert plan_of(tokens_of("!contradiction order", ()) or (), ()) == "!contradiction order"


def test_a_cause_that_is_written_twice_is_said_once() -> None:
    assert str(refused("!contradiction turns turns")) == str(refused("!contradiction turns"))


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("map columns=2 rows=3 route=left+right+straight+left", "a grid of 2 by 3 blocks"),
        ("map columns=2 rows=3; junction x2 lights", "a grid of 2 by 3 blocks, lights at 2 junctions"),
        (
            "map columns=2 rows=3 len=120 dead_ends=4 stop route=left; junction none || left_hand",
            "2 by 3, 120 m, 4",
        ),
        ("map crossroads x2 lights; crossroads x3 none", "2 crossroads with lights and 3 without signs"),
        ("map t_junction blocks=1 dead_ends=1 route=straight+straight", "a loop with one road into it"),
        ("map t_junction x2; roundabout || len=900", "2 T-junctions and a roundabout, 900 m of streets"),
    ],
)
def test_the_network_can_write_the_signs_and_the_ways_of_a_map(line: str, text: str) -> None:
    said = slotted(text)
    tokens = tokens_of(line, said.slots)
    assert tokens is not None
    assert plan_of(tokens, said.slots) == plan(read_plan(line)) == line
    writer = PlanAutomaton(said.slots, frozenset(word.text for word in said.words))
    for token in (*tokens, END):
        assert NUMBER_OF[token] in writer.allowed()
        writer.push(token)
