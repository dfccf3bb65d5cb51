"""Plans as users write them: in short forms, with things beside the road, with refusals."""

from pathlib import Path

import pytest

from roadgpt.brief import AnotherRoadError, read, remarks
from roadgpt.brief.beside import BESIDE, NOT_BUILT, SAID_OTHERWISE
from roadgpt.brief.model import Amount, Brief, Clause, exactly
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.plan import PlanReader
from roadgpt.brief.refusal import BEYOND, CLASHING
from roadgpt.design.room import world_for, world_remarks
from roadgpt.errors import BriefError
from roadgpt.road import World

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "plans.md"


def examples(language: str) -> list[str]:
    """The lines of the page's fenced blocks of one language."""
    text = PAGE.read_text(encoding="utf-8")
    blocks = text.split(f"```{language}\n")[1:]
    return [line for block in blocks for line in block.split("```")[0].splitlines()]


def test_a_number_without_a_key_is_the_angle_of_a_turn_and_the_length_of_a_straight() -> None:
    brief = read_plan("turn left 90 r30; straight 40..60; crest 60; hairpin 170 r..20")
    assert brief.clauses == (
        Clause(kind="turn", side="left", degrees=exactly(90), radius=exactly(30)),
        Clause(kind="straight", length=Amount(lo=40, hi=60)),
        Clause(kind="crest", length=exactly(60)),
        Clause(kind="hairpin", degrees=exactly(170), radius=Amount(hi=20)),
    )


def test_things_beside_the_road_are_kept_and_told_by_name() -> None:
    brief = read_plan("turn | hard beside(roundabout, wet)")
    assert brief.beside == ("roundabout", "wet")
    assert read_plan(plan(brief)) == brief
    assert remarks(brief, 250) == (
        "a roundabout is built as a part of a route, such as 'a roundabout, second exit'; the road is made"
        " without it",
        "the words say 'wet': friction is 0.6",
    )
    assert Brief.model_validate_json(brief.model_dump_json()) == brief


class OfARoundabout:
    """A reader that knows no routes: it reads a turn, a roundabout beside it, and rain."""

    def read(self, words: str) -> Brief:
        return Brief(words=words, clauses=(Clause(kind="turn"),), beside=("roundabout", "rain"))


def test_what_is_no_single_road_is_asked_about(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roadgpt.brief.reader_of", lambda name, chat: OfARoundabout())
    with pytest.raises(AnotherRoadError) as refusal:
        read("a turn, then a roundabout, in the rain", "model")
    assert str(refusal.value).startswith(
        "it is not clear where a roundabout should be; say it in driving order, such as 'a roundabout, "
        "second exit'; the road without it: --plan"
    )
    assert refusal.value.plan == "turn | beside(rain)"
    assert read(refusal.value.plan, "plan").beside == ("roundabout", "rain")  # a plan is built as it stands


def test_every_name_of_the_language_has_a_remark_and_stands_on_the_page() -> None:
    text = PAGE.read_text(encoding="utf-8")
    words = {word for part in text.split("`")[1::2] for word in part.split()}
    assert not NOT_BUILT.keys() & SAID_OTHERWISE.keys()
    assert not {*BESIDE, *CLASHING, *BEYOND} - words
    for name in BESIDE:
        told = remarks(brief := Brief(beside=(name,)), 250)
        told = told or world_remarks(brief, World(), world_for(brief, World()))
        assert len(told[0]) > 20


@pytest.mark.parametrize("line", examples("plan"))
def test_the_plans_of_the_page_are_plans(line: str) -> None:
    brief = PlanReader().read(line)
    assert read_plan(plan(brief)).model_copy(update={"words": line}) == brief


@pytest.mark.parametrize("line", examples("refusal"))
def test_the_refusals_of_the_page_are_refusals(line: str) -> None:
    with pytest.raises(BriefError) as refusal:
        PlanReader().read(line)
    assert "has no refusal" not in str(refusal.value)
