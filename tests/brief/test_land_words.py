"""What land words ask for: its kind, what is in it, where, and which words mean nothing."""

import pytest

from roadgpt.brief.amount import exactly
from roadgpt.brief.land_words import land_in
from roadgpt.brief.plan import read_scene
from roadgpt.brief.scene import Land


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
