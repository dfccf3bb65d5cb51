"""What a route must show of its Brief: junctions by kind, way and sign, and the roads between them."""

from typing import Any

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.check.measures import measured_junctions
from roadgpt.network import Route, build_route
from roadgpt.road import World, read_design
from tables import rows

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
    return build_route(read_design(data)[0], WORLD)


def arms(*angles: float) -> list[dict[str, float]]:
    return [{"angle": angle} for angle in angles]


T_STEM = {"kind": "t_junction", "take": "right", "arms": arms(-90, 90)}
T_LEFT = {"kind": "t_junction", "take": "straight", "arms": arms(0, 90), "control": "priority"}
FORK = {"kind": "y_junction", "take": "left", "arms": arms(-60, 60)}
CROSS = {"kind": "crossroads", "take": "left", "arms": arms(-90, 0, 90), "control": "lights"}
SKEW = {"kind": "crossroads", "take": "straight", "arms": arms(-125, 0, 55)}
STAR = {"kind": "star", "take": 4, "arms": arms(-108, -36, 36, 108)}
RING = {"kind": "roundabout", "take": 3, "radius": 16, "arms": arms(-90, 0, 90)}
STAR_RIGHT = {**STAR, "take": 1}
TWO = {"kind": "roundabout", "take": 1, "radius": 16, "arms": arms(-90, 60)}


def told(asked: str, *junctions: dict[str, Any], lengths: tuple[float, ...] = ()) -> list[str]:
    """What is said of the promises of a plan on a route."""
    found = inspect(route(*junctions, lengths=lengths), read_plan(asked), WORLD)
    return [finding.sentence for finding in found if finding.rule == "promises"]


@pytest.mark.parametrize(("asked", "junction"), rows(__file__, "kept"))
def test_a_promise_that_is_kept_is_not_mentioned(asked: str, junction: str) -> None:
    assert told(asked, globals()[junction]) == []


@pytest.mark.parametrize(("asked", "junction", "said"), rows(__file__, "broken"))
def test_a_broken_promise_is_said_with_what_there_is(asked: str, junction: str, said: str) -> None:
    (sentence,) = told(asked, globals()[junction])
    assert sentence.startswith("junction 1 at s = 40 m: ")
    assert said in sentence


def test_a_route_that_turns_back_takes_the_last_exit() -> None:
    data: dict[str, Any] = {
        "starting_point": [20, 60, 0],
        "theta": 0,
        "road_segment1": {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0},
        "junction1": {"after": 1, **RING, "take": 4},
    }
    back = build_route(read_design(data)[0], WORLD)
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
