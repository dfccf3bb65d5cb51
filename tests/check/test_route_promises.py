"""What a route must show of its Brief: junctions by kind, way and sign, and the roads between them."""

from typing import Any

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.check.network_measures import measured_junctions
from roadgpt.network import Route, build_route, read_network_design
from roadgpt.road import World

WORLD = World()


def route(*junctions: dict[str, Any], lengths: tuple[float, ...] = ()) -> Route:
    """A route of straight, level roads of 40 m with these junctions, or with roads of these lengths."""
    data: dict[str, Any] = {"starting_point": [20, 60, 0], "theta": 0}
    for number in range(1, len(junctions) + 2):
        length = lengths[number - 1] if lengths else 40
        data[f"road_segment{number}"] = {
            "distance": length,
            "direction": "straight",
            "incline": 0,
            "turn_degrees": 0,
        }
    for number, junction in enumerate(junctions, 1):
        data[f"junction{number}"] = {"after": number, **junction}
    return build_route(read_network_design(data)[0], WORLD)


def arms(*angles: float) -> list[dict[str, float]]:
    return [{"angle": angle} for angle in angles]


T_STEM = {"kind": "t_junction", "take": "right", "arms": arms(-90, 90)}
T_LEFT = {"kind": "t_junction", "take": "straight", "arms": arms(0, 90), "control": "priority"}
FORK = {"kind": "y_junction", "take": "left", "arms": arms(-60, 60)}
CROSS = {"kind": "crossroads", "take": "left", "arms": arms(-90, 0, 90), "control": "lights"}
SKEW = {"kind": "crossroads", "take": "straight", "arms": arms(-125, 0, 55)}
STAR = {"kind": "star", "take": 4, "arms": arms(-108, -36, 36, 108)}
RING = {"kind": "roundabout", "take": 3, "radius": 16, "arms": arms(-90, 0, 90)}
TWO = {"kind": "roundabout", "take": 1, "radius": 16, "arms": arms(-90, 60)}


def told(asked: str, *junctions: dict[str, Any], lengths: tuple[float, ...] = ()) -> list[str]:
    """What is said of the promises of a plan on a route."""
    found = inspect(route(*junctions, lengths=lengths), read_plan(asked), WORLD)
    return [finding.sentence for finding in found if finding.rule == "promises"]


@pytest.mark.parametrize(
    ("asked", "junction"),
    [
        ("t_junction right ways=left+right none", T_STEM),
        ("t_junction straight ways=left+straight priority arms=3", T_LEFT),
        ("y_junction left", FORK),
        ("crossroads left lights arms=4", CROSS),
        ("crossroads straight skew", SKEW),
        ("star sharp_left arms=5", STAR),
        ("star left", {**STAR, "take": 4}),
        ("roundabout exit=3 arms=4 normal r=16", RING),
        ("roundabout left yield", RING),
        ("roundabout exit=1 arms=3", TWO),
        ("junction left", CROSS),
    ],
)
def test_a_promise_that_is_kept_is_not_mentioned(asked: str, junction: dict[str, Any]) -> None:
    assert told(asked, junction) == []


@pytest.mark.parametrize(
    ("asked", "junction", "said"),
    [
        ("y_junction right", T_STEM, "asked for a Y-junction, has arms 90, 180, 90 degrees apart"),
        ("t_junction left", FORK, "asked for a T-junction, has arms 120, 120, 120 degrees apart"),
        ("t_junction left", T_STEM, "asked to turn left, turns -90 degrees"),
        ("t_junction ways=right+straight", T_LEFT, "ways to the right and straight, has straight and left"),
        ("crossroads right", CROSS, "asked to turn right, turns 90 degrees"),
        ("crossroads stop", CROSS, "asked for stop, has lights"),
        ("crossroads skew", CROSS, "the least angle is 90 degrees"),
        ("star arms=6", STAR, "asked for 6 arms, has 5"),
        ("star slight_left", STAR, "asked to bear slightly left, turns 108 degrees"),
        ("star slight_right", {**STAR, "take": 1}, "asked to bear slightly right, turns -108 degrees"),
        ("roundabout exit=2", RING, "asked for exit 2, takes exit 3"),
        ("roundabout straight", RING, "asked to go straight on, turns 90 degrees"),
        ("roundabout back", RING, "asked to turn back the way it came, turns 90 degrees"),
        ("roundabout mini", RING, "asked for a mini roundabout, 13 to 25 m wide, is 42.0 m wide"),
        ("roundabout r=25", RING, "asked for an island of 25 m radius, has 16.0 m"),
        ("roundabout lights", RING, "asked for lights, has yield"),
        ("junction", RING, "asked for a junction, has arms 90, 90, 90, 90 degrees apart"),
    ],
)
def test_a_broken_promise_is_said_with_what_there_is(asked: str, junction: dict[str, Any], said: str) -> None:
    (sentence,) = told(asked, junction)
    assert sentence.startswith("junction 1 at s = 40 m: ")
    assert said in sentence


def test_a_route_that_turns_back_takes_the_last_exit() -> None:
    data: dict[str, Any] = {
        "starting_point": [20, 60, 0],
        "theta": 0,
        "road_segment1": {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0},
        "junction1": {"after": 1, **RING, "take": 4},
    }
    back = build_route(read_network_design(data)[0], WORLD)
    assert [f for f in inspect(back, read_plan("roundabout back"), WORLD) if f.rule == "promises"] == []
    (found,) = measured_junctions(back)
    assert (found.exit, found.arms) == (4, 4)
    assert "turns 180 degrees" in next(
        f.sentence for f in inspect(back, read_plan("roundabout left"), WORLD) if f.rule == "promises"
    )


def test_the_number_of_junctions_is_compared_first() -> None:
    assert told("crossroads left // crossroads left", CROSS) == [
        "asked for 2 junctions and places where lanes change, passes 1"
    ]
    assert told("crossroads left lights // roundabout exit=3", CROSS, RING) == []


def test_each_road_is_compared_with_its_own_requirements() -> None:
    assert told("straight 60 // crossroads left", CROSS, lengths=(60, 40)) == []
    (said,) = told("straight 60 // crossroads left", CROSS, lengths=(40, 60))
    assert said.startswith("on the road from s = 0 m: asked for a straight")
    assert "has 40 m" in said
    (said,) = told("crossroads left // turn right", CROSS)
    assert "asked for 1 turn, has 0" in said
    assert not said.startswith("on the road from s = 0 m")
    said, *_ = told("crossroads left // | up", CROSS)
    assert "asked for a road that climbs all the way" in said


def test_the_length_is_that_of_the_whole_route() -> None:
    whole = route(CROSS).length
    assert told(f"crossroads left || len={whole:.0f}", CROSS) == []
    (said,) = told("crossroads left || len=300", CROSS)
    assert said == f"asked for a length of 270 to 330 m, has {whole:.0f} m"
