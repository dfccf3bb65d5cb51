"""What land words ask for: its kind, what is in it, where, and which words mean nothing."""

import pytest

from roadgpt.brief.amount import amount_text, exactly
from roadgpt.brief.land_words import land_in
from roadgpt.brief.plan import read_plan, read_scene, scene_plan
from roadgpt.brief.readers.model.scenes import with_told
from roadgpt.brief.scene import Land, Scene, scene_text
from roadgpt.errors import BriefError


def lands(words: str) -> list[tuple[object, ...]]:
    """What is in the land that words ask for, each with its lie, its side and its number if they are said."""
    found = land_in(words).lands
    return [
        (each.kind, *filter(None, (each.lie, each.side)), *([each.count] * (each.count != exactly(1))))
        for each in found
    ]


@pytest.mark.parametrize(
    ("words", "kind", "expected"),
    [
        ("a valley between two ridges", None, [("valley",), ("ridge", "left"), ("ridge", "right")]),
        ("an alpine valley between ridges", "mountain", [("valley",), ("ridge", "left"), ("ridge", "right")]),
        ("hilly land with a lake", "hilly", [("lake",)]),
        ("mountains", "mountain", []),
        ("Flat country.", "flat", []),
        ("rolling land with a wood and three ponds", "rolling", [("forest",), ("lake", exactly(3))]),
        ("flat land crossed by a river", "flat", [("river", "across")]),
        ("across a stream, through a forest", None, [("river", "across"), ("forest", "through")]),
        ("the sea on the right", None, [("coast", "right")]),
        ("a ridge on the left and a lake on the right", None, [("ridge", "left"), ("lake", "right")]),
        ("two valleys and a river", None, [("valley", exactly(2)), ("river",)]),
        ("along a river in steep terrain", "mountain", [("river", "along")]),
        ("a road between two lakes", None, [("lake", exactly(2))]),
    ],
)
def test_phrases(words: str, kind: str | None, expected: list[tuple[object, ...]]) -> None:
    assert land_in(words).kind == kind
    assert lands(words) == expected


@pytest.mark.parametrize(
    "plan",
    [
        "lake left; ridge right",
        "valley; forest",
        "river across",
        "lake along left; forest through",
        "ridge along; river across",
        "lake x2; coast right",
    ],
)
def test_the_landscape_of_a_plan_is_what_the_reader_of_plans_reads(plan: str) -> None:
    wish = land_in(plan)
    assert wish.lands == read_scene(plan).landscape
    assert len(wish.lands) == len(plan.split(";"))
    assert (wish.kind, wish.unused) == (None, ())


@pytest.mark.parametrize("words", ["a river across the middle, a wood", "a river on the left, a wood"])
def test_what_is_said_behind_something_is_about_that_and_not_about_the_next(words: str) -> None:
    said = "across" if "across" in words else "left"
    assert lands(words) == [("river", said), ("forest",)]


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        ("hilly land with a volcano", ("volcano",)),
        ("asdf qwer", ("asdf", "qwer")),
        ("a purple lake behind hills", ("purple", "behind")),
        ("lake; town; bridge", ("town", "bridge")),
        ("", ()),
        ("a landscape with the land", ()),
    ],
)
def test_words_that_mean_nothing_are_listed_in_their_order(words: str, unused: tuple[str, ...]) -> None:
    assert land_in(words).unused == unused


def test_nothing_is_made_of_words_that_name_no_land() -> None:
    for words in ("", "asdf qwer", "left right between two", "12 34 %"):
        wish = land_in(words)
        assert (wish.kind, wish.lands) == (None, ())


def test_both_ridges_of_a_valley_are_plain_ridges() -> None:
    _, left, right = land_in("a valley between two ridges").lands
    assert left == Land(kind="ridge", side="left")
    assert right == Land(kind="ridge", side="right")


@pytest.mark.parametrize(
    ("words", "land"),
    [
        ("hilly terrain, a lake on the left", "hilly"),
        ("a lake among the hills", "hilly"),
        ("gently rolling country beside a lake", "rolling"),
        ("flat farmland and a lake", "flat"),
        ("in the plain, along a lake", "flat"),
        ("on a plain, along a lake", "flat"),
        ("a lake in a plain.", "flat"),
        ("hügeliges Land an einem See", "hilly"),
        ("wellige Landschaft mit See", "rolling"),
        ("un terrain vallonné près d'un lac", "hilly"),
        ("un lago en la llanura", "flat"),
        ("colline dolci e un lago", "hilly"),
        ("a lake, not hilly at all", None),
        ("a plain road past a lake", None),
    ],
)
def test_words_for_the_kind_of_land_are_taken_beside_a_landscape(words: str, land: str | None) -> None:
    told = with_told(read_plan("turn x2 && lake along"), words)
    assert told.scene.land == land
    assert with_told(read_plan("turn x2 && hilly; lake along"), words).scene.land == "hilly"
    assert with_told(read_plan("turn x2"), words).scene == Scene()


@pytest.mark.parametrize(
    ("plan", "words", "kept"),
    [
        ("hairpin x2 | down hills=3.. && forest through", "a descent through hilly wooded land", None),
        ("| flat hills=3.. && forest through", "keep the road level in rolling woods", None),
        ("hairpin x2 | hills=3.. && forest through", "a hilly road through a forest", "3.."),
        ("| down hills=3.. && forest through", "downhill with three brows, a forest", "3.."),
    ],
)
def test_hills_of_the_land_are_none_of_a_road_with_a_slope_of_its_own(
    plan: str, words: str, kept: str | None
) -> None:
    told = with_told(read_plan(plan), words)
    assert (told.hills and amount_text(told.hills)) == kept


@pytest.mark.parametrize(
    ("plan", "kept"),
    [
        ("tunnel x2; tunnel x2", "tunnel x2"),
        ("tunnel; bridge; tunnel", "tunnel; bridge; tunnel"),
        ("forest through; lake left; forest through", "forest through; lake left"),
        ("bridge len=8; tunnel x2 len=90", "bridge len=8; tunnel x2 len=90"),
    ],
)
def test_what_a_network_says_twice_is_taken_once(plan: str, kept: str) -> None:
    told = with_told(read_plan(f"turn x3 | len=900 && {plan}"), "a road of 900 m")
    assert scene_plan(told.scene) == kept


@pytest.mark.parametrize(
    ("plan", "said"),
    [
        ("ridge along", "along the crest of a ridge"),
        ("ridge along left", "a ridge along the road on the left"),
        ("ridge left away=60", "a ridge on the left 60 metres away"),
        ("ridge along left away=60", "a ridge along the road on the left 60 metres away"),
        ("embankment", "an embankment"),
    ],
)
def test_what_is_asked_of_a_ridge_is_said(plan: str, said: str) -> None:
    assert scene_text(read_scene(plan)) == said


@pytest.mark.parametrize("plan", ["ridge along away=60", "lake across away=60", "bridge away=60"])
def test_only_what_lies_beside_the_road_is_away_from_it(plan: str) -> None:
    with pytest.raises(BriefError, match="has no away= here; leave it out"):
        read_scene(plan)
