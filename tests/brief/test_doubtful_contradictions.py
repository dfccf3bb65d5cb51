"""Descriptions that contradict themselves or look like it, and plans that do."""

import pytest

from roadgpt.brief import Brief, read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.refusal import ContradictionError
from roadgpt.brief.words import SURE
from roadgpt.errors import BriefError
from tables import rows

LEARNT = rows(__file__, "learnt")


@pytest.mark.parametrize(("words", "meant"), LEARNT)
def test_denials_and_corrections_that_the_networks_have_learnt_leave_no_doubt(words: str, meant: str) -> None:
    brief = read(words)
    assert plan(brief) == meant
    assert brief.confidence >= SURE


@pytest.mark.parametrize("words", rows(__file__, "real_contradictions_refused"))
def test_real_contradictions_are_refused_with_what_may_be_meant(words: str) -> None:
    with pytest.raises(ContradictionError, match=r"contradicts itself about .*; or is this meant: --plan"):
        read(words)


CLASHES = rows(__file__, "clashes")


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
