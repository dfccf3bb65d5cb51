"""Words of colours, names and idioms are no weather, light, land or side of traffic, and a refusal gives only
reasons that the words tell."""

import re

import pytest

from roadgpt.brief import exactly, read
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.plan import plan
from roadgpt.errors import BriefError, RoadGPTError
from tables import rows

CONDITIONS = re.compile(
    r"\b(?:night|low_sun|fog|rain|wet|snow|ice|left_hand|lake|river|coast|forest|town|bridge|tunnel|valley|ridge|"
    r"tree_lined|mountain|hilly|rolling|hills)\b"
)


def answer(words: str, reader: str = "model") -> str:
    """The plan that is read, or the sentence of the refusal."""
    try:
        return plan(read(words, reader))
    except RoadGPTError as error:
        return str(error)


@pytest.mark.parametrize("words", rows(__file__, "asides"))
def test_what_is_said_aside_is_no_condition(words: str) -> None:
    brief = read(words)
    assert not CONDITIONS.findall(plan(brief))
    assert brief.words == words


@pytest.mark.parametrize(("words", "condition"), rows(__file__, "told"))
def test_conditions_that_are_told_stay(words: str, condition: str) -> None:
    assert condition in CONDITIONS.findall(plan(read(words)))


@pytest.mark.parametrize(("words", "reason"), rows(__file__, "unknown_reasons"))
def test_a_reason_that_no_word_tells_is_not_given(words: str, reason: str) -> None:
    assert not re.search(reason, answer(words))


@pytest.mark.parametrize(("words", "reason"), rows(__file__, "known_reasons"))
def test_a_reason_that_a_word_tells_is_given(words: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        read(words)


@pytest.mark.parametrize("number", ["9" * 309, "9" * 5000, "1e999", "0." + "3" * 5000])
@pytest.mark.parametrize("form", ["a road with {} turns", "a map of {} m by {} m with two turns", "turn {}"])
def test_numbers_of_any_length_are_read_or_refused_in_one_sentence(form: str, number: str) -> None:
    words = form.replace("{}", number)
    assert len(answer(words)) < 400
    assert len(answer(words, "plan")) < 400


def test_changes_with_numbers_of_any_length_are_read() -> None:
    assert read_change_plan(f"road: length ={'9' * 309}")


@pytest.mark.parametrize("share", [50, 75, 100])
def test_an_overlap_is_read(share: int) -> None:
    brief = read(f"VUT at 45 km/h towards a stationary car with {share} % overlap on a flat straight lane")
    assert brief.scene.actors[0].overlap == exactly(share)
