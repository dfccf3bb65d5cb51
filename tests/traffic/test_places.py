"""Where others are and which ways they go; checked on the polygons of the lanes, with shapely."""

import math
import re
from functools import cache

import numpy as np
import pytest
import shapely

from roadgpt.brief.plan import read_scene
from roadgpt.errors import UsageError
from roadgpt.geometry.boxes import corners
from roadgpt.network import network_of
from roadgpt.network.lanes import lanes_of
from roadgpt.network.line import driven_line
from roadgpt.network.markings import strokes
from roadgpt.run import Setup, perform
from roadgpt.traffic import begin
from roadgpt.traffic.actor import SIZES
from roadgpt.traffic.lights import GREEN, RED
from roadgpt.traffic.places import offset_of, parked_rows, works_rows
from roadgpt.traffic.ways import way_of

CROSSROADS = "straight 150 // crossroads straight none angle=90 // straight 150"
PLANS = [
    "straight 300 | lanes=1 against=1",
    "straight 400 | lanes=3 against=3 divided",
    "turn left 90 r=50 | lanes=2 against=1",
    CROSSROADS,
    "straight 100 // crossroads left lights crosswalk // straight 100 | lanes=2 against=2",
    "straight 150 // crossroads straight turn_lane=left // straight 100",
    "straight 100 // t_junction left stop // straight 100",
    "straight 100 // roundabout exit=3 // straight 100 | lanes=2",
    "straight 200 // merge main // straight 300 | lanes=2",
    "| lanes=2 len=200 // lane_drop // straight 150",
    "map columns=3 rows=2",
]
PLANS += [f"{plan} || left_hand" for plan in (CROSSROADS, "straight 80 // roundabout exit=2")]
ROLES = [
    "car junction left", "car junction right: run_sign", "car junction opposite", "car junction: run_light",
    "car junction: turn_in", "car oncoming: turn_across", "car roundabout", "car ramp: merge",
    "car ahead: turn_off", "car behind: turn_off right", "car beside: turn_in", "adult crossing left",
    "bicycle crossing right away=6", "child crosswalk",
]  # fmt: skip


@cache
def made(plan):
    run = perform(plan, 1, setup=Setup(reader="plan", drives=False))
    assert run.is_valid, run.description
    lanes = lanes_of(network_of(run.road, run.world))
    return run.road, run.world, [each for each in lanes if each.kind == "driving"]


def role(text):
    return read_scene(text).actors[0]


def way(plan, text, near=30.0):
    road, world, _ = made(plan)
    try:
        return way_of(role(text), near, road, world, 6.0 if "away" in text else None)
    except UsageError as error:
        said = str(error)
    assert said[0].islower()
    assert len(said.splitlines()) == 1
    assert len(said) < 160
    return None


@cache
def tree(plan):
    return shapely.STRtree([lane.area.buffer(0.02) for lane in made(plan)[2]])


def directions(plan, points):
    """The lanes that hold each point, and how far off their direction the point's heading is."""
    lanes, found = made(plan)[2], [[] for _ in points]
    which, within = tree(plan).query(shapely.points(points[:, :2]), predicate="intersects")
    for n in np.unique(within):
        own = which[within == n]
        s, _ = lanes[n].locate(*points[own, :2].T)
        off = np.remainder(points[own, 3] - lanes[n].heading(s) + math.pi, math.tau) - math.pi
        for at, turned in zip(own, np.abs(off), strict=True):
            found[at].append((lanes[n].id, turned))
    return found


@pytest.mark.parametrize("plan", PLANS)
def test_places_beside_the_car_are_in_lanes_of_the_right_direction_or_in_none(plan):
    road, world, lanes = made(plan)
    paved = shapely.union_all([lane.area for lane in lanes])
    path = driven_line(road, world)
    count = 0
    for s in np.linspace(5.0, road.length - 5.0, 9):
        x, y, z, heading = (float(np.interp(s, path.road_stations, column)) for column in path.points.T)
        is_inside = any(each.start - 3 < s < each.end + 3 for each in road.passages)
        own = {each for each, _ in directions(plan, np.array([[x, y, z, heading]]))[0]}
        for where in () if is_inside else ("lane", "far", "oncoming", "parked", "beside"):
            for side in (None, "left", "right"):
                try:
                    t = offset_of(where, side, s, road, world, 1.8)
                except UsageError:
                    assert where in ("lane", "oncoming")
                    continue
                count += 1
                spot = np.array([[x - t * math.sin(heading), y + t * math.cos(heading), z, heading]])
                if side and where != "oncoming":
                    assert (t > 0) == (side == "left")
                here = directions(plan, spot)[0]
                box = shapely.Polygon(corners(spot[0, :2], spot[0, 3], np.array(SIZES["car"])))
                if where == "oncoming":
                    assert here
                    assert all(off > math.radians(170) for _, off in here)
                elif where == "lane" or (where == "far" and here):
                    assert here
                    assert all(off < math.radians(10) for _, off in here)
                    assert not own & {each for each, _ in here}
                else:  # beside all lanes, but not farther than a parked car of the referee of traffic
                    assert shapely.area(shapely.intersection(box, paved)) < 0.15
                    assert paved.distance(shapely.Point(spot[0, :2])) < 3.5
    assert count > 24


@pytest.mark.parametrize("text", ROLES)
@pytest.mark.parametrize("plan", PLANS)
def test_ways_follow_lanes_and_meet_the_tested_car_where_they_say(plan, text):
    found = way(plan, text)
    if found is None:
        return
    road, world, _ = made(plan)
    path = driven_line(road, world)
    points = found.points
    steps = np.diff(points[:, :2], axis=0)
    assert np.hypot(*steps.T).max() < 0.8
    course = np.arctan2(*steps.T[::-1])
    assert np.abs(np.remainder(course - points[:-1, 3] + np.pi, math.tau) - np.pi).max() < math.radians(8)
    own, station = found.meets
    assert station >= 30.0
    there = [float(np.interp(station, path.road_stations, column)) for column in path.points.T]
    apart = math.hypot(*np.subtract(found.pose(own)[:2], there[:2]))
    across = abs(math.sin(found.pose(own)[3] - there[3]))
    one, other = (shapely.LineString(each.points[:, :2]) for each in (found, path))
    if "turn_off" in text:
        assert apart < 0.05
        assert found.road_stations is not None
        s = np.linspace(own - 20.0, own, 9)
        beside = np.interp(
            np.interp(s, found.stations, found.road_stations), path.road_stations, path.stations
        )
        gaps = [math.dist(found.pose(a)[:2], path.pose(b)[:2]) for a, b in zip(s, beside, strict=True)]
        assert max(gaps) < 0.05
        assert shapely.distance(shapely.points(points[found.stations > own, :2]), other).max() > 3.0
    elif apart < 0.05:
        assert across > 0.5
        assert one.intersects(other)
    elif apart > 0.52:  # it passes the tested car
        assert text.startswith(("car junction", "car oncoming"))
        assert apart < 20.0
        (start, end) = next((p.start, p.end) for p in road.passages if p.start < station < p.end)
        inside = (path.road_stations >= start) & (path.road_stations <= end)
        assert not shapely.LineString(path.points[inside, :2]).intersects(one)
    else:  # they become one
        assert apart < 0.52
        assert across < 0.5
        before = shapely.LineString(points[found.stations < own - 5.0][-40:, :2])
        assert before.distance(other) > 0.5
    if text.split()[0] != "car":
        assert across > 0.999
        assert not any(p.start < station < p.end for p in road.passages)
        ends = directions(plan, points[[0, -1]])
        assert not ends[1]
        assert "away" in text or not ends[0]
    elif "beside" not in text:
        wrong = [
            n for n, here in enumerate(directions(plan, points[::3])) if not any(off < 0.7 for _, off in here)
        ]
        assert not wrong
    if "away" in text:
        assert math.isclose(own, 6.0)


def test_who_comes_from_a_side_comes_from_there():
    for plan in (CROSSROADS, f"{CROSSROADS} || left_hand"):
        road, _, _ = made(plan)
        straight = float(road.heading(0.0))
        for side, turn in (("left", -90), ("right", 90)):
            for kind in ("car junction", "adult crossing", "car beside"):
                text = f"{kind} {side}: {'turn_in' if 'beside' in kind else 'cross'}"
                off = math.degrees(math.remainder(way(plan, text).points[0, 3] - straight, math.tau))
                assert abs(off - turn) < 5.0
        across = way(plan, "car oncoming: turn_across").points
        assert abs(math.remainder(across[0, 3] - straight - math.pi, math.tau)) < 0.1
        turned = math.degrees(across[-1, 3] - across[0, 3])
        assert abs(turned - (-90 if "left_hand" in plan else 90)) < 5.0  # across the tested car's path
        turn = way(plan, "car ahead: turn_off right").points
        assert abs(math.degrees(turn[-1, 3] - turn[0, 3]) + 90) < 5.0


def test_what_is_there_is_found():
    everywhere = {"car beside: turn_in", "adult crossing left", "bicycle crossing right away=6"}
    across = {
        "car junction left",
        "car junction: turn_in",
        "car oncoming: turn_across",
        "car ahead: turn_off",
    }
    for plan, wanted in (
        (PLANS[0], set()),
        (CROSSROADS, across | {"car behind: turn_off right"}),
        (PLANS[4], {"car junction: run_light", "child crosswalk", "car junction opposite"}),
        (PLANS[7], {"car roundabout", "car ahead: turn_off"}),
        (PLANS[8], {"car ramp: merge"}),
        (PLANS[9], {"car ramp: merge"}),
        (PLANS[10], across),
        (f"{CROSSROADS} || left_hand", across | {"car junction left", "car behind: turn_off right"}),
        (PLANS[-1], {"car roundabout"}),
    ):
        assert {text for text in ROLES if way(plan, text) is not None} >= wanted | everywhere


def test_what_is_not_there_is_refused_by_name():
    road, world, _ = made(PLANS[0])
    for text, named in (
        ("car junction left", "no junction after 30 m at which somebody from the left"),
        ("car roundabout", "no roundabout"),
        ("car ramp: merge", "no ramp"),
        ("child crosswalk", "no crosswalk"),
    ):
        with pytest.raises(UsageError, match=named):
            way_of(role(text), 30.0, road, world)
    with pytest.raises(UsageError, match="ends at"):
        way_of(role("adult crossing"), road.length - 2.0, road, world)
    with pytest.raises(UsageError, match="on the left at 50 m"):
        offset_of("lane", "left", 50.0, road, world, 1.8)


def test_who_crosses_on_a_crosswalk_walks_over_its_stripes():
    plan = PLANS[4]
    road, _, _ = made(plan)
    stripes = [each.points[:, :2] for each in strokes(road.network) if each.kind == "crosswalk"]
    middles = shapely.points([stripe.mean(axis=0) for stripe in stripes])
    (passage,) = road.passages
    # who turns left meets people behind the junction, unless the scene names another place
    for role, near, is_behind in (
        ("child crosswalk", 30.0, True),
        ("child crosswalk before junction 1", 30.0, False),
        ("child crosswalk before junction 1", passage.start, True),
    ):
        found = way(plan, role, near)
        crossed = shapely.distance(middles, shapely.LineString(found.points[:, :2])) < 0.1
        assert (found.meets[1] > passage.end) == is_behind
        assert crossed.sum() >= 6


def test_rows_of_cars_stand_beside_the_lanes_and_leave_junctions_and_ways_free():
    plan = PLANS[4]
    road, world, lanes = made(plan)
    scene = read_scene("parked left; parked right")
    walker = way(plan, "adult crossing right")
    rows = parked_rows(scene, road, world, 1, [walker.points])
    again, others = (parked_rows(scene, road, world, seed, [walker.points]) for seed in (1, 2))
    assert [(kind, *state) for kind, state in rows] == [(kind, *state) for kind, state in again]
    assert len(rows) != len(others) or any((a[1] != b[1]).any() for a, b in zip(rows, others, strict=True))
    boxes = [shapely.Polygon(corners(state[:2], state[3], np.array(SIZES[kind]))) for kind, state in rows]
    paved = shapely.union_all([lane.area for lane in lanes])
    inside = [lane.area for lane in lanes if lane.member.junction is not None]
    line = shapely.LineString(walker.points[:, :2])
    for (kind, state), box in zip(rows, boxes, strict=True):
        assert kind in ("car", "van")
        assert 0.05 < paved.distance(box) < 0.3
        assert shapely.union_all(inside).distance(box) >= 4.5
        assert line.distance(box) > 1.0
        nearest = min(lanes, key=lambda lane: lane.area.distance(box))
        s, _ = nearest.locate(*state[:2])
        assert abs(math.remainder(state[3] - float(nearest.heading(s)), math.tau)) < 0.05
    assert all(not one.intersects(other) for n, one in enumerate(boxes) for other in boxes[:n])
    free = road.length - sum(each.end - each.start + 18.0 for each in road.passages)
    assert 0.65 < len(rows) / (2 * free / 7.0) < 0.95


def test_the_tested_car_has_green_where_somebody_runs_the_red_light():
    plan = "straight 100 // crossroads straight lights // straight 100"
    road, world, _ = made(plan)
    for seed in range(3):
        scene = "ego v=36; car junction left: run_light; light"
        traffic = begin(road, world.changed(scene=scene), seed)
        (passage,) = road.passages
        arrives = passage.start / 10.0
        shown = {arm.end: traffic.lights.shown(arm.end, arrives) for arm in passage.entered.arms}
        assert shown[passage.arrival] == shown[passage.departure] == GREEN
        assert sum(each == RED for each in shown.values()) == 2
    assert way(plan, "car junction opposite: run_light")
    for text in ("car junction left: cross", "car junction right v=30"):
        assert way_of(role(text), 30.0, road, world).meets
        traffic = begin(road, world.changed(scene=f"ego v=36; {text}"), 0)
        shown = {arm.end: traffic.lights.shown(arm.end, arrives) for arm in passage.entered.arms}
        assert shown[passage.arrival] == shown[passage.departure] == RED
        assert sum(each == GREEN for each in shown.values()) == 2  # those from the sides


def test_who_drives_along_with_the_tested_car_has_green_too():
    road, world, _ = made("straight 100 // crossroads left lights // straight 100")
    (passage,) = road.passages
    for seed in range(5):
        traffic = begin(road, world.changed(scene="ego v=36; car junction opposite: cross"), seed)
        opposite = passage.arms[2]
        for end in (passage.arrival, opposite):
            assert traffic.lights.shown(end, passage.start / 10.0) == GREEN


FOOT, MILE = 0.3048, 1609.344
TAPERS = {20: 80, 30: 180, 40: 320, 45: 540, 55: 660, 65: 780}
"""MUTCD 2012 of California, table 6H-4(CA): mph, and feet of a merging taper for 12 feet."""


@pytest.mark.parametrize(("mph", "feet"), TAPERS.items())
@pytest.mark.parametrize(("kind", "share"), [("closed", 1), ("narrowed", 1 / 2), ("shoulder", 1 / 3)])
def test_tapers_of_roadworks_are_as_long_as_published(mph, feet, kind, share):
    works = read_scene(f"roadworks {kind}").roadworks[0]
    first, full, *_ = works.stations(10.0, 50.0, 12 * FOOT, mph * MILE / 3600)
    assert full - first == pytest.approx(feet * share * FOOT, rel=0.02)


@pytest.mark.parametrize("hand", ["", " left_hand"])
@pytest.mark.parametrize(
    ("lanes", "works", "inside", "depth"),
    [
        ("lanes=2 against=2", "closed", 0, 3.5), ("lanes=2 against=2", "closed inner", 1, 3.5),
        ("lanes=1 against=1", "closed inner", -1, 3.5), ("lanes=1 against=1", "", 0, 0.4),
        ("lanes=3 against=1", "narrowed inner shift=1", 2, 1.0), ("lanes=2 against=2", "shoulder", None, 0.0),
    ],
)  # fmt: skip
def test_cones_close_or_narrow_the_lane_on_their_side_and_no_other(lanes, works, inside, depth, hand):
    """``inside``: the number of the lane from the kerb, -1 for the outermost oncoming one."""
    road, world, every = made(
        f"straight 50 // t_junction straight // straight 450 | {lanes} || width=3.5{hand}"
    )
    sides = ["left", "right"] if hand else ["right", "left"]
    scene = f"roadworks {works} s=120 len=60".replace("inner", sides[1])
    rows = works_rows(road, world.changed(scene=scene, speed_limit=50 / 3.6), 1)
    boxes = [shapely.Polygon(corners(state[:2], state[3], np.array(SIZES[kind]))) for kind, state in rows]
    s, t = np.array([road.locate(*state[:2]) for kind, state in rows if kind == "cones"]).T
    section = shapely.LineString(road.at(np.array([200.0, 200.0]), np.array([-12.0, 12.0]))[:, :2])
    middle = [each for each in every if each.area.intersection(section).length > 3.0]
    middle.sort(key=lambda each: section.project(each.area.intersection(section).centroid))
    middle = middle[::-1] if hand else middle  # from the kerb of the tested car
    hit = [
        n for n, each in enumerate(middle) if any(each.area.intersection(box).area > 1e-3 for box in boxes)
    ]
    assert hit == ([] if inside is None else [inside % len(middle)])
    assert max(np.diff(np.sort(s))) < 2 * 50_000 / MILE * FOOT + 0.1
    full = np.abs(t - t[len(t) // 2]) < 0.01
    assert np.ptp(s[full]) == pytest.approx(60.0, abs=0.5)
    for n in hit:
        cones = [box for box, is_full in zip(boxes, full, strict=False) if is_full]
        off = [abs(middle[n].locate(*np.array(box.centroid.coords[0]))[1]) for box in cones]
        assert off == pytest.approx([abs(1.75 - depth + 0.2)] * len(off), abs=0.02)


def test_traffic_leaves_the_lane_that_roadworks_close_and_touches_nothing_there():
    road, world, _ = made("straight 400 | lanes=2 against=1")
    world = world.changed(scene="medium; roadworks closed s=150 len=40", speed_limit=50 / 3.6)
    flow = begin(road, world, 2)._movers[1][0]
    rows = works_rows(road, world, 2)
    bodies = np.array([[*state, *SIZES[kind][:2]] for kind, state in rows])
    flow.start(None, bodies)
    boxes = shapely.STRtree([shapely.Polygon(corners(b[:2], b[3], b[5:])) for b in bodies])
    passed = set()
    for step in range(1200):
        states = flow.move(step * 0.1, None, bodies)
        for n in np.flatnonzero(~np.isnan(states[:, 0])) if step % 5 == 0 else ():
            size = np.array(flow.actors[n].size)
            box = shapely.Polygon(corners(states[n, :2], states[n, 3], size))
            assert not len(boxes.query(box, predicate="intersects"))
            s, t = map(float, road.locate(*states[n, :2]))
            passed |= {n} if s > 300.0 and t < 0 else set()
    assert len(passed) > 20


@pytest.mark.parametrize(
    ("works", "says"),
    [
        ("roadworks s=380 len=50", "the road ends at"), ("roadworks shoulder", "has no such shoulder"),
    ],
)  # fmt: skip
def test_roadworks_for_which_a_road_has_no_place_are_refused(works, says):
    road, world, _ = made("straight 400 | lanes=1 against=1")
    bare = world.changed(shoulder=0.0, scene=works)
    with pytest.raises(UsageError, match=says):
        works_rows(road, bare, 1)


@pytest.mark.parametrize(
    "scene",
    [
        "ego parked right: pull_out; roadworks closed s=5",
        "ego v=0 s=40: release time=4; roadworks narrowed s=5 shift=2.5",
    ],
)
def test_roadworks_in_the_way_of_the_car_at_its_start_are_refused_by_one_sentence(scene):
    road, world, _ = made("straight 400 | lanes=1 against=1")
    with pytest.raises(UsageError, match=r"roadworks .* in the way of the tested car, .* or later"):
        works_rows(road, world.changed(scene=scene), 1)
    moved = re.sub(r"\bs=\d\b", "s=70", scene)
    assert works_rows(road, world.changed(scene=moved), 1)


def test_a_closed_lane_is_passed_as_a_whole_where_the_oncoming_lane_is_free():
    words = "straight 400 | lanes=1 against=1 && ego v=40: pass; roadworks closed s=150"
    run = perform(words, 1, setup=Setup(reader="plan", driver="robot"))
    assert run.outcome == "PASS", run.description
    drive = run.drive
    boxes = [shapely.Polygon(corners(s[:2], s[3], np.array(a.size))) for a, s in zip(
        drive.others.actors, drive.others.states[0], strict=True)]  # fmt: skip
    way = [shapely.Polygon(drive.corners(step)) for step in range(0, len(drive), 5)]
    assert len(boxes) > 10
    assert 0.5 < min(one.distance(box) for one in way for box in boxes) < 2.0


def test_who_waits_before_a_closed_lane_that_nothing_leads_past_has_not_failed():
    """One lane, one way."""
    run = perform("| oneway len=400 && ego v=40; roadworks closed s=120", 1, setup=Setup(reader="plan"))
    assert run.outcome == "PASS"
    assert re.search(r"stayed \d\.\d m behind cones \d+, which stands in its way", run.description)
