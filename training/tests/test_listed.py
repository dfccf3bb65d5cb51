"""Lists of turns: possible roads whose plans say what the list says by place, in five languages."""

import re
from collections.abc import Iterator
from functools import cache
from itertools import islice

import numpy as np
import pytest

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Clause
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.slots import slotted
from roadgpt_training.compositions import SHARES, WAYS, composed
from roadgpt_training.compositions.listed import listed
from roadgpt_training.compositions.voice import Composition, Voice
from roadgpt_training.data import with_shared_values
from roadgpt_training.generator import pairs
from roadgpt_training.noise import tidy
from roadgpt_training.tokens import tokens_of
from tables import rows as table_rows

LANGUAGES = ("en", "de", "fr", "es", "it")
NUMBER = 160
LEFT = {"en": "left l", "de": "links l", "fr": "gauche g", "es": "izquierda i", "it": "sinistra s sx"}
RIGHT = {"en": "right r", "de": "rechts r", "fr": "droite d", "es": "derecha d", "it": "destra d dx"}
FILLERS = dict(table_rows(__file__, "fillers"))
THIRD = dict(table_rows(__file__, "third"))


def said(language: str, number: int = NUMBER, *, spells: bool | None = False) -> Iterator[Composition]:
    """Lists of turns by voices that write digits, write words, or (None) do as they like."""
    for seed in range(number):
        voice = Voice(np.random.default_rng([seed, 77]), language)
        voice.spells = voice.spells if spells is None else spells
        text, plan = listed(voice)
        yield Composition(tidy(text, language), plan)


@cache
def written(language: str) -> tuple[Composition, ...]:
    return tuple(said(language))


def turns(plan: str) -> list[Clause]:
    """Every turn of a plan, one by one."""
    found = [clause for clause in read_plan(plan).clauses if clause.kind != "straight"]
    return [clause for clause in found for _ in range(int(clause.count.lo or 0))]


def sides(part: str, language: str) -> str:
    """The sides that a part of a text lists as letters 'l' and 'r'; '' if it says anything else."""
    sided = dict.fromkeys(LEFT[language].split(), "l") | dict.fromkeys(RIGHT[language].split(), "r")
    if re.search(r"\b[2-9] ", part):  # a count, as in "2 lefts"
        return ""
    part = re.sub(r"\br ?\d+|\bR=\d+|ligne droite", "", part).lower()  # radii, and what is not on the right
    words = re.findall(r"[^\W\d_]+", part)
    if len(words) == 1 and {*words[0]} <= {word for word in sided if len(word) == 1}:
        words = list(words[0])
    if not {*words} <= {*sided, *FILLERS[language].split()}:
        return ""
    return "".join(sided[word] for word in words if word in sided)


def test_the_same_seed_gives_the_same_lists() -> None:
    one, again = ([composed(np.random.default_rng(seed), "fr") for seed in range(60)] for _ in range(2))
    assert one == again


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_list_makes_a_possible_road_of_three_to_nine_turns(language: str) -> None:
    assert len({each.text for each in written(language)}) > 0.98 * NUMBER
    for each in (*written(language), *said(language, spells=True)):
        assert not re.search(r"[{}|\[\]]|  ", each.text), each
        check(read_plan(each.plan), map_size=None)
        assert 3 <= len(turns(each.plan)) <= 9, each


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_sides_of_the_text_in_order_are_those_of_the_plan(language: str) -> None:
    seen = 0
    for each in written(language):
        for part in re.split(r"[.;:] |[()]", each.text):
            listed_sides = sides(part, language)
            if len(listed_sides) > 2:
                seen += 1
                assert listed_sides == "".join((turn.side or "?")[0] for turn in turns(each.plan)), each
    assert seen > 35


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_figures_of_the_text_are_those_of_the_plan(language: str) -> None:
    for each in written(language):
        in_text, in_plan = (
            {int(digits) for digits in re.findall(r"\d+", line) if int(digits) > 20} for line in each
        )
        assert in_text == in_plan, each


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_figures_of_a_row_stand_in_its_order(language: str) -> None:
    seen = 0
    for each in said(language, 300):
        its = turns(each.plan)
        rows = [
            [turn.degrees.lo if turn.degrees else None for turn in its],
            [turn.radius.lo if turn.radius else None for turn in its],
            [clause.length.lo for clause in read_plan(each.plan).clauses if clause.length],
        ]
        for match in re.findall(r"\d+(?:/\d+)+", each.text):
            row = [float(value) for value in match.split("/")]
            seen += 1
            assert any(row == other[: len(row)] or row == other[1 : len(row) + 1] for other in rows), each
    assert seen > 2


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_hairpin_told_by_its_place_is_there(language: str) -> None:
    third = re.compile(THIRD[language], re.IGNORECASE)
    found = [*islice((each for each in said(language, 2500) if third.search(each.text)), 3)]
    assert len(found) == 3
    assert all(turns(each.plan)[2].kind == "hairpin" for each in found), found


def test_a_gap_between_any_two_turns_is_one_fewer_than_the_turns() -> None:
    found = [*islice((each for each in said("en", 1500) if "between any two" in each.text), 15)]
    assert len(found) == 15
    for each in found:
        kinds = [clause.kind for clause in read_plan(each.plan).clauses]
        inner = "".join("s" if kind == "straight" else "t" for kind in kinds).strip("s")
        assert inner.count("s") == len(turns(each.plan)) - 1, each


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_number_of_a_list_can_be_copied(language: str) -> None:
    lost = 0
    for each in said(language, spells=None):
        slots = slotted(each.text).slots
        lost += tokens_of(with_shared_values(each.plan, slots), slots) is None
    assert lost < 0.01 * NUMBER


def test_a_quarter_of_the_compositions_are_lists_and_every_language_has_some() -> None:
    shares = dict(WAYS)
    assert shares[listed] / SHARES[-1] == pytest.approx(0.25, abs=0.02)
    series = pairs(4)
    families = {next(series).family for _ in range(600)}
    assert families >= {f"composed-{language}" for language in LANGUAGES}
