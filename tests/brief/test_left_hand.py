"""Words that ask for traffic on the left, and words that only name the left."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.left_hand import says_left_hand
from roadgpt.brief.readers.model import ModelReader
from roadgpt.errors import BriefError

READER = ModelReader()


@pytest.mark.parametrize(
    "words",
    [
        "left-hand traffic, a T-junction, turn left",
        "a roundabout, second exit, with cars driving on the left",
        "as in Scotland: a crossroads, straight on",
        "LHT; crossroads; right",
        "im Linksverkehr über die Kreuzung",
        "on conduit à gauche : un rond-point, première sortie",
        "se maneja por la izquierda: cruce, a la derecha",
        "un incrocio a destra, guida a sinistra",
    ],
)
def test_traffic_on_the_left_is_heard_in_five_languages(words: str) -> None:
    assert says_left_hand(words, by_place=True)


@pytest.mark.parametrize(
    "words",
    [
        "a T-junction, turn left",
        "no left-hand traffic please, a fork, keep left",
        "change to the left lane, then a crossroads",
        "keep to the left at the fork",
        "a side road on the left, drive on",
        "die Kreuzung ohne Linksverkehr, dort links",
        "tournez à gauche au carrefour",
        "gira a sinistra all'incrocio",
        "en el cruce, a la izquierda",
    ],
)
def test_the_left_alone_is_no_traffic_on_the_left(words: str) -> None:
    assert not says_left_hand(words, by_place=True)


def test_a_route_is_read_with_it() -> None:
    assert READER.read("left-hand traffic, a T-junction, turn right").left_hand
    assert not READER.read("a T-junction, turn right").left_hand


def test_a_single_road_as_in_a_country_is_no_wish_for_its_traffic() -> None:
    assert len(read("two bends, as in Scotland").clauses) == 1


@pytest.mark.parametrize("words", ["left-hand traffic", "two bends with traffic on the left"])
def test_a_single_road_with_it_is_refused_and_not_read_as_something_else(words: str) -> None:
    with pytest.raises(BriefError, match="a road without junctions has no traffic on the left; leave it out"):
        read(words)
