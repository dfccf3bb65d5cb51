"""Words that ask for traffic on the left, and words that only name the left."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.sentence import sentence

READER = ModelReader()


def test_a_route_is_read_with_it() -> None:
    assert READER.read("left-hand traffic, a T-junction, turn right").left_hand
    assert not READER.read("a T-junction, turn right").left_hand


def test_a_single_road_as_in_a_country_is_no_wish_for_its_traffic() -> None:
    found = read("two bends, as in Scotland")
    assert len(found.clauses) == 1
    assert not found.left_hand


@pytest.mark.parametrize("words", ["left-hand traffic", "two bends with traffic on the left"])
def test_a_single_road_is_read_with_it(words: str) -> None:
    assert read(words).left_hand
    assert sentence(read(words)).endswith("raffic on the left.")
