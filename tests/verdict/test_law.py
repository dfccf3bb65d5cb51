"""Who had the way, who broke which rule, and whose fault it was: others' offences crossed with those of the
tested car and with kinds of contact. What is expected was written from the Vienna Convention on Road Traffic
(1968), whose article stands with each case, and not from the code."""

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from roadgpt.drive import Columns, Drive
from roadgpt.network import Route
from roadgpt.road import Limits, Road, World
from roadgpt.verdict import Verdict, judge
from roadgpt.verdict.criteria import Judged, incidents_of
from roadgpt.verdict.law import fault_of, law_of
from roadgpt.verdict.verdict import Contact
from staged import Motion, among, driven, level, straight, tracks
from verdict.test_incidents import WORLD as ROUTE_WORLD
from verdict.test_incidents import crossroads
from verdict.test_incidents import driven as along
from verdict.test_right_of_way import LEFT, RIGHT, V, moving, node, passing

ROAD = level(0, 400)
LANE = -2.0  # m, from the middle of a road of two lanes of 4 m to that of the tested car's
GREEN, RED, ALL_RED = 5.0, 22.0, 20.0
"""Seconds that the tested car waits at its start, to come to its line while the lights show it green and the
others red, the other way round, and red for everybody. The line is 3.7 s from its start."""


class Case(NamedTuple):
    """A collision, and what the law says of it."""

    drive: Drive
    road: Road
    world: World
    said: str
    """Who had the way; offences of the tested car; of the other; whose fault it was."""


def road(said: str, own: Motion, kind: str, other: Motion, limit: float = 30.0) -> Case:
    drive = among(driven(own, 8.0, ROAD), tracks(8.0, it_1=(kind, other)))
    return Case(drive, ROAD, World(limits=Limits(speed_limit=limit)), said)


def junction(
    said: str, control: str, comes: float, waits: float = 0.0, v: float = V, limit: float = 30.0,
    stops: bool = False, cross: str = "", starts: bool = False,
) -> Case:  # fmt: skip
    """At crossroads, straight on with 10 m/s, somebody from a side is there when the tested car is; it
    ``stops`` at its line first, or ``starts`` 6 m before. ``cross`` is another sign of the arms across."""
    route = crossroads("straight", control)
    if cross:
        (junction,) = route.network.junctions
        signed = [replace(each, control=cross) if n % 2 else each for n, each in enumerate(junction.arms)]
        changed = replace(route.network, junctions=(replace(junction, arms=tuple(signed)),))
        route = Route.along(changed, route.legs).on_ground()
    drive = passing(route, waits)
    if stops:  # 10 m/s up to the line, where it stands for 3 s
        time, at = drive["time"], (50 - 10 - 2.25 - 1.0) / V
        x = 10 + V * (np.minimum(time, at) + np.maximum(time - at - 3.0, 0))
        still = (time > at) & (time < at + 3.0)
        own = {"x": x, "s": x, "speed": np.where(still, 0.0, V), "vx": np.where(still, 0.0, V)}
        drive, waits = replace(drive, columns=Columns({**drive.columns, **own})), waits + 3.0
    x = node(route) + 2.0 * np.sin(comes)
    at = waits + (x - 10) / V
    other = moving(x, comes, at, lambda time: v * np.maximum(time, at - 6.0 / v if starts else 0.0))
    drive = replace(among(drive, tracks(drive.duration, it_1=("car", other))), lights=control == "lights")
    return Case(drive, route, ROUTE_WORLD.changed(speed_limit=limit), said)


def crosswalk(said: str, control: str, is_far: bool, waits: float = 0.0) -> Case:
    """Straight on over crossroads with crosswalks; somebody walks over the one in front or behind."""
    route = crossroads("straight", control)
    (junction,) = route.network.junctions
    walked = tuple(replace(each, crosswalk=True) for each in junction.arms)
    network = replace(route.network, junctions=(replace(junction, arms=walked),))
    route = Route.along(network, route.legs).on_ground()
    drive, (way,) = passing(route, waits), route.passages
    x = way.end + 2.0 if is_far else way.start - 2.0
    other = walks(x, 1.5, waits + (x - 10 - 2.0) / V)
    drive = replace(among(drive, tracks(drive.duration, it_1=("adult", other))), lights=control == "lights")
    return Case(drive, route, ROUTE_WORLD.changed(speed_limit=30.0), said)


def turning(said: str, take: str, y: float) -> Case:
    """Turns at 6 m/s, and a bicycle that came the same way at its side goes straight on."""
    route, v = crossroads(take, "priority"), 6.0
    s = np.arange(10, route.length - 10, 0.02 * v)
    x, across = route.at(s, -2.0)[:, :2].T
    drive = along(route, x, across, route.heading(s), v, 0.02)
    drive = replace(drive, columns=Columns({**drive.columns, "vx": drive["speed"], "z": 0 * s + 0.56}))
    return Case(
        among(drive, tracks(drive.duration, it_1=("bicycle", straight(10, y, 0, v)))),
        route, ROUTE_WORLD.changed(speed_limit=30.0), said,
    )  # fmt: skip


def brakes(time: Any) -> Any:
    """15 m/s; from 3 s on it brakes with 6 m/s2 to a stop."""
    for_ = np.clip(time - 3.0, 0, 2.5)
    return 100 + 15 * np.minimum(time, 3.0) + 15 * for_ - 3 * for_**2, LANE + 0 * time, 0 * time


def enters(x: float, speed: float, since: float, sideways: float = 2.0) -> Motion:
    """Out of the lane to the left into that of the tested car."""
    return lambda time: (x + speed * time, np.clip(2 - sideways * (time - since), LANE, 2), 0 * time)


def walks(x: float, speed: float, at: float) -> Motion:
    """From the right across the road; in the middle of the lane at that time."""
    return lambda time: (x + 0 * time, LANE + speed * (time - at), np.pi / 2)


EVEN = straight(10, LANE, 0, 15)  # its front is at x after (x - 12.35) / 15 s


CASES: dict[str, Callable[[], Case]] = {
    "its red, article 23": lambda: junction("ego; ; red light; other", "lights", LEFT, GREEN),
    "own red, 23": lambda: junction("other; red light; ; ego", "lights", LEFT, RED),
    "both red, 23": lambda: junction("; red light; red light; both", "lights", LEFT, ALL_RED),
    "its red, own speed, 23 and 13": lambda: junction(
        "ego; speed; red light; both", "lights", LEFT, GREEN, v=7, limit=8
    ),
    "its sign, 10 and 18": lambda: junction("ego; ; priority; other", "priority", LEFT),
    "its stop, 10": lambda: junction("ego; ; priority, stop; other", "priority", LEFT, cross="stop"),
    "its stop, own speed": lambda: junction(
        "ego; speed; priority, stop; both", "priority", LEFT, v=7, limit=8, cross="stop"
    ),
    "own stop, 10": lambda: junction("other; priority, stop; ; ego", "stop", LEFT),
    "stood, and went too early, 10": lambda: junction("other; priority; ; ego", "stop", LEFT, stops=True),
    "own sign, its speed, 18 and 13": lambda: junction(
        "other; priority; speed; both", "yield", RIGHT, v=14, limit=12
    ),
    "from the right, 18": lambda: junction("other; priority; ; ego", "none", RIGHT),
    "stood in the junction, from the right, 18": lambda: junction(
        "other; priority; ; ego", "none", RIGHT, starts=True
    ),
    "stood in the junction, with a stop sign, 18": lambda: junction(
        "ego; ; priority; other", "priority", LEFT, starts=True, cross="stop"
    ),
    "from the left, 18": lambda: junction("ego; ; priority; other", "none", LEFT),
    "into a slow leader, 13": lambda: road("other; distance; ; ego", EVEN, "car", straight(60, LANE, 0, 5)),
    "into who brakes, 13": lambda: road("other; distance; ; ego", straight(80, LANE, 0, 15), "car", brakes),
    "hit from behind, 13": lambda: road(
        "ego; ; distance; other", straight(50, LANE, 0, 5), "car", straight(30, LANE, 0, 15)
    ),
    "from behind, own speed": lambda: road(
        "ego; speed; distance, speed; other",
        straight(50, LANE, 0, 9),
        "car",
        straight(30, LANE, 0, 15),
        7.5,
    ),
    "cut in short, 11 and 14": lambda: road("ego; ; lane; other", EVEN, "car", enters(30, 10, 1.0)),
    "cut in short, own speed": lambda: road("ego; speed; lane; both", EVEN, "car", enters(30, 10, 1.0), 12),
    "cut in far ahead, 13": lambda: road("other; distance; ; ego", EVEN, "car", enters(70, 6, 1.0)),
    "own cut in short, 11 and 14": lambda: road(
        "other; lane; ; ego", enters(30, 10, 1.0), "car", straight(10, LANE, 0, 15)
    ),
    "own change far ahead, 13": lambda: road(
        "ego; ; distance; other", enters(70, 6, 1.0), "car", straight(10, LANE, 0, 15)
    ),
    "on a crosswalk, 21": lambda: crosswalk("other; priority; ; ego", "priority", is_far=False),
    "on the crosswalk behind, 21": lambda: crosswalk("other; priority; ; ego", "priority", is_far=True),
    "walks at red, 21": lambda: crosswalk("ego; ; priority; other", "lights", is_far=False, waits=GREEN),
    "walks at red behind, 21": lambda: crosswalk(
        "ego; ; priority; other", "lights", is_far=True, waits=GREEN
    ),
    "own red at a crosswalk, 23": lambda: crosswalk(
        "other; red light; ; ego", "lights", is_far=False, waits=RED
    ),
    "own red, walks behind, 23": lambda: crosswalk(
        "other; red light; ; ego", "lights", is_far=True, waits=RED
    ),
    "turns right over a bicycle, 16": lambda: turning("other; priority; ; ego", "right", -4.2),
    "passed on the left while it turns left, 11": lambda: turning("ego; ; lane; other", "left", 0.2),
    "it comes on the wrong side, 10": lambda: road(
        "ego; ; wrong way; other", EVEN, "car", straight(150, LANE, np.pi, 10)
    ),
    "it drifts over, 10": lambda: road(
        "ego; ; lane; other", straight(10, -1.5, 0, 15), "car", straight(150, 0.2, np.pi, 10)
    ),
    "own on the wrong side, 10": lambda: road(
        "other; wrong way; ; ego", straight(10, 2, 0, 15), "car", straight(150, 2, np.pi, 10)
    ),
    "own drifts over, 10": lambda: road(
        "other; lane; ; ego", straight(10, 0, 0, 15), "car", straight(150, 1.6, np.pi, 10)
    ),
    "both drive too fast, 10 and 13": lambda: road(
        "ego; speed; speed, wrong way; both", EVEN, "car", straight(150, LANE, np.pi, 15), 10
    ),
    "steps onto the road, 20": lambda: road("ego; ; priority; other", EVEN, "adult", walks(55, 1.5, 2.84)),
    "steps out, own speed": lambda: road(
        "ego; speed; priority; both", EVEN, "child", walks(55, 1.5, 2.84), 10
    ),
    "walks ahead, 13": lambda: road("other; distance; ; ego", EVEN, "adult", straight(60, LANE, 0, 1.5)),
    "rides out of a drive, 12": lambda: road("ego; ; priority; other", EVEN, "bicycle", walks(55, 4, 2.84)),
    "a deer, which no law binds": lambda: road("ego; ; ; nobody", EVEN, "animal", walks(55, 4, 2.84)),
    "lost load, 13": lambda: road("other; distance; ; ego", EVEN, "lost_load", straight(80, LANE, 0, 0)),
    "backwards, 14": lambda: road(
        "other; wrong way; ; ego", straight(60, LANE, np.pi, -9), "barrier", straight(90, LANE, 0, 0)
    ),
    "stands, and is hit, 13": lambda: road(
        "ego; ; distance; other", straight(60, LANE, 0, 0), "car", straight(20, LANE, 0, 9)
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_the_law_says(name: str) -> None:
    drive, road, world, expected = CASES[name]()
    found = incidents_of(Judged(road, drive, world))
    law = law_of(road, drive, world, found)
    contact = next(each.contact for each in found if each.contact is not None)
    fault = fault_of(law, contact, is_own_doing=False)
    said = "; ".join((law.way or "", ", ".join(law.ego), ", ".join(law.other), fault))
    assert said == expected


def test_a_car_that_is_hit_by_one_that_runs_a_red_light_is_not_at_fault() -> None:
    drive, road, world, _ = CASES["its red, article 23"]()
    verdict = judge(road, drive, world)
    assert verdict.law is not None
    assert (verdict.law.way, verdict.law.other, verdict.at_fault) == ("ego", ("red light",), "other")
    assert "; not at fault" in verdict.description
    assert verdict.avoidable == (verdict.outcome == "FAIL")
    assert Verdict.from_json(json.loads(json.dumps(verdict.to_json()))) == verdict


def test_who_brakes_for_nothing_is_at_fault_too() -> None:
    case = road("", brakes, "car", straight(80, LANE, 0, 15))
    verdict = judge(case.road, case.drive, case.world)
    assert verdict.law is not None
    assert (verdict.law.ego, verdict.law.other, verdict.at_fault) == ((), ("distance",), "both")
    assert verdict.first_contact is not None
    assert not verdict.first_contact.nuplan_at_fault


def test_records_of_before_are_read() -> None:
    drive, road, world, _ = CASES["lost load, 13"]()
    verdict = judge(road, drive, world)
    data = verdict.to_json()
    for each in data["incidents"]:
        each["contact"]["at_fault"] = each["contact"].pop("nuplan_at_fault")
    for name in ("law", "avoidable", "at_fault", "least_gap", "least_ttc"):
        del data[name]
    found = Verdict.from_json(data)
    assert isinstance(found.first_contact, Contact)
    assert (found.is_at_fault, found.first_contact.nuplan_at_fault, found.at_fault) == (True, True, None)
