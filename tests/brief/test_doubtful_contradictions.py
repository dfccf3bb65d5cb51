"""Descriptions that look like contradictions: what can be built is read with a doubt, the rest is refused."""

import pytest

from roadgpt.brief import Brief, read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.plan_choice import agrees_with_numbers
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.refusal import ContradictionError
from roadgpt.brief.words import SURE
from roadgpt.errors import BriefError

HONEST = [
    ("Nur bergauf, nirgends bergab, und kaum mehr als 3 % steil.", "| up turns=1.. steepest=..3", 0.5),
    (
        "Tres curvas y ni una más: izquierda de 100 grados como mínimo, derecha de 40 como máximo, izquierda"
        " de entre 50 y 60.",
        "turn left deg=100..; turn right deg=..40; turn left deg=50..60",
        SURE - 0.001,  # the networks no longer take it for a contradiction, but they are not sure
    ),
]
LEARNT = [
    ("Bitte eine ebene Strecke ohne Rechtskurven, dafür mit drei Linkskurven.", "turn x3 left | flat"),
    (
        "Two left-handers, both level; only the 80 m straight between them climbs, at around 6 %, and nothing"
        " else slopes.",
        "turn left flat; straight up len=80 pct=6; turn left flat",
    ),
    (
        "Downhill all the way. Or rather, uphill all the way, but never steeper than 6 percent, and with two"
        " turns.",
        "turn x2 | up steepest=..6",
    ),
]


@pytest.mark.parametrize(("words", "meant", "most"), HONEST)
def test_what_only_looks_like_a_contradiction_is_read_with_a_doubt(
    words: str, meant: str, most: float
) -> None:
    brief = read(words)
    assert plan(brief) == meant
    assert brief.confidence <= most


def test_a_denial_that_says_the_same_again_is_no_contradiction() -> None:
    words = "Zwei Kurven und die ganze Zeit nur rauf, runter geht's nirgends."
    assert plan(read(words)) == "turn x2 | up"


@pytest.mark.parametrize(("words", "meant"), LEARNT)
def test_denials_and_corrections_that_the_networks_have_learnt_leave_no_doubt(words: str, meant: str) -> None:
    brief = read(words)
    assert plan(brief) == meant
    assert brief.confidence >= SURE


@pytest.mark.parametrize(
    "words",
    [
        "Four curves, all to the left, two of them to the right.",
        "Eine durchgehend ebene Straße ohne jedes Gefälle, die am Ende 10 m höher liegt als am Anfang.",
        "I need five turns, all of them to the right, and the third one goes to the left.",
        "Cuatro curvas, pero ninguna a la izquierda y ninguna a la derecha.",
    ],
)
def test_real_contradictions_are_refused_with_what_may_be_meant(words: str) -> None:
    with pytest.raises(ContradictionError, match=r"contradicts itself about .*; or is this meant: --plan"):
        read(words)


def test_a_real_contradiction_for_which_no_plan_is_likely_is_refused() -> None:
    with pytest.raises(BriefError, match="contradicts itself about the number of turns"):
        read("A road with exactly two turns: three to the left and one to the right.")


CLASHES = [
    "roundabout right arms=3 exit=5",
    "| lanes=4 // lane_drop // | lanes=5",
    "turn left r=200 sharp",
    "| lanes=9",
    "| oneway centre=solid",
    "crossroads left arms=5",
]


@pytest.mark.parametrize("line", CLASHES)
def test_a_plan_of_the_reader_that_contradicts_itself_is_a_doubt_of_the_program(
    line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(BriefError) as own:
        read(line, "plan")
    _reads(monkeypatch, line, 0.95)
    with pytest.raises(BriefError, match=r"^I read this, perhaps wrongly, as '.+': ") as refusal:
        read("a quiet road")
    what, advice = str(own.value).split("; ")
    assert str(refusal.value).endswith(f"': {what}; say it in other words")
    assert advice not in str(refusal.value)


@pytest.mark.parametrize(("confidence", "is_doubted"), [(0.95, False), (SURE - 0.01, True)])
def test_a_number_out_of_range_is_doubted_if_the_reading_is(
    confidence: float, is_doubted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    _reads(monkeypatch, "turn left deg=300", confidence)
    with pytest.raises(BriefError, match="a turn of 300 degrees would cross itself") as refusal:
        read("a turn")
    assert ("perhaps wrongly" in str(refusal.value)) is is_doubted
    assert ("ask for 240 or less" in str(refusal.value)) is not is_doubted


def _reads(monkeypatch: pytest.MonkeyPatch, line: str, confidence: float) -> None:
    """Lets the reader of words read this plan in everything."""

    class Misreader:
        def read(self, words: str) -> Brief:
            return read_plan(line).model_copy(update={"words": words, "confidence": confidence})

    monkeypatch.setattr("roadgpt.brief.reader_of", lambda *_: Misreader())


@pytest.mark.parametrize(
    ("words", "tokens", "line", "agrees"),
    [
        ("three turns, each with a radius of 30 m", ["turn", "x3", "|", "r=", "[1]"], "turn x3 | r=30", True),
        ("three turns, each with a radius of 30 m", ["turn", "x3"], "turn x3", False),
        (
            "4 turns: 2 left and 1 right",
            ["turn", "x2", "left", ";", "turn", "right"],
            "turn x2 left; turn right",
            False,
        ),
    ],
)
def test_a_plan_agrees_with_the_numbers_in_the_words(
    words: str, tokens: list[str], line: str, agrees: bool
) -> None:
    draft = ScoredPlan(tuple(tokens), line, 0.0, (), agreement=0.0)
    assert agrees_with_numbers(draft, slotted(words)) is agrees
