"""The mover ``script``: what actors of scenes do, against formulas and against shapes of another library."""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import shapely
from shapely import LineString, Point, Polygon

from boxed import corners
from grids import diagonal, pairs
from roadgpt.errors import UsageError
from roadgpt.road import Design, Road, Segment, World, build
from roadgpt.run import Setup, perform
from roadgpt.traffic import STEP, Actor, TestedCar, begin
from roadgpt.traffic.actor import Size
from roadgpt.traffic.rehearsal import rehearsed

TestedCar.__test__ = False
BOX = Size(4.9, 1.86, 1.4)
WORLD = World.model_validate({"lanes": "2+2", "lane_width": 3.5, "map_size": 2000})
STRAIGHT = build(
    Design(
        starting_point=(10, 400, 0),
        theta=0,
        segments=tuple(Segment(distance=100, direction="straight", incline=0) for _ in range(9)),
    )
)
CURVED = build(
    Design(
        starting_point=(300, 300, 0),
        theta=20,
        segments=(
            Segment(distance=80, direction="straight", incline=3),
            Segment(distance=180, direction="left", incline=0, turn_degrees=50),
            Segment(distance=180, direction="right", incline=-4, turn_degrees=-60),
            Segment(distance=200, direction="straight", incline=0),
        ),
    )
)
Speed = Callable[[float], float]


class Shown(NamedTuple):
    """What was seen of a drive: a row x, y, heading, speed and metres for each sample of the tested car."""

    car: np.ndarray
    actors: tuple[Actor, ...]
    states: np.ndarray
    path: LineString

    def along(self, who: int) -> np.ndarray:
        """How far each sample of an actor is along the tested car's lane."""
        places = self.states[:, who, :2]
        s = shapely.line_locate_point(self.path, shapely.points(np.nan_to_num(places)))
        return np.where(np.isnan(places[:, 0]), np.nan, s)

    def left(self, who: int) -> np.ndarray:
        """How far each sample of an actor is to the left of the tested car's lane's middle."""
        s = np.nan_to_num(self.along(who))
        a, b = (
            shapely.get_coordinates(shapely.line_interpolate_point(self.path, s + d)) for d in (-0.05, 0.05)
        )
        (dx, dy), (x, y) = (b - a).T, (self.states[:, who, :2] - a).T
        return np.asarray((dx * y - dy * x) / np.maximum(np.hypot(dx, dy), 1e-9))

    def gap(self, who: int) -> np.ndarray:
        apart = np.abs(self.along(who) - self.car[:, 4])
        return apart - (self.actors[who].size.length + BOX.length) / 2


def show(
    scene: str, road: Road = STRAIGHT, lasts: float = 20.0, seed: int = 1, speed: Speed | None = None,
    world: World = WORLD,
) -> Shown:  # fmt: skip
    """Drives a box along the middle of the tested car's lane, at its first speed or as ``speed`` says."""
    world = world.changed(scene=scene)
    traffic = begin(road, world, seed)
    assert traffic is not None
    s = np.linspace(0.0, road.length, int(road.length * 4))
    xyz = road.at(s, world.profile_of(road).middle(s))
    metres = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(xyz[:, :2], axis=0).T))])
    own, rows = 2.5, []
    for n in range(round(lasts / STEP) + 1):
        v = world.first_speed if speed is None else speed(n * STEP)
        x, y, station = (np.interp(own, metres, column) for column in (*xyz.T[:2], s))
        heading = float(road.heading(station))
        rows.append((x, y, heading, v, own))
        traffic.advance(TestedCar(x, y, heading, v, float(station), 0.0, BOX.length, BOX.width))
        own += v * STEP if speed is None else (speed(n * STEP) + speed((n + 1) * STEP)) / 2 * STEP
    tracks = traffic.tracks()
    return Shown(np.array(rows), tracks.actors, tracks.states[: len(rows)], LineString(xyz[:, :2]))


@pytest.mark.parametrize("road", [STRAIGHT, CURVED])
def test_a_leader_keeps_its_headway_and_brakes_by_the_formula(road: Road) -> None:
    seen = show("ego v=50; car ahead thw=1 v=50: brake 4 to=2 time=3", road, 10.0)
    v, low, time = 50 / 3.6, 2 / 3.6, STEP * np.arange(101)
    braked = np.clip(time - 3.0, 0.0, (v - low) / 4.0)
    speed = v - 4.0 * braked
    way = (
        v * np.minimum(time, 3.0) + v * braked - 2.0 * braked**2 + low * np.clip(time - 3.0 - braked, 0, None)
    )
    np.testing.assert_allclose(seen.states[:, 0, 4], speed, atol=2e-3)
    np.testing.assert_allclose(seen.along(0) - seen.along(0)[0], way, atol=0.05)
    assert seen.gap(0)[0] == pytest.approx(v, abs=0.02)
    np.testing.assert_allclose(seen.left(0), 0.0, atol=0.02)


@pytest.mark.parametrize(
    ("crossing", "ego", "road"),
    pairs(
        [
            ("adult", 5, "right", 25),
            ("adult", 8, "left", 50),
            ("bicycle", 15, "right", 50),
            ("child", 5, "left", 75),
        ],
        (20, 50, 80),
        (STRAIGHT, CURVED),
    ),
)
def test_who_crosses_is_hit_where_the_scene_says(
    crossing: tuple[str, float, str, float], ego: float, road: Road
) -> None:
    who, kmh, side, impact = crossing
    seen = show(f"ego v={ego}; {who} crossing {side} v={kmh} away=8 impact={impact}", road)
    for n in range(len(seen.car) - 1):
        for share in np.linspace(0.0, 1.0, 41)[:-1]:
            car = seen.car[n] + share * (seen.car[n + 1] - seen.car[n])
            other = seen.states[n, 0] + share * (seen.states[n + 1, 0] - seen.states[n, 0])
            if np.hypot(*(car[:2] - other[:2])) > 6.0:
                continue
            mine = Polygon(corners(np.array([car[0], car[1], 0.0, car[2]]), BOX))
            if mine.intersects(Polygon(corners(other, seen.actors[0].size))):
                cos, sin = math.cos(car[2]), math.sin(car[2])
                left = -(other[0] - car[0]) * sin + (other[1] - car[1]) * cos
                from_side = BOX.width / 2 + (left if side == "right" else -left)
                assert from_side == pytest.approx(impact / 100 * BOX.width, abs=0.05)
                assert other[4] * 3.6 == pytest.approx(kmh, abs=0.5)
                return
    pytest.fail("nobody was hit")


@pytest.mark.parametrize("place", ["", " gap=52"])
def test_a_cut_in_has_its_gap_and_is_as_fast_sideways_as_it_says(place: str) -> None:
    seen = show(f"ego v=60; car lane left{place} dv=-20: cut_in lat=2 gap=30")
    aside, rate = seen.left(0), np.diff(seen.left(0)) / STEP
    moving = np.flatnonzero(np.abs(rate) > 1e-2)
    # with a place of its own it begins at that gap, else its box is over the line there
    over = np.flatnonzero(aside - seen.actors[0].size.width / 2 <= 3.5 / 2)[0]
    first = moving[0] if place else over
    assert seen.gap(0)[first] == pytest.approx(30.0, abs=0.6)  # within a sample
    assert rate.min() == pytest.approx(-2.0, abs=0.02)
    assert rate.max() <= 1e-2
    assert (aside[0], aside[-1]) == (pytest.approx(3.5, abs=1e-3), pytest.approx(0.0, abs=1e-3))
    # half a cosine wave of this height with this greatest slope lasts pi / 2 * 3.5 / 2 s
    assert len(moving) * STEP == pytest.approx(math.pi / 2 * 3.5 / 2, abs=0.2)
    ahead = np.diff(seen.along(0)) / STEP
    np.testing.assert_allclose(ahead, 40 / 3.6, atol=0.02)


def test_before_its_trigger_one_matches_a_tested_car_that_changes_its_speed() -> None:
    def slower(time: float) -> float:
        return 14.0 - min(time, 3.0)

    head_on = show("ego v=50; car oncoming v=50 gap=250 impact=50", speed=slower, lasts=12.0)
    assert head_on.states[0, 0, 4] == pytest.approx(
        50 / 3.6, abs=1e-3
    )  # they meet anyway: it keeps its speed
    assert np.ptp(head_on.states[:, 0, 4]) < 0.01
    cut = show("ego v=50; car lane left v=40 : cut_in gap=15", speed=slower)
    over = int(np.flatnonzero(cut.left(0) - cut.actors[0].size.width / 2 <= 3.5 / 2)[0])
    assert cut.gap(0)[over] == pytest.approx(15.0, abs=0.7)


def test_somebody_who_crosses_at_a_gap_comes_over_the_line_there() -> None:
    seen = show("ego v=80; animal crossing left v=20: cross gap=40")
    over = int(np.flatnonzero(seen.left(0) - seen.actors[0].size.length / 2 <= 3.5 / 2)[0])
    apart = seen.along(0)[over] - seen.car[over, 4] - BOX.length / 2 - seen.actors[0].size.width / 2
    assert apart == pytest.approx(40.0, abs=80 / 3.6 * STEP)


@pytest.mark.parametrize(
    "scene",
    [
        "cones x5 ahead; truck ahead v=0; adult x2.. ahead v=0",
        "ego v=80; truck ahead v=80; lost_load ahead",
        "ego v=70; car ahead: cut_out; van ahead gap=60 v=0",
        "ego v=60; car ahead v=60; car ahead gap=70 v=20",
        "ego v=60; truck lane left gap=5 v=60; bus lane left gap=40 v=30",
    ],
)
def test_actors_in_one_lane_do_not_run_into_each_other(scene: str) -> None:
    seen = show(scene, lasts=25.0)
    for states in seen.states:
        there = [n for n in range(len(seen.actors)) if not np.isnan(states[n, 0])]
        boxes = [Polygon(corners(states[n], seen.actors[n].size)) for n in there]
        for n, one in enumerate(boxes):
            assert not any(one.intersects(other) for other in boxes[:n])


SCENES = (
    "car ahead gap=20..40 v=30..60: brake 3..6 to=10, speed to=50 accel=1..3, stop, keep",
    "truck ahead: swerve, swerve; bus behind: follow; motorcycle behind: overtake",
    "van lane left: cut_in accel=-2 for=3; car x2 behind: change_lane left, drift; car ahead: cut_out",
    "car lane left dv=-10..10: open_gap, stop 4 for=1, reverse; cones x3 beside right; animal crossing left",
    "car oncoming: wrong_way; van oncoming: drift; car oncoming gap=400: overtake; adult x2 crossing right",
    "car parked right: pull_out; bus beside right: pull_out; car ahead: wrong_way; car ahead gap=99: reverse",
)


@pytest.mark.parametrize(("scene", "road"), diagonal(SCENES, (STRAIGHT, CURVED)))
def test_motion_is_possible_and_headings_follow_it(scene: str, road: Road) -> None:
    seen = show(scene, road, 18.0, speed=lambda time: 15.0 - 3.0 * math.sin(time / 2))
    again = show(scene, road, 18.0, speed=lambda time: 15.0 - 3.0 * math.sin(time / 2))
    assert seen.states.tobytes() == again.states.tobytes()
    for n, actor in enumerate(seen.actors):
        there = np.flatnonzero(~np.isnan(seen.states[:, n, 0]))
        assert len(there) > 20, actor.name
        assert np.array_equal(there, np.arange(there[0], there[-1] + 1)), actor.name
        rows = seen.states[there, n]
        velocity = np.diff(rows[:, :2], axis=0) / STEP
        assert np.abs(np.diff(velocity, axis=0)).max() / STEP < 8.0, actor.name
        speed = np.hypot(*velocity.T)
        middle = (rows[1:, 4] + rows[:-1, 4]) / 2
        steady = np.sign(rows[1:, 4]) == np.sign(rows[:-1, 4])
        np.testing.assert_allclose(speed[steady], np.abs(middle)[steady], atol=0.25)
        moves = speed > 1.0
        course = np.arctan2(velocity[:, 1], velocity[:, 0]) + np.pi * (middle < 0)
        off = (rows[1:, 3] + rows[:-1, 3]) / 2 - course
        off = (off + np.pi) % (2 * np.pi) - np.pi
        assert np.abs(off[moves]).max(initial=0.0) < 0.06, actor.name


def test_what_is_drawn_depends_on_the_seed_alone() -> None:
    scene = "car x1..4 ahead gap=20..60 v=30..60; oncoming x2 v=40..60"
    first = [show(scene, lasts=1.0, seed=seed) for seed in range(6)]
    assert len({len(each.actors) for each in first}) > 1
    speeds = [each.states[0, 0, 4] for each in first]
    assert len(set(speeds)) == len(speeds)
    assert all(30 / 3.6 <= each <= 60 / 3.6 for each in speeds)


def test_several_alike_are_one_behind_another() -> None:
    ahead = show("ego v=50; car x3 ahead gap=30 v=36; cones x3 ahead gap=100", lasts=1.0)
    places = [ahead.along(n)[0] for n in range(6)]
    np.testing.assert_allclose(np.diff(places[:3]), 4.7 + 2.0 + 1.5 * 10.0, atol=0.01)
    np.testing.assert_allclose(np.diff(places[3:]), 0.4 + 2.0, atol=0.01)


def test_events_of_others_begin_actions() -> None:
    seen = show(
        "car ahead v=60 gap=40: brake 5 to=20 time=3.25; van lane left v=60 gap=30: brake 4 with car 1 brake;"
        "truck lane left v=60 gap=60: brake 4 after car 1 brake"
    )
    begins = [int(np.flatnonzero(np.diff(seen.states[:, n, 4]) < -1e-3)[0]) for n in range(3)]
    lasts = (60 - 20) / 3.6 / 5
    assert begins == [32, 32, int((3.25 + lasts) / STEP)]
    # the begin lies within the step: the speeds one sample later show it
    for n, (start, decel) in enumerate([(3.25, 5), (3.25, 4), (3.25 + lasts, 4)]):
        after = begins[n] + 1
        braked = decel * (after * STEP - start)
        assert seen.states[after, n, 4] == pytest.approx(60 / 3.6 - braked, abs=0.02)


@pytest.mark.parametrize("where", ["behind", "lane left"])
def test_who_overtakes_is_first_behind_and_then_before(where: str) -> None:
    seen = show(f"ego v=50; car {where}: overtake", lasts=25.0)
    apart = (seen.states[:, 0, :2] - seen.car[:, :2]) @ [np.cos(seen.car[0, 2]), np.sin(seen.car[0, 2])]
    there = ~np.isnan(apart)
    length = (4.7 + BOX.length) / 2
    assert apart[there][0] < -length
    assert apart[there][-1] > length
    beside = there & (np.abs(np.nan_to_num(apart)) < length)
    assert beside.any()
    assert np.abs(seen.left(0)[beside]).min() > (1.8 + BOX.width) / 2
    assert seen.left(0)[there][-1] == pytest.approx(0.0 if where == "behind" else 3.5, abs=0.01)


@pytest.mark.parametrize("actions", ["swerve, swerve", "swerve shift=0.6, keep 1, swerve shift=0.6"])
def test_a_second_swerve_goes_to_the_other_side(actions: str) -> None:
    left = show(f"car ahead gap=30: {actions}").left(0)
    there = np.flatnonzero(np.abs(left) > 0.3)
    first, second = np.split(there, np.flatnonzero(np.diff(there) > 1) + 1)
    assert (left[first] > 0).all()
    assert (left[second] < 0).all()


@pytest.mark.parametrize("seconds", [4, 7, 11])
def test_a_swerve_lasts_as_long_as_told(seconds: float) -> None:
    left = show(f"car ahead gap=30: swerve for={seconds}").left(0)
    away = STEP * np.flatnonzero(np.abs(left) > 0.005)
    assert 0.9 * seconds <= away[-1] - away[0] <= seconds + 0.1  # it leaves and comes back softly


@pytest.mark.parametrize("scene", ["car ahead; truck ahead gap=30", "truck ahead gap=30; car ahead"])
def test_who_is_told_where_to_be_is_there_and_others_make_room(scene: str) -> None:
    seen = show(scene, lasts=0.2)
    truck = [actor.kind for actor in seen.actors].index("truck")
    assert seen.gap(truck)[0] == pytest.approx(30, abs=0.05)


@pytest.mark.parametrize(("kind", "speed"), [("cones", ""), ("truck", " v=0"), ("adult", " v=0")])
@pytest.mark.parametrize("doing", ["", ": swerve time=15"])
def test_who_comes_upon_somebody_who_stands_stops_behind_them(doing: str, kind: str, speed: str) -> None:
    seen = show(f"car ahead gap=20 v=40{doing}; {kind} ahead gap=80{speed}", lasts=12, speed=lambda _: 4.0)
    apart = seen.along(1) - seen.along(0) - (seen.actors[0].size.length + seen.actors[1].size.length) / 2
    assert 0.0 < apart[-1] < 3.0
    assert apart.min() > 0.0


@pytest.mark.parametrize("later", ["turn_across", "cross", "run_light", "merge"])
def test_who_drives_ahead_cannot_do_later_what_needs_a_way_of_its_own(later: str) -> None:
    with pytest.raises(ValueError, match=f"who is ahead cannot {later}; that begins from"):
        WORLD.changed(scene=f"car ahead: keep 1, {later}")


def test_who_stands_where_it_is_to_go_does_not_go_on_turning() -> None:
    seen = show("ego v=40; car ahead gap=40: stop time=1, wrong_way for=2, keep", lasts=12.0)
    np.testing.assert_allclose(seen.left(0), 0.0, atol=0.01)
    np.testing.assert_allclose(seen.states[:, 0, 3], 0.0, atol=1e-3)


def test_places_across_the_lane() -> None:
    seen = show(
        "car ahead gap=30 overlap=40; truck ahead gap=60 impact=25; van lane left t=-0.4; "
        "adult ahead v=0 gap=110 t=-1.5; car oncoming impact=75",
        lasts=0.5,
    )
    own, left = BOX.width, [seen.left(n)[0] for n in range(5)]
    covered = min(own / 2, left[0] + 0.9) + own / 2
    assert left[0] < 0
    assert covered / own == pytest.approx(0.4, abs=0.01)
    assert left[1] == pytest.approx(-own / 4, abs=0.01)
    assert left[2] == pytest.approx(3.5 - 0.4, abs=0.01)
    assert left[3] == pytest.approx(-1.5, abs=0.01)
    assert left[4] == pytest.approx(own / 4, abs=0.01)


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ("truck ahead: brake 6 after turn 3", "names turn 3, but the road has 2 turns"),
        ("car ahead after junction 1", "names junction 1, but the road has no junction"),
        ("cones ahead gap=900", "but the road ends at"),
        ("van beside right s=0.7", "would stand at 1 m, but the road begins at 0 m"),
        ("car lane left: keep; van lane right: keep", "no second lane of the same direction on the"),
        ("car lane left gap=-150: cut_in", "before the begin of the road"),
        ("car lane left gap=20 v=60: cut_in gap=40", "never comes to where"),
        ("adult crossing right s=30: cross", "cannot be where it meets"),
        ("car junction left", "passes no junction"),
        ("car ramp: merge", "passes no ramp"),
        ("car behind: wrong_way", "drives away before it is on the road"),
        ("adult crosswalk: cross", "passes no crosswalk"),
        ("car lane left gap=30 v=0: brake, cut_in accel=0", "stands, so it never cuts in"),
    ],
)
def test_what_cannot_be_is_said_in_one_sentence(scene: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        begin(CURVED, WORLD.changed(scene=scene), 1)


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ("car ahead gap=30: brake time=60", "car 1 brakes: the drive ended before"),
        (
            "car ahead gap=30: keep 1, swerve gap=90",
            "car 1 swerves within its lane: what it waits for did not",
        ),
        (
            "van ahead gap=40; car lane left gap=9: cut_in after truck 1 stop; truck behind: stop time=60",
            "car 1 cuts in: what it waits for did not",
        ),
        ("car ahead gap=200 v=150: brake time=19", "car 1 brakes: it had left the road"),
        ("car behind gap=600 v=60: overtake", "car 1 overtakes: it was not on the road yet"),
        ("car ahead gap=30: brake 2, stop; adult crossing right", ""),
    ],
)
def test_what_of_a_scene_has_not_begun_is_said(scene: str, said: str) -> None:
    traffic = begin(STRAIGHT, WORLD.changed(scene=f"ego v=60; {scene}"), 1)
    assert traffic is not None
    for n in range(200):
        x, y, _ = STRAIGHT.at(10 + n * STEP * 16.7, -1.75)
        traffic.advance(TestedCar(x, y, 0.0, 16.7, 10 + n * STEP * 16.7, -1.75, *BOX[:2]))
    assert traffic.missed[:1] == () if not said else said in traffic.missed[0]


def test_a_vehicle_meets_a_tested_car_of_changing_speed_at_a_junction_and_slows_down_for_bends() -> None:
    plan = "straight 150 // crossroads straight none angle=90 // straight 150"
    run = perform(plan, 1, setup=Setup(reader="plan", drives=False))
    road, world = run.road, run.world
    assert road is not None

    def slower(time: float) -> float:
        return 11.0 - min(time, 4.0)

    seen = show("ego v=40; car junction right v=30: cross", road, 26.0, speed=slower, world=world)
    track = seen.states[:, 0, :2]
    meets = LineString(track[~np.isnan(track[:, 0])]).intersection(seen.path)
    there, here = np.linalg.norm(track - [meets.x, meets.y], axis=1), seen.path.project(meets)
    n = int(np.nanargmin(there))
    # Euro NCAP, CCCscp: the middle of the front meets a quarter of the other's length behind its front
    front = seen.car[:, 4] + BOX.length / 2 + 1.8 / 2
    at = np.interp(here, front, np.arange(len(front)))
    before = there[math.floor(at)] * (1 if at < n else -1)
    assert before == pytest.approx(4.7 / 4, abs=30 / 3.6 * STEP + 0.3)
    assert seen.states[n, 0, 4] * 3.6 == pytest.approx(30, abs=0.5)
    off = show("car ahead: turn_off right to=45", road, 20.0, world=world)
    rows = off.states[~np.isnan(off.states[:, 0, 0]), 0]
    sideways = np.abs(np.diff(rows[:, 3])) / STEP * rows[1:, 4]
    assert 5.0 < sideways.max() < 9.0  # 45 km/h through the whole bend would be more than 15
    assert rows[-1, 3] - rows[0, 3] == pytest.approx(-math.pi / 2, abs=0.05)


@pytest.mark.parametrize(
    ("way", "scene", "goes"),
    [  # from when on the tested car, at 20 km/h, is fast for a while, so that it is before the other
        ("right", "car junction left v=50: cross", 7.0),
        ("right", "car junction opposite v=20: turn_in", 8.0),
        ("straight", "truck junction right v=20: turn_in", 9.0),
    ],
)
def test_who_was_to_meet_the_tested_car_and_comes_behind_it_follows_as_a_driver(
    way: str, scene: str, goes: float
) -> None:
    plan = f"straight 70 // crossroads {way} none angle=90 // straight 150"
    run = perform(plan, 1, setup=Setup(reader="plan", drives=False))
    assert run.road is not None

    def speed(time: float) -> float:
        fast = 20 / 3.6 + min(max(time - goes, 0.0), 2.0) * 6.0
        return max(fast - max(time - goes - 2.5, 0.0) * 6.0, 3.0)

    seen = show(f"ego v=20; {scene}", run.road, 24.0, speed=speed, world=run.world)
    apart = [
        Polygon(corners(np.array([car[0], car[1], 0.0, car[2]]), BOX)).distance(
            Polygon(corners(other, seen.actors[0].size))
        )
        for car, other in zip(seen.car, seen.states[:, 0], strict=True)
        if other[0] == other[0]
    ]
    assert min(apart) > 1.0
    assert 3.0 < apart[-1] < 15.0  # it does come, and keeps 1 s and 1 m


def test_who_comes_from_behind_appears_when_its_place_is_on_the_road() -> None:
    seen = show("ego v=50; bus behind thw=1 v=50", lasts=8.0)
    first = int(np.flatnonzero(~np.isnan(seen.states[:, 0, 0]))[0])
    assert first > 0
    assert 6.0 - 0.02 <= seen.along(0)[first] < 6.0 + 50 / 3.6 * STEP  # half a bus is 6 m
    np.testing.assert_allclose(seen.gap(0)[first:], 50 / 3.6, atol=0.03)


@pytest.mark.parametrize("ahead", ["car ahead", "car ahead v=50; truck ahead"])
def test_who_has_nothing_more_to_do_leaves_where_the_road_ends(ahead: str) -> None:
    seen = show(f"ego v=50; {ahead}", lasts=70.0)
    end = Point(seen.path.coords[-1])
    there = seen.states[~np.isnan(seen.states[..., 0])]
    assert 1.0 < min(end.distance(Point(each[:2])) for each in there) < 10.0  # half a vehicle at least


@cache
def limited_dry(scene: str) -> list[tuple[str, bool]]:
    dry = rehearsed(STRAIGHT, WORLD.changed(scene=scene), 1)
    assert dry is not None
    return [*dry.limited.items()]


DOWN = Road.through([[x, 0, 100 - 0.12 * x] for x in range(0, 901, 20)])
LEVEL = 9.81 / np.hypot(1, 0.12)


@pytest.mark.parametrize(
    ("told", "place"),
    diagonal(
        [
            ("ego v=50; car ahead gap=40 v=50: brake 8 time=3", "car 1 brakes", "8.0"),
            ("ego v=50; car ahead gap=60 v=50: stop 7 for=4 time=3", "car 1 stops", "7.0"),
            ("ego v=50; car ahead gap=40 v=50: speed 90 accel=6 time=3", "car 1 changes its speed", "6.0"),
            ("ego v=50; car lane left gap=30 v=50: cut_in 3 time=3", "car 1 cuts in", "5.1"),
            ("ego v=50; car lane left gap=30 v=50: drift left 0.4 lat=1.4 time=3", "car 1 drifts", "9.8"),
        ],
        [(0.1, STRAIGHT), (0.35, STRAIGHT), (0.4, DOWN), (0.35, CURVED)],
        rows=11,
    ),
)
def test_nobody_accelerates_more_than_friction_and_grade_allow_and_that_is_said(
    told: tuple[str, str, str], place: tuple[float, Road]
) -> None:
    """Whatever a scene asks for; told with both numbers. At friction 1 it does what is asked for."""
    (scene, did, asked), (friction, road) = told, place
    world = WORLD.changed(friction=friction)
    seen = show(scene, road, 9.0, world=world)
    speed, heading = seen.states[:, 0, 4], np.unwrap(seen.states[:, 0, 3])
    slope = (0.12 if road is DOWN else 0.05 * (road is CURVED)) * LEVEL
    faster, turns = np.diff(speed) / STEP, np.diff(heading) / STEP * (speed[1:] + speed[:-1]) / 2
    most = friction * (LEVEL if road is DOWN else 9.81)
    assert np.nanmax(np.hypot(np.maximum(np.abs(faster) - slope, 0), turns)) < most + 0.15
    if did.split()[2] in ("brakes", "stops") and road is DOWN:
        assert -np.nanmin(faster) == pytest.approx(most - slope, abs=0.05)
    others = rehearsed(road, world.changed(scene=scene), 1)
    assert others is not None
    ((said, is_prescribed),) = others.limited.items()
    start, number = said.split(" with at most ")
    assert (start, is_prescribed) == (did, True)
    assert number.partition(" not ")[2].startswith(asked)
    assert f": friction is {friction:g}" in number
    assert all(" sideways" in said and not prescribed for said, prescribed in limited_dry(scene))


@pytest.mark.parametrize(("place", "most", "friction"), [(20, "2.0", "0.2"), (400, "4.9", "0.5")])
def test_friction_is_that_of_the_place_where_somebody_brakes(place: int, most: str, friction: str) -> None:
    scene = f"ego v=50; car ahead gap=40 v=50: brake 8 time=3; slippery s={place} len=300 mu=0.2"
    others = rehearsed(STRAIGHT, WORLD.changed(friction=0.5, scene=scene), 1)
    assert others is not None
    told = f"car 1 brakes with at most {most} m/s2, not 8.0: friction is {friction}"
    assert [*others.limited] == [told]


def test_a_scenario_that_prescribes_more_than_the_road_gives_is_invalid_before_driving() -> None:
    for friction, outcome in ((0.35, "INVALID"), (0.45, "FAIL")):
        setup = Setup(driver="robot", reader="plan", scenario="ncap:CCRb")
        run = perform("straight 400 | flat", 1, World().changed(friction=friction), setup)
        assert run.outcome == outcome
        if outcome == "INVALID":
            assert run.drive is None
            assert "car 1 brakes with at most 3.4 m/s2, not 4.0: friction is 0.35" in run.description
