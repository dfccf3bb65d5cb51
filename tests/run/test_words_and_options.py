"""What the words say of the weather, the light and the surface stands, unless an option says otherwise: all
pairs of words, --scene, --scenario and --friction. What each says is written here, apart from the code."""

from itertools import product
from typing import Any

import pytest

from roadgpt.brief import Brief, remarks
from roadgpt.brief.plan import read_plan, read_scene
from roadgpt.design.room import world_for, world_remarks
from roadgpt.errors import UsageError
from roadgpt.road import World
from roadgpt.run import Setup

FRICTION = {"wet": 0.6, "snow": 0.35, "ice": 0.1}
WORDS = ("", "wet", "snow; night", "ice; fog 80; low_sun", "rain 4; clock 07:30", "| beside(snow)")
SCENES = ("", "light", "wet", "rain 9", "night; snow", "fog 60")
SCENARIOS = {
    "": "",
    "nhtsa:animal_no_maneuver": "night",  # by night, says its source
    "r157:cut_in": "",
    "ncap:CPNA light=day": "day",
}
"""The light that each says; nothing where the day is only usual."""
CONDITIONS = ("weather", "clock", "light", "surface", "flow")
LIGHTS = ("night", "low_sun", "day")


def told(text: str) -> dict[str, str]:
    """What a text says, by what it is about: only this test's own words."""
    found = {}
    for part in filter(None, (each.strip() for each in text.removeprefix("|").split(";"))):
        name, *_ = part.split()
        about = "light" if name in LIGHTS else "surface" if name in FRICTION else name
        about = {"light": "flow"}.get(name, about) if part == "light" else about
        found["surface" if "beside" in part else about] = "snow" if "beside" in part else part
    return found


ROAD = "straight 600 | lanes=2 against=2"


def staged(words: str, scene: str, scenario: str, friction: float | None) -> tuple[Brief, World, World]:
    """The requirements, the World of the options, and that of the drive."""
    plan = f"{ROAD} {words.removeprefix('|')}" if "|" in words else f"{ROAD} && {words}"
    given: dict[str, Any] = {"map_size": 700.0} | ({"scene": scene} if scene else {})
    given |= {} if friction is None else {"friction": friction}
    brief, world = read_plan(plan), World().changed(**given)
    return brief, world, world_for(brief, Setup(scenario=scenario).staged(world, brief.left_hand))


@pytest.mark.parametrize("scenario", SCENARIOS)
@pytest.mark.parametrize("words", WORDS)
def test_what_the_words_say_stands_unless_an_option_says_otherwise(words: str, scenario: str) -> None:
    light = {"light": SCENARIOS[scenario]} if SCENARIOS[scenario] else {}
    for scene, friction in product(SCENES, (None, 0.8)):
        of_scene = told(scene)
        if light and of_scene.get("light", light["light"]) != light["light"]:
            with pytest.raises(UsageError, match="contradict each other"):
                staged(words, scene, scenario, friction)
            continue
        brief, usual, world = staged(words, scene, scenario, friction)
        want = {**told(words), **of_scene, **light}
        expected = read_scene("; ".join(each for each in want.values() if each != "day"))
        if scene or scenario or "beside" not in words:  # without options, such names stay beside the scene
            found = {name: getattr(world.scene, name) for name in CONDITIONS}
            assert found == {name: getattr(expected, name) for name in CONDITIONS}, (scene, friction)
        surface = want.get("surface") or ("wet" if "rain" in want else None)
        of_surface = FRICTION[surface] if surface else 1.0
        assert world.site.friction == (of_surface if friction is None else friction), (scene, friction)
        noted = remarks(brief, 700.0, world.site.friction, world.scene.surfaces, friction is not None)
        said = [*noted, *world_remarks(brief, usual, world)]
        told_of = [each for each in said if "friction is" in each]
        assert all(f"friction is {world.site.friction:g}" in each for each in told_of)
        assert not any("--friction" in each for each in said if friction is not None)
        assert not any("is set" in each for each in told_of)
        lost = {name for name, each in told(words).items() if want[name] != each}
        of_scene_lost = lost if "|" not in words else set()
        assert any("is set and used" in each for each in said) == bool(of_scene_lost), said
        assert world_for(brief, Setup(scenario=scenario).staged(world, False)) == world


@pytest.mark.parametrize("scene", ["lights red", "car junction left: cross", "ego v=40 left"])
def test_lanes_of_the_words_stand_where_the_scene_makes_the_road_a_route(scene: str) -> None:
    brief = read_plan(f"straight 200 | lanes=2 && {scene}")
    found = world_for(brief, World())
    said = " ".join(world_remarks(brief, World(), found))
    assert "is set and used" not in said
    assert "straight len=200 | lanes=2 //" in said
