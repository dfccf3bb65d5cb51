"""Could a careful driver have avoided it? Answers worked out on paper and by other integrations, and some of
the program of the European Commission's Joint Research Centre (ec-jrc/JRC-FSM)."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from roadgpt.brief.plan import read_scene
from roadgpt.brief.scenarios import scenario
from roadgpt.brief.scene import Scene
from roadgpt.cli.junit import write_junit
from roadgpt.cli.screen import Row
from roadgpt.drive import Columns, Drive
from roadgpt.road import Limits, Road, World
from roadgpt.road.road import START
from roadgpt.run import Setup, perform
from roadgpt.traffic import STEP, Tracks
from roadgpt.traffic.rehearsal import rehearsed
from roadgpt.verdict import Verdict, judge
from roadgpt.verdict.careful import CAREFUL, DRIVERS, Moment, drive_on, stopping_distance
from staged import BOX, among, driven, level, straight, tracks

ROAD = level(0, 600)
G, LANE = 9.81, -2.0  # m/s^2; m, the middle of the lane
NAMES = ("careful driver", "Reg157", "FSM", "RSS")


def world(scene: str = "", limit: float = 60.0) -> World:
    return World(limits=Limits(speed_limit=limit), scene=read_scene(scene) if scene else World().scene)


def verdict(drive: Drive, of: World | None = None, road: Road = ROAD) -> Verdict:
    found = judge(road, drive, of or world())
    assert found.cause == "collision"
    return found


def scene(own: Any, duration: float = 8.0, **others: Any) -> Drive:
    return among(driven(own, duration, ROAD), tracks(duration, **others))


def braked(speed: float, delay: float, released: float, jerk: float, most: float) -> float:
    """The way to a stop, step by step."""
    way, time, step = 0.0, 0.0, 1e-4
    while speed > 0:
        rate = released if time < delay else min(released + jerk * (time - delay), most)
        speed -= rate * step
        way += max(speed, 0.0) * step
        time += step
    return way


WAYS = {  # of the four after they have seen somebody standing in their strip
    "careful driver": lambda v: braked(v, 0.75, 0.4, 12.65, 0.774 * G),
    "Reg157": lambda v: braked(v, 0.35, 0.0, np.inf, 6.0),
    "FSM": lambda v: braked(v, 0.75, 0.0, 12.65, 0.774 * G),
    "RSS": lambda v: braked(v, 0.75, 0.0, 12.65, 0.774 * G),
}


@pytest.mark.parametrize("speed", [3.0, 5.0, 10.0, 20.0, 36.0])
def test_the_stopping_distance_of_the_careful_driver(speed: float) -> None:
    assert stopping_distance(speed) == pytest.approx(WAYS["careful driver"](speed), abs=0.01)


@pytest.mark.parametrize("speed", [8.0, 25.0])
def test_somebody_who_is_suddenly_there_is_avoided_from_the_stopping_distance_on(speed: float) -> None:
    """He stands in the lane, is not there before, and beyond it no model can stop."""
    needed = {name: way(speed) for name, way in WAYS.items()}
    front = 20 + speed * 3.0 + BOX.length / 2  # at 3 s
    for away in {round(way + by, 1) for way in needed.values() for by in (-0.5, 0.5)} | {5.0}:
        child = straight(front + away + 0.25, LANE, 0.0, 0.0)
        drive = scene(straight(20, LANE, 0, speed), 3 + away / speed + 2, child_1=("child", child))
        assert drive.others is not None
        states = drive.others.states.copy()
        states[:30] = np.nan
        found = verdict(among(drive, Tracks(drive.others.actors, states)))
        expected = tuple(name for name, way in needed.items() if way < away)
        assert found.avoided_by == expected, away
        assert found.outcome == ("FAIL" if expected else "UNAVOIDABLE")
        if "careful driver" in expected:
            short = away - needed["careful driver"]
            said = float(found.description.split("stops ")[1].split(" m short")[0])
            assert said == pytest.approx(short, abs=0.3)


def lead(x: float, speed: float, brakes: float, since: float) -> Any:
    """Somebody who brakes to a stop."""

    def motion(time: Any) -> Any:
        for_ = np.clip(time - since, 0, speed / brakes)
        return x + speed * (np.minimum(time, since) + for_) - brakes * for_**2 / 2, LANE + 0 * time, 0 * time

    return motion


def test_a_lead_that_brakes_to_a_stop() -> None:
    """With 6 m/s2 from 50 km/h: whether the careful driver, who takes note 0.4 s later or at a time to
    collision of 2 s, stops behind it; and who followed at 1 s kept less than the 1.5 s of R157."""
    v = 50 / 3.6
    seen = set()
    for headway in np.arange(0.8, 2.01, 0.2):
        gap = v * headway
        time = np.arange(0, 5, 1e-4)
        closing = np.minimum(6 * time, v)
        behind = gap - np.cumsum(closing) * 1e-4
        noted = min(0.4, float(time[np.argmax(behind <= 2 * closing)]))
        room = gap + v**2 / 12 - v * noted - WAYS["careful driver"](v)
        if abs(room) < 0.5:
            continue
        own = straight(10, LANE, 0, v)
        found = verdict(scene(own, 10, car_1=("car", lead(10 + gap + 4.7, v, 6.0, 4.0))))
        assert ("careful driver" in (found.avoided_by or ())) == (room > 0), headway
        assert ("m of UN R157" in found.description) == (headway < 1.45), headway
        assert found.outcome == "FAIL"
        seen.add(room > 0)
    assert seen == {True, False}


CELLS = """
60 20 1.0: .... ..xx xxxx x... .... .... ....
60 40 1.5: xxxx x... .... .... .... .... ....
50 10 2.0: .... xxxx xxxx .... .... .... ....
40 30 1.0: xxxx .... .... .... .... .... ....
50  0 3.0: xxxx xxxx xxxx x.x. .... .... ....
30 10 0.5: .... xx.. x... .... .... .... ....
"""
"""Own and other speed in km/h, m/s sideways; then for gaps of 0 to 60 m, who of NAMES collides there."""


@pytest.mark.parametrize("row", CELLS.strip().splitlines())
def test_cells_of_the_cut_in_grid_of_the_joint_research_centre(row: str) -> None:
    about, cells = row.split(":")
    own, its, sideways = (float(each) for each in about.split())
    own, its, step, length, width = own / 3.6, its / 3.6, 0.1, 4.3, 1.9
    number = np.arange(350)
    moving = number < 10 * 3.5 // sideways + 1
    t = 3.5 - sideways * step * np.cumsum(moving)
    for gap, told in zip(range(0, 61, 10), cells.split(), strict=True):
        x = gap + its * step * (number + 1) - own * step  # from the tested car's first place
        for driver, letter in zip(DRIVERS, told, strict=True):

            def seen(i: int, place: float, speed: float, gained: float, x: Any = x) -> Moment:
                beside, drift = abs(t[i]) - width, sideways * moving[i]
                return Moment(x[i] - place, beside, 2 * length, speed, gained, its, drift, beside <= 0)

            places, _ = drive_on(driver, seen, [own] * 350, step)
            over = (np.abs(t) < width) & (np.abs(x + length - places) < length)
            assert over[:-1].any() == (letter == "x"), (gap, driver.said)


def cuts_in(x: float, speed: float, sideways: float, since: float) -> Any:
    return lambda time: (
        x + speed * time, np.maximum(2.0 - sideways * np.maximum(time - since, 0), LANE), 0 * time
    )  # fmt: skip


def test_cut_ins_and_blows_from_behind() -> None:
    own = straight(10, LANE, 0, 16.0)
    near = verdict(scene(own, car_1=("car", cuts_in(22, 10.0, 3.0, 1.0))))
    assert (near.outcome, near.avoided_by, near.kept, near.failed) == ("UNAVOIDABLE", (), False, False)
    assert near.description.endswith(
        "; not avoidable by the careful driver of UN R157: careful driver collides, Reg157 collides, FSM "
        "collides, RSS collides"
    )
    assert near.at_xy is not None
    assert Verdict.from_json(json.loads(json.dumps(near.to_json()))) == near
    far = verdict(scene(own, car_1=("car", cuts_in(50, 10.0, 1.0, 1.0))))
    assert (far.outcome, far.avoided_by) == ("FAIL", NAMES)
    assert "; avoidable by the careful driver of UN R157: careful driver avoids it, Reg" in far.description
    behind = verdict(scene(straight(50, LANE, 0, 5), car_1=("car", straight(30, LANE, 0, 15))))
    assert (behind.outcome, behind.at_fault) == ("UNAVOIDABLE", "other")
    head_on = verdict(scene(own, car_1=("car", straight(180, LANE, np.pi, 14))))
    assert head_on.outcome == "UNAVOIDABLE"


def brakes(rate: float, x: float = 100.0, v: float = 15.0) -> Any:
    """Even motion at v, and after 3 s braking."""
    return lambda time: (
        x + v * time - rate * np.clip(time - 3.0, 0, v / rate) ** 2 / 2
        - np.maximum(time - 3.0 - v / rate, 0) * v, LANE, 0
    )  # fmt: skip


def test_who_brakes_for_nothing_and_is_hit_from_behind() -> None:
    """Somebody follows at 15 m and does not react. The way to a stop from 15 m/s with 3.5 m/s2, and of one
    second more, is 47 m; the front is at 147 m then."""
    follows = {"car_1": ("car", straight(80, LANE, 0, 15))}
    bend = Road.through([[x, 0 if x < 170 else (x - 170) ** 2 / 120] for x in range(0, 261, 5)])
    for rate, more, limit, avoidable in (
        (6.0, {}, 60.0, True),
        (4.0, {}, 60.0, True),
        (3.0, {}, 60.0, False),  # as cruise control may
        (6.0, {"van_1": ("van", straight(180, LANE, 0, 0))}, 60.0, False),
        (6.0, {"van_1": ("van", straight(180, -LANE, 0, 0))}, 60.0, True),  # in the other lane
        (6.0, {"van_1": ("van", straight(260, LANE, 0, 15))}, 60.0, True),  # far ahead
        (6.0, {"van_1": ("van", straight(140, LANE, 0, 15))}, 60.0, True),  # 2 s ahead, and as fast
        (6.0, {"van_1": ("van", straight(117, LANE, 0, 15))}, 60.0, False),  # less than a second ahead
        (6.0, {"van_1": ("van", brakes(6.0, 140.0))}, 60.0, False),  # brakes, too
        (6.0, {"adult_1": ("adult", straight(165, -8, np.pi / 2, 1.5))}, 60.0, False),  # walks into the way
        (6.0, {"adult_1": ("adult", straight(165, -8, np.pi / 2, 0.0))}, 60.0, True),  # stands beside it
        (6.0, {}, 10.0, False),
    ):
        found = verdict(scene(brakes(rate), **follows, **more), world(limit=limit))
        assert found.first_contact is not None
        assert (found.outcome, found.first_contact.face) == ("FAIL" if avoidable else "UNAVOIDABLE", "rear")
        told = f"avoidable: it had braked with {rate:.1f} m/s2 and nothing in its way called for it"
        assert (f"; both at fault; {told}; " in found.description) == avoidable, (rate, more, limit)
        assert found.at_fault == ("both" if avoidable else "other"), (rate, more, limit)
    faster = scene(brakes(6.0), car_1=("car", straight(71, LANE, 0, 18)))  # would have come anyway
    assert verdict(faster).outcome == "UNAVOIDABLE"
    drive = among(driven(brakes(6.0), 8.0, bend), tracks(8.0, **follows))
    assert verdict(drive, road=bend).outcome == "UNAVOIDABLE"


@pytest.mark.parametrize("control", ["priority", "yield", "stop", "lights"])
def test_braking_before_a_junction_is_for_something_if_one_gives_way_there(control: str) -> None:
    world = World(limits=Limits(speed_limit=60.0))
    plan = f"straight 180 // crossroads straight {control} // straight 80"
    road = perform(plan, 1, world, Setup(reader="plan", drives=False)).road
    assert road is not None
    s = np.linspace(0.0, 170.0, 681)
    (x, y, _), heading = road.at(s, LANE).T, road.heading(s)

    def along(motion: Any) -> Any:
        return lambda time: tuple(np.interp(motion(time)[0], s, each) for each in (x, y, heading))

    others = tracks(6.0, car_1=("car", along(straight(75, LANE, 0, 15))))
    drive = among(driven(along(brakes(6.0, 95.0)), 6.0, road), others)
    assert judge(road, drive, world).failed == (control == "priority")


def test_a_cut_in_is_perceived_before_it_reaches_the_strip() -> None:
    """With 60 and 20 km/h, 30 m and 1 m/s sideways, the careful driver is just in time if it takes note 0.4 s
    after 0.375 m, and too late by far when the other reaches into its strip, after 2.17 of 4 m."""
    closing, delay = 40 / 3.6, (0.375 / 1.0 + 0.4, 2.17 / 1.0)
    room = [30 - closing * each - braked(closing, 0.75, 0.4, 12.65, 0.774 * G) for each in delay]
    assert room[0] > 0.5
    assert room[1] < -10
    found = verdict(
        scene(straight(10, LANE, 0, 60 / 3.6), car_1=("car", cuts_in(44.7 + closing, 20 / 3.6, 1.0, 1.0)))
    )
    assert "careful driver" in (found.avoided_by or ())


@pytest.mark.parametrize("is_stopped", [True, False])
def test_who_is_stopped_by_the_contact_would_have_gone_on(is_stopped: bool) -> None:
    """Somebody crosses with 3 m/s and is hit near its rear, 0.3 s before it would have left the strip; it is
    there only from 2.3 s on, too late to stop. If the contact made it brake, it is taken to go on then, and
    not if it would have braked anyway."""
    brakes = 5.0

    def crosses(time: Any) -> Any:
        after = np.clip(time - 4.0, 0, 3 / brakes)
        y = -1.9 + 2.35 + 3 * np.minimum(time - 4, 0) + 3 * after - brakes * after**2 / 2
        return 60.0 + 0 * time, y, np.pi / 2 + 0 * time

    v = 50 / 3.6
    own = straight(60 - 0.9 - BOX.length / 2 - v * 4.01, LANE, 0, v)
    drive = scene(own, 7.0, car_1=("car", crosses))
    assert drive.others is not None
    states = drive.others.states.copy()
    states[:23] = np.nan
    others = Tracks(drive.others.actors, states)
    found = verdict(replace(drive, others=others, stopped=("car 1",) if is_stopped else ()))
    assert found.at_time == pytest.approx(4.01, abs=0.01)
    assert ("careful driver" in (found.avoided_by or ())) == is_stopped


def test_who_was_partly_outside_its_lane_could_have_avoided_it() -> None:
    oncoming = {"car_1": ("car", straight(150, 0.6, np.pi, 14.0))}
    for y, outcome in ((-1.1, "UNAVOIDABLE"), (-0.7, "FAIL")):  # 0 and 12 % of 1.86 m beyond the marking at 0
        found = verdict(scene(straight(10, y, 0, 14.0), **oncoming))
        assert (found.outcome, found.avoided_by) == (outcome, ())
        assert ("avoidable: it was outside its lane with" in found.description) == (outcome == "FAIL")


def test_a_driver_begins_when_the_other_is_visible() -> None:
    """A child stands behind a van, then walks into the way: the farther the van stands off, the sooner it is
    seen to walk."""
    v, walks, out = 50 / 3.6, 1.6, []
    child = ("child", lambda time: (70 + 0 * time, np.maximum(-2.6 + walks * (time - 4), -6.3), np.pi / 2))
    own = straight(70 - BOX.length / 2 - v * 4, LANE, 0, v)
    for away in (0.4, 3.0, 8.0, 30.0):
        van = ("van", straight(70 - away - 3.25, -5.5, 0.0, 0.0))
        out.append(verdict(scene(own, child_1=child, van_1=van)).avoided_by or ())
    assert (out[0], out[-1]) == ((), NAMES)
    assert [len(each) for each in out] == sorted(len(each) for each in out)
    low = ("barrier", straight(69.3, -5.5, 0.0, 0.0))  # 1 m high: one sees over it
    assert verdict(scene(own, child_1=child, barrier_1=low)).avoided_by == NAMES


def test_a_careful_driver_stops_within_its_sight() -> None:
    """Whoever stands in the lane is avoidable in any fog and behind any crest, because it would have come
    slowly enough."""
    for conditions, kind in (("fog 30", "car"), ("fog 60", "car"), ("fog 100", "car"), ("night", "adult")):
        there = {"it": (kind, straight(250, LANE, 0, 0))}
        found = verdict(scene(straight(10, LANE, 0, 36.0), 9, **there), world(conditions))
        assert "careful driver" in (found.avoided_by or ())
        said = float(found.description.split("stops ")[1].split(" m short")[0])
        assert said == pytest.approx(0.1, abs=0.3)  # it uses all of its sight
    # without fog it is seen from the start, and a careful driver stops far away
    clear = verdict(scene(straight(10, LANE, 0, 36.0), 9, car_1=("car", straight(250, LANE, 0, 0))))
    assert float(clear.description.split("stops ")[1].split(" m short")[0]) > 100


def test_a_crest_hides() -> None:
    """A car stands behind a crest; from 1.2 m one sees the top of it, 1.5 m high, over the vertex where the
    line of sight touches the ground."""
    crest = 400.0  # m, radius of the vertical curve
    x = np.arange(0.0, 601.0, 5.0)
    z = -((x - 300) ** 2) / (2 * crest)
    road = Road.through(np.column_stack([x, 0 * x, z]))
    own = driven(straight(100, LANE, 0, 25.0), 9.0, road)
    height = np.interp(own["x"], x, z) + BOX.height
    columns = {**own.columns, "z": height}
    there = tracks(9.0, car_1=("car", straight(300, LANE, 0, 0)))
    drive = among(replace(own, columns=Columns(columns)), there)
    eye = np.sqrt(2 * crest * 1.2) + np.sqrt(2 * crest * 1.5)  # m, over which one sees the other on a crest
    assert 60 < eye < 70
    found = verdict(drive, road=road)
    assert "careful driver" in (found.avoided_by or ())
    assert float(found.description.split("stops ")[1].split(" m short")[0]) < 20
    flat = Road.through(np.column_stack([x, 0 * x, 0 * x]))
    open_ = verdict(among(driven(straight(100, LANE, 0, 25.0), 9.0, flat), there), road=flat)
    assert float(open_.description.split("stops ")[1].split(" m short")[0]) > 100


def test_the_limit_binds_the_drivers() -> None:
    child = {"child_1": ("child", straight(20 + 25 * 3 + BOX.length / 2 + 30, LANE, 0.0, 0.0))}
    drive = scene(straight(20, LANE, 0, 25.0), 5.0, **child)
    assert drive.others is not None
    states = drive.others.states.copy()
    states[:30] = np.nan
    drive = among(drive, Tracks(drive.others.actors, states))
    assert verdict(drive).avoided_by == ()
    assert "careful driver" in (verdict(drive, world(limit=50 / 3.6)).avoided_by or ())


def test_junit_skips_what_was_unavoidable(tmp_path: Any) -> None:
    rows = [Row("a", "UNAVOIDABLE", "nobody could", cause="collision"), Row("b", "FAIL", "it could")]
    assert rows[0].outcome == "UNAVOIDABLE"
    write_junit(tmp_path / "it.xml", [("all", {}, rows)])
    text = (tmp_path / "it.xml").read_text()
    assert 'failures="1"' in text
    assert 'skipped="1"' in text
    assert '<skipped message="nobody could"' in text


def test_careful_is_the_first() -> None:
    assert DRIVERS[0] is CAREFUL
    assert tuple(each.said for each in DRIVERS) == NAMES


STANDS = {"car_2": ("car", straight(120, LANE, 0, 0))}
ESCAPES = ("car", lambda time: (40 + 15 * time, np.minimum(LANE + 1.5 * np.maximum(time - 3, 0), 1.5), 0))


@pytest.mark.parametrize(
    ("others", "criterion"),
    [
        ({"car_1": ("car", cuts_in(22, 10.0, 3.0, 1.0))}, "r157"),
        ({"car_1": ("car", lead(40, 16, 6.0, 2.0))}, "r157"),  # brakes harder than 5 m/s2
        ({"car_1": ("car", lead(40, 16, 4.0, 2.0))}, "any"),  # as in Euro NCAP's CCRb
        ({"car_1": ESCAPES, **STANDS}, "r157"),  # leaves the lane before who stands there
        (STANDS, "any"),
        ({"car_1": ("car", straight(40, LANE, 0, 5))}, "any"),
        ({"adult_1": ("adult", lambda time: (90 + 0 * time, -10 + 1.6 * time, np.pi / 2))}, "any"),
        ({"car_1": ("car", straight(180, LANE, np.pi, 14))}, "any"),
    ],
)
def test_the_criterion_is_that_of_un_r157_for_its_kinds_and_any_for_all_others(
    others: Any, criterion: str
) -> None:
    """Whoever is named has to avoid it; the verdict tells of all four, and is read again with it."""
    drive = scene(straight(10, LANE, 0, 16.0), **others)
    usual = verdict(drive)
    assert usual.criterion == criterion
    assert Verdict.from_json(json.loads(json.dumps(usual.to_json()))) == usual
    by = {"r157": NAMES[:1], "reg157": NAMES[1:2], "fsm": NAMES[2:3], "rss": NAMES[3:], "any": NAMES}
    for name, whom in by.items():
        found = verdict(drive, world().changed(speed_limit=60.0, avoidable=name))
        assert (found.criterion, found.avoided_by) == (name, usual.avoided_by)
        is_avoidable = not {*whom}.isdisjoint(found.avoided_by or ())
        assert (found.outcome == "FAIL") == (is_avoidable or "avoidable: it" in found.description)
        assert all(f"{each} " in found.description.partition("avoidable by")[2] for each in NAMES)


def stops(speed: float, name: str, given: Any) -> float:
    """The way to a stop of one of the four, step by step, where ``given(way, speed)`` m/s2 are the most."""
    delay, released, jerk, most = {
        "careful driver": (0.75, 0.4, 12.65, 0.774 * G), "Reg157": (0.35, 0.0, np.inf, 6.0),
        "FSM": (0.75, 0.0, 12.65, 0.774 * G), "RSS": (0.75, 0.0, 12.65, 0.774 * G),
    }[name]  # fmt: skip
    way, time, step = 0.0, 0.0, 1e-3
    while speed > 0 and way < 400:
        rate = released if time < delay else min(released + jerk * (time - delay), most)
        speed -= min(rate, given(way, speed)) * step
        way += max(speed, 0.0) * step
        time += step
    return way


def climb(grade: float) -> Road:
    return Road.through([[x, 0, 100 + grade * x] for x in range(0, 601, 20)])


@pytest.mark.parametrize(
    ("of", "road", "given"),
    [
        ({"friction": 0.1}, ROAD, lambda way, v: 0.1 * G),
        ({"friction": 0.35}, ROAD, lambda way, v: 0.35 * G),
        ({"friction": 0.6}, climb(-0.12), lambda way, v: (0.6 - 0.12) * G / np.hypot(1, 0.12)),
        ({"friction": 0.6}, climb(0.12), lambda way, v: (0.6 + 0.12) * G / np.hypot(1, 0.12)),
        ({"friction": 0.1}, climb(-0.12), lambda way, v: -0.02 * G / np.hypot(1, 0.12)),
        (
            {"scene": "slippery mu=0.1 s=85 len=30"},
            ROAD,
            lambda way, v: G * (0.1 if 85 < 75 - BOX.length / 2 + way < 115 else 1),
        ),
    ],
)
def test_nobody_brakes_harder_than_friction_and_grade_allow(of: Any, road: Road, given: Any) -> None:
    """He stands in the lane, is not there before, and beyond it no model can stop."""
    speed = 60 / 3.6
    needed = {name: stops(speed, name, given) for name in NAMES}
    for away in {round(way + by, 1) for way in needed.values() for by in (-1.0, 1.0) if way < 250} or {250.0}:
        begins = 75 - speed * 3 - BOX.length / 2  # its front is at 75 m when he is there, at 3 s
        child = straight(75 + away + 0.25, LANE, 0.0, 0.0)
        made = among(
            driven(straight(begins, LANE, 0, speed), 5 + away / speed, road),
            tracks(5 + away / speed, c_1=("child", child)),
        )
        assert made.others is not None
        states = made.others.states.copy()
        states[..., 2] = road.at(75 + away)[2]
        made = replace(made, columns=Columns({**made.columns, "z": road.at(made["x"])[:, 2] + BOX.height}))
        states[:30] = np.nan
        found = verdict(
            among(made, Tracks(made.others.actors, states)), world().changed(speed_limit=60.0, **of), road
        )
        assert found.avoided_by == tuple(name for name, way in needed.items() if way < away), away


def test_a_bend_takes_its_part_of_the_friction_circle() -> None:
    """On a radius of 60 m at 50 km/h 3.2 of 3.5 m/s2 go sideways at first, so that 1.3 are left to brake."""
    road = Road.through([[60 * np.sin(a), 60 - 60 * np.cos(a)] for a in np.arange(0, 3.1, 0.1)])
    speed, radius = 50 / 3.6, 60 - LANE

    def along(x: float, v: float) -> Any:
        def motion(time: Any) -> Any:
            a = (x + v * np.asarray(time)) / radius
            return radius * np.sin(a), 60 - radius * np.cos(a), a

        return motion

    def given(way: float, v: float, bend: float) -> float:
        return float(np.sqrt(max((0.36 * G) ** 2 - (v * v * bend) ** 2, 0)))

    bent = stops(speed, "careful driver", lambda way, v: given(way, v, 1 / 60))
    plain = stops(speed, "careful driver", lambda way, v: given(way, v, 0))
    assert bent > plain + 4
    for away in (plain + 1, bent - 1, bent + 1):
        begins = 20.0
        front = begins + speed * 2 + BOX.length / 2
        made = among(
            driven(along(begins, speed), 3 + away / speed, road),
            tracks(3 + away / speed, c_1=("child", along(front + away + 0.25, 0.0))),
        )
        assert made.others is not None
        states = made.others.states.copy()
        states[:20] = np.nan
        found = verdict(among(made, Tracks(made.others.actors, states)), world().changed(friction=0.36), road)
        assert ("careful driver" in (found.avoided_by or ())) == (away > bent), away


@pytest.mark.parametrize(("scene_text", "is_doing"), [("", True), ("car ahead gap=15 v=50", False)])
def test_a_gap_that_the_scene_itself_sets_is_not_the_cars_doing(scene_text: str, is_doing: bool) -> None:
    """It follows 15 m behind who then brakes; the regulation has 20.8 m at 50 km/h."""
    v = 50 / 3.6
    drive = scene(straight(10, LANE, 0, v), 10, car_1=("car", lead(10 + 15 + 4.5, v, 6.0, 4.0)))
    assert ("m of UN R157" in verdict(drive, world(scene_text)).description) == is_doing
    # but it is, if it came nearer by itself
    nearer = lambda time: (10 + v * time + np.clip(time - 1, 0, 3) * 1.5, LANE, 0)  # noqa: E731
    drive = scene(nearer, 12, car_1=("car", lead(10 + 19 + 4.5, v, 6.0, 7.0)))
    told = verdict(drive, world(scene_text)).description
    kept, least = told.partition("it kept ")[2].partition(" m of UN")[0].split(" m, not the ")
    assert float(kept) < float(least)


@pytest.mark.parametrize("name", ["CCRs", "CCRm", "CCRb"])
def test_the_test_robot_could_have_avoided_whoever_is_ahead(name: str) -> None:
    """At the ends of speeds and places of impact of the standard grids, moved evenly as the robot is;
    ``benchmarks/bench_avoidable.py --driver robot`` drives all points."""
    points = [*scenario(f"ncap:{name}").points("standard", with_road=False)]
    speeds = [each.values["ego"] for each in points]
    for point in points:
        if (point.values["ego"], point.values["impact"]) not in ((min(speeds), 0), (max(speeds), 100)):
            continue
        v = float(point.values["ego"]) / 3.6
        road = Road.through([[x, 0] for x in np.arange(0, 25 * v + 150, 20)])
        among_them = world().changed(scene=point.onto(Scene()), avoidable=point.avoidable)
        others = rehearsed(road, among_them, 1)
        assert others is not None
        tracked = others.tracks()
        drive = driven(straight(START, LANE, 0, v), STEP * (len(tracked) - 1), road)
        found = verdict(among(drive, tracked), among_them, road)
        assert found.outcome == "FAIL", (str(point), found.description)
