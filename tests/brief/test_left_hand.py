"""Words that ask for traffic on the left, and words that only name the left."""

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.expressions import says_left_hand, with_driving_side
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.sentence import sentence

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
        "turn into the second street, which is also on the left",
        "a T-junction, turn left",
        "no left-hand traffic please, a fork, keep left",
        "change to the left lane, then a crossroads",
        "keep to the left at the fork",
        "a side road on the left, drive on",
        "die Kreuzung ohne Linksverkehr, dort links",
        "tournez à gauche au carrefour",
        "gira a sinistra all'incrocio",
        "en el cruce, a la izquierda",
        "usciamo da un senso unico e al bivio si tiene la sinistra",
        "à la fourche on tient la gauche",
    ],
)
def test_the_left_alone_is_no_traffic_on_the_left(words: str) -> None:
    assert not says_left_hand(words, by_place=True)


def test_a_route_is_read_with_it() -> None:
    assert READER.read("left-hand traffic, a T-junction, turn right").left_hand
    assert not READER.read("a T-junction, turn right").left_hand


@pytest.mark.parametrize(
    ("words", "beside"),
    [
        ("left-hand traffic, three bends", ()),
        ("Linksverkehr, drei Kurven", ()),
        ("three bends, traffic on the left, and dense traffic", ("traffic",)),
    ],
)
def test_other_cars_are_named_only_where_the_words_name_them(words: str, beside: tuple[str, ...]) -> None:
    found = with_driving_side(read_plan("turn x3 | beside(traffic)"), words)
    assert (found.left_hand, found.beside) == (True, beside)


def test_a_single_road_as_in_a_country_is_no_wish_for_its_traffic() -> None:
    found = read("two bends, as in Scotland")
    assert len(found.clauses) == 1
    assert not found.left_hand


@pytest.mark.parametrize("words", ["left-hand traffic", "two bends with traffic on the left"])
def test_a_single_road_is_read_with_it(words: str) -> None:
    assert read(words).left_hand
    assert sentence(read(words)).endswith("raffic on the left.")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a village with six junctions, cars on the left", "map junction x6 || left_hand"),
        ("un village de six carrefours", "map crossroads x6"),
        (
            "straight over a crossroads, then uphill; we drive on the left",
            "crossroads straight // | up || left_hand",
        ),
        ("left-hand traffic, a T-junction, turn left", "t_junction left || left_hand"),
        ("a roundabout, second exit, with cars driving on the left", "roundabout exit=2 || left_hand"),
        ("as in Scotland: a crossroads, straight on", "crossroads straight || left_hand"),
        ("LHT; crossroads; right", "crossroads right || left_hand"),
        ("im Linksverkehr geradeaus über die Kreuzung", "crossroads straight || left_hand"),
        ("on conduit à gauche : un rond-point, première sortie", "roundabout exit=1 || left_hand"),
        ("se maneja por la izquierda: cruce, a la derecha", "crossroads right || left_hand"),
        ("un incrocio a destra, guida a sinistra", "crossroads right || left_hand"),
        ("a village with six junctions", "map junction x6"),
    ],
)
def test_routes_and_maps_have_the_traffic_that_the_words_ask_for(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a T-junction, turn left", "t_junction left"),
        ("change to the left lane, then a crossroads", "lane_change left // crossroads"),
        ("keep to the left at the fork", "y_junction left"),
        ("usciamo da un senso unico e al bivio si tiene la sinistra", "| oneway // y_junction left"),
        ("à la fourche on tient la gauche", "y_junction left"),
    ],
)
def test_words_that_only_name_the_left_say_where_the_route_goes(words: str, line: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(line)))
