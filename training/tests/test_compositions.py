"""Composed pairs: sensible, seeded, and their plans say what a slow reading of the text counts."""

import re
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from roadgpt.brief.feasible import check
from roadgpt.brief.normal import turns_of
from roadgpt.brief.plan import plan, read_plan
from roadgpt_training.compositions import WAYS, composed
from roadgpt_training.compositions.counted import numbered_sides, ranged, sided_sum
from roadgpt_training.compositions.in_a_row import spaced_turns
from roadgpt_training.compositions.limits import limited
from roadgpt_training.compositions.voice import ORDINALS, Composition, Voice

ADJECTIVES = "(?:alternating|left|right|sharp|tight|gentle|easy)"
Way = Callable[[Voice], Composition]


def many(way: Way, number: int = 400) -> Iterator[Composition]:
    """Said by voices that write digits, so that these tests need not read number words."""
    for seed in range(number):
        voice = Voice(np.random.default_rng(seed))
        voice.spells = False
        yield way(voice)


def numbers(text: str) -> list[int]:
    """All bare numbers of a text, purposes left out."""
    return [
        int(number) for number in re.findall(r"(?<![\w.])\d+(?!\w|\.\d)", text.replace("test case 12", ""))
    ]


def sides(plan: str) -> list[str | None]:
    return [clause.side for clause in read_plan(plan).clauses for _ in range(int(clause.count.lo or 0))]


def test_the_same_seed_gives_the_same_pairs() -> None:
    one, again = ([composed(np.random.default_rng(seed)) for seed in range(60)] for _ in range(2))
    assert one == again


def test_nearly_all_pairs_make_a_road_and_are_written_in_one_way() -> None:
    rng = np.random.default_rng(1)
    found = [composed(rng) for _ in range(300)]
    kept = [said for said in found if said]
    assert len(kept) > 0.95 * len(found)
    briefs = [read_plan(said.plan) for said in kept]
    assert all(plan(brief) == said.plan for brief, said in zip(briefs, kept, strict=True))
    assert all(check(brief, map_size=None) is None for brief in briefs)
    assert len({said.text for said in kept}) > 0.98 * len(kept)


@pytest.mark.parametrize("way", [way for way, _ in WAYS])
def test_every_way_writes_plans_that_can_be_read(way: Way) -> None:
    for said in many(way, 100):
        assert read_plan(said.plan)
        assert "{" not in said.text


def test_the_straights_kept_between_are_one_fewer_than_the_turns() -> None:
    for said in many(spaced_turns):
        brief = read_plan(said.plan)
        turns = sum(turns_of(clause)[0] for clause in brief.clauses if clause.kind != "straight")
        straights = sum(clause.kind == "straight" for clause in brief.clauses)
        number = re.search(rf"(\d+) (?:{ADJECTIVES} )*(?:turns|bends|curves|corners|hairpins)", said.text)
        if number:
            assert turns == int(number[1]), said
        is_around = re.search(r"\b(after|behind|followed|following|preceded|before|ahead)\b", said.text)
        assert straights == (turns if is_around else turns - 1), said


def test_sides_said_by_ordinal_stand_where_the_ordinal_says() -> None:
    seen = 0
    for said in many(numbered_sides):
        found = re.search(
            r"the (\w+) (?:one )?(?:goes|turns|is|bends)(?: to the)? (left|right)", said.text.lower()
        )
        if found and found[1] in ORDINALS:
            seen += 1
            its = sides(said.plan)
            assert its[ORDINALS.index(found[1])] == found[2], said
            assert its.count(found[2]) == 1, said
    assert seen > 20


def test_sums_of_sides_are_the_total() -> None:
    for said in many(sided_sum):
        brief = read_plan(said.plan)
        its = numbers(said.text)
        if brief.turns and brief.left and brief.right:
            assert [brief.turns.lo, {brief.left.lo, brief.right.lo}] == [its[0], {*its[1:3]}], said
        else:
            assert len(sides(said.plan)) == its[0] == sum(its[1:3]), said


def test_a_turn_told_apart_counts_among_the_range() -> None:
    for said in many(ranged):
        brief = read_plan(said.plan)
        low, high = numbers(said.text)[:2]
        if "fewer than" in said.text or ("more than" in said.text and "not more than" not in said.text):
            low, high = min(low, high) + 1, max(low, high) - 1
        counts = [clause.count for clause in brief.clauses]
        asked = brief.turns or counts[0].model_copy(
            update={"lo": sum(c.lo or 0 for c in counts), "hi": sum(c.hi or 0 for c in counts)}
        )
        assert (asked.lo, asked.hi) == (low, high), said


def test_every_number_of_a_limit_is_in_its_plan() -> None:
    for said in many(limited):
        for number in re.findall(r"\d{2,3}", said.text.replace("test case 12", "")):
            assert re.search(rf"(?<!\d){number}(?!\d)", said.plan), said
