"""Words of kinds that no network knows: what stands for them before a network, and what is named afterwards.
The sentences of test_mentions.jsonl name one kind each; what is expected is the kind that they were written
about."""

import pytest

from roadgpt.brief.change import read_request
from roadgpt.brief.change.staging import changed_scene
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import plan, read_scene, scene_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.mentions import mentions_in, with_kinds, with_known_words
from roadgpt.brief.refusal import AnotherRoadError, TooMuchError
from roadgpt.language.table import ROAD_USERS, WEATHER
from tables import rows

READER = ModelReader()
SENTENCES = [tuple(row) for row in rows(__file__, "kinds")]


@pytest.mark.parametrize(("words", "kind"), SENTENCES[::6])
def test_the_kind_is_that_of_the_words(words: str, kind: str) -> None:
    brief = READER.read(words)
    assert kind in {role.kind for role in brief.scene.actors} | {air.kind for air in brief.scene.weather}
    assert brief.words == words


def test_every_kind_is_in_a_sentence() -> None:
    new = {name for name, row in [*ROAD_USERS.items(), *WEATHER.items()] if row.read_as}
    assert {kind for _, kind in SENTENCES} == new


def kinds_named(words: str, scene: str) -> tuple[str, tuple[str, ...]]:
    found = with_kinds(Brief(scene=read_scene(scene)), words)
    return scene_plan(found.scene), found.unused


@pytest.mark.parametrize(
    ("words", "read", "named", "unused"),
    [
        ("a lorry ahead, a fire engine behind", "truck ahead; truck behind",
         "truck ahead; fire_engine behind", ()),
        ("two police cars oncoming", "car x2 oncoming", "police_car x2 oncoming", ()),
        # the same one again, and the tested car
        ("a tram ahead brakes; when the tram stands, go on", "bus ahead: brake", "tram ahead: brake", ()),
        ("my car follows a police car", "car ahead", "police_car ahead", ()),
        # two of three cars are told of, and nobody knows which one is which
        ("a police car and a car near us", "car ahead; car behind; car oncoming",
         "car ahead; car behind; car oncoming", ("police car",)),
        # a network may read a word as another kind of the same group
        ("a pickup truck ahead", "truck ahead", "pickup ahead", ()),
        ("no ambulance, a van behind", "van behind", "van behind", ()),
        ("without an ambulance, a van behind", "van behind", "van behind", ()),
        # events name the same ones as before
        ("the fire engine brakes, then the lorry ahead of it does",
         "truck behind: brake; truck ahead: brake with truck 1 brake",
         "fire_engine behind: brake; truck ahead: brake with fire_engine 1 brake", ()),
        ("dust, visibility 40 m", "fog 40", "dust 40", ()),
        ("dust and fog, visibility 40 m", "fog 40", "fog 40; dust 40", ()),
        ("a ride-hailing car ahead", "car ahead", "car ahead", ()),
        ("eine Frau mit Kinderwagen quert von links", "adult crossing left: cross",
         "person_with_pushchair crossing left: cross", ()),
    ],
)  # fmt: skip
def test_who_is_named(words: str, read: str, named: str, unused: tuple[str, ...]) -> None:
    assert kinds_named(words, read) == (named, unused)


def test_a_word_that_no_network_knows_stands_as_one_that_it_does() -> None:
    assert with_known_words("two trams, and a car") == ("two buses, and a car", {"buses": "trams"})
    assert with_known_words("es hagelt auf der Straße")[0] == "es Regen auf der Straße"
    assert with_known_words("a tram stop at the kerb") == ("a tram stop at the kerb", {})
    assert [each.name for each in mentions_in("ein Reh und ein Rollstuhlfahrer auf der Straße")] == [
        "deer",
        "wheelchair_user",
    ]


def test_readings_of_before_have_the_class_of_the_new_kind() -> None:
    brief = READER.read("a police car ahead brakes hard on a straight road of 300 m, at night")
    assert plan(brief) == "straight | turns=0 len=300 && police_car ahead: brake; night"
    assert brief.unused == ()


@pytest.mark.parametrize(
    ("words", "left"),
    [
        ("remove the dust", "tram ahead v=30: brake decel=4; deer crossing left: cross; hail 5"),
        ("thicker dust", "tram ahead v=30: brake decel=4; deer crossing left: cross; hail 5; dust 40"),
        ("remove the tram", "deer crossing left: cross; hail 5; dust 60"),
        ("the tram shall brake harder",
         "tram ahead v=30: brake decel=6; deer crossing left: cross; hail 5; dust 60"),
        ("remove the animal", "tram ahead v=30: brake decel=4; hail 5; dust 60"),
        ("add a police car oncoming",
         "tram ahead v=30: brake decel=4; deer crossing left: cross; police_car oncoming; hail 5; dust 60"),
    ],
)  # fmt: skip
def test_requests_change_what_they_name(words: str, left: str) -> None:
    scene = read_scene("tram ahead v=30: brake 4; deer crossing left: cross; dust 60; hail 5")
    assert scene_plan(changed_scene(scene, read_request(words).scene, 70.0)) == left


@pytest.mark.parametrize("words", ["a straight road without hail", "a straight road without a dust storm"])
def test_what_is_denied_is_not_there(words: str) -> None:
    brief = READER.read(words)
    assert brief.scene.weather == ()
    assert brief.unused == ()


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        ("a road of 5 km with a tram ahead and forty turns", "tram ahead"),  # too much for the usual map
        ("a straight road in a dust storm, two bends", "dust 50..200"),  # contradicts itself
    ],
)
def test_what_is_offered_instead_names_them_too(words: str, meant: str) -> None:
    with pytest.raises((TooMuchError, AnotherRoadError)) as refused:
        READER.read(words)
    assert scene_plan(refused.value.brief.scene) == meant
    assert refused.value.brief.words == words
