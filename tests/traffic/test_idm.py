"""Vehicles that follow, give way and change lanes; checked by formulas, shapely, and slow counts."""

import math
from functools import cache

import numpy as np
import pytest
import shapely

from boxed import corners
from roadgpt import traffic
from roadgpt.network import legs_of, network_of
from roadgpt.network.lanes import lanes_of
from roadgpt.run import Setup, perform
from roadgpt.traffic import Size, Stage
from roadgpt.traffic.actor import HEADING, SPEED, STEP, X, Y
from roadgpt.traffic.idm import DENSITY, IdmMover
from roadgpt.traffic.lane_map import lane_map, touched
from roadgpt.traffic.lights import GREEN, RED, Lights

NOBODY = np.zeros((0, 7))
STRAIGHT = "straight 400 | lanes=1 against=1"
PLANS = [
    "turn x2 | lanes=2 against=2 len=400",
    "straight 100 // crossroads left // straight 100",
    "straight 100 // crossroads left lights // straight 100",
    "straight 100 // t_junction left stop // straight 100",
    "straight 100 // roundabout exit=2 // straight 100",
    "| lanes=2 len=200 // lane_drop // straight 150",
    "straight 80 // roundabout exit=2 || left_hand",
]


@cache
def stage(plan, seed=1):
    run = perform(plan, seed, setup=Setup(reader="plan", drives=False))
    assert run.is_valid, run.description
    return Stage(run.road, run.world, seed)


def empty(plan):
    mover = IdmMover(stage(plan), "light", is_filled=False)
    mover.comes_in = False
    mover.start(None)
    return mover


def overlapping(mover, states):
    there = [n for n in range(len(states)) if not math.isnan(states[n, X])]
    boxes = [shapely.Polygon(corners(states[n], mover.actors[n].size)) for n in there]
    one, two = shapely.STRtree(boxes).query(boxes, predicate="intersects") if boxes else ((), ())
    return [
        (mover.actors[there[a]].name, mover.actors[there[b]].name)
        for a, b in zip(one, two, strict=True)
        if a < b
    ]


def body(x, y, heading, speed, length=4.7, width=1.8):
    return np.array([[x, y, 0.0, heading, speed, length, width]])


@pytest.mark.parametrize("v", [5.0, 10.0, 15.0])
def test_behind_an_even_leader_the_gap_is_that_of_the_published_formula(v):
    mover = empty("straight 900 | lanes=1 against=1 map_size=1000")
    lane = mover.lanes.begins.nonzero()[0][0]
    limit = mover.lanes.limit[lane]
    mover.enter(lane, 10.0, v)
    mover._numbers[1, 4], mover._numbers[1, 6:9] = (
        1.0,
        (1.5, 1.5, 2.0),
    )  # a car without a character of its own
    one = mover.lanes.sample[mover.lanes.first[lane]]
    x, y, heading = one[0], one[1], one[3]
    lead, gaps = 60.0, []
    states = mover._shown()
    for tick in range(int(800 / v / STEP)):
        others = body(x + lead * math.cos(heading), y + lead * math.sin(heading), heading, v)
        states = mover.move(tick * STEP, None, others)
        lead += v * STEP
        along = (states[0, X] - x) * math.cos(heading) + (states[0, Y] - y) * math.sin(heading)
        gaps.append(lead - along - 4.7)
    # Treiber, Kesting (2013), 11.3.7: the improved model follows at the gap that one wants, below the limit
    assert v < limit
    assert gaps[-1] == pytest.approx(2.0 + 1.5 * v, rel=0.01)


@pytest.mark.parametrize(("flow", "seed"), [("medium", 1), ("dense", 1)])
def test_headways_and_changes_of_lane_are_those_of_real_traffic(flow, seed):
    """At a point of a straight road with two lanes one way, one the other, at 50 km/h: the headways of 1,000
    vehicles, counted by when their fronts pass; and how long the lateral movements of the tracks last."""
    own = stage("straight 600 | lanes=2 against=1 map_size=700", seed)
    mover = IdmMover(own._replace(world=own.world.changed(speed_limit=50 / 3.6)), flow)
    states, ahead, left = mover.start(None), mover.lanes.sample[0, 3], own.road.at(300.0, 0.0)
    along, across = (
        np.array([math.cos(ahead), math.sin(ahead)]),
        np.array([-math.sin(ahead), math.cos(ahead)]),
    )
    passed, offsets, count = {}, {}, 0
    for tick in range(40_000):
        before, states = states, mover.move(tick * STEP, None, NOBODY)
        there = np.flatnonzero(~np.isnan(states[: len(before), X]) & ~np.isnan(before[:, X]))
        halves = np.array([mover.actors[n].size.length / 2 for n in there])
        now = states[there, :2] - left[:2]
        way = np.sign(np.cos(states[there, HEADING] - ahead))
        fronts = [(each @ along) * way + halves for each in (before[there, :2] - left[:2], now)]
        for n in np.flatnonzero((fronts[0] < 0) & (fronts[1] >= 0)).tolist():
            share = fronts[0][n] / (fronts[0][n] - fronts[1][n])
            passed.setdefault(math.floor(now[n] @ across / 3.5), []).append((tick + share) * STEP)
            count += 1
        for n, t in zip(there.tolist(), (now @ across).tolist(), strict=True):
            offsets.setdefault(n, []).append(t)
        if count >= 1000:
            break
    headways = np.concatenate([np.diff(times) for times in passed.values()])
    assert 0.08 <= (headways < 1.0).mean() <= 0.12
    assert 0.6 <= headways.std() / headways.mean() <= 1.1
    lasts = []
    for row in map(np.array, offsets.values()):
        moves = np.flatnonzero(np.diff(np.r_[0, np.abs(np.diff(row)) > 1e-9, 0]))
        for first, last in moves.reshape(-1, 2).tolist():
            if first > 0 and last < len(row) - 1 and abs(row[last] - row[first]) > 3.0:
                is_on = np.minimum(np.abs(row - row[first]), np.abs(row - row[last]))[first:last] > 0.01
                lasts.append(is_on.sum() * STEP)
    assert len(lasts) > 50
    assert np.mean(lasts) == pytest.approx(4.6, abs=0.5)  # Toledo, Zohar (2007)
    assert np.std(lasts) == pytest.approx(2.3, abs=0.5)


@pytest.mark.parametrize("plan", PLANS)
def test_nobody_touches_anybody(plan):
    mover = IdmMover(stage(plan), "medium")
    states = mover.start(None)
    assert mover.vehicles > 2
    for tick in range(300):
        states = mover.move(tick * STEP, None, NOBODY)
        if tick % 2:  # who comes at 40 m/s is still there 0.1 s later
            assert not overlapping(mover, states)


@pytest.mark.parametrize("plan", [PLANS[0], PLANS[4], PLANS[5]])
def test_nobody_jumps(plan):
    """From moment to moment everybody comes as far as it drives, also where it changes lanes in a bend."""
    mover = IdmMover(stage(plan), "dense")
    before, turned = mover.start(None), 0.0
    for tick in range(500):
        after = mover.move(tick * STEP, None, NOBODY)
        own = slice(0, len(before))
        way = np.hypot(*(after[own] - before)[:, [X, Y]].T)
        driven = (after[own, SPEED] + before[:, SPEED]) / 2 * STEP
        assert np.nanmax(np.abs(way - driven), initial=0.0) < 0.15
        turned = max(turned, np.nanmax(np.abs(after[own, HEADING] - before[:, HEADING]), initial=0.0))
        assert np.nanmax(np.abs(after[own, SPEED] - before[:, SPEED]), initial=0.0) <= 9.0 * STEP + 1e-9
        before = after
    assert turned < 0.2


def test_the_same_seed_gives_the_same_tracks_and_another_seed_others():
    def tracks(seed):
        mover = IdmMover(stage(PLANS[1])._replace(seed=seed), "medium")
        rows = [mover.start(None)] + [mover.move(tick * STEP, None, NOBODY) for tick in range(200)]
        return np.concatenate([row.ravel() for row in rows])

    assert tracks(3).tobytes() == tracks(3).tobytes()
    assert tracks(3).tobytes() != tracks(4).tobytes()


@pytest.mark.parametrize("flow", ["light", "dense"])
def test_the_density_is_held(flow):
    mover = IdmMover(stage("| lanes=2 against=2 len=600 map_size=700"), flow)
    mover.start(None)
    metres = mover.lanes.length.sum()
    counts = []
    for tick in range(1500):
        mover.move(tick * STEP, None, NOBODY)
        counts.append(mover.vehicles)
    assert np.mean(counts) / metres * 1000 == pytest.approx(DENSITY[flow] * 1000, rel=0.2)


@pytest.mark.parametrize("plan", [PLANS[1], PLANS[2], PLANS[4]])
def test_everybody_leaves_when_nobody_comes_any_more(plan):
    mover = IdmMover(stage(plan), "medium")
    mover.start(None)
    for tick in range(12_000):
        mover.comes_in = tick < 1200
        mover.move(tick * STEP, None, NOBODY)
        if tick > 1200 and not mover.vehicles:
            return
    pytest.fail(f"{mover.vehicles} have not left")


@pytest.mark.parametrize(
    ("plan", "seed"),
    [
        ("straight 100 // roundabout exit=2 large lanes=2 // straight 100", 11),
        ("map columns=3 rows=2 stop", 27),
    ],
)
def test_traffic_does_not_lock_up(plan, seed):
    """Both did: in the ring, one stood at a junction in the middle of its change of lane; between the stop
    signs, everybody waited for somebody with priority who had no room to go on."""
    mover = IdmMover(stage(plan, seed), "medium")
    mover.start(None)
    stands, longest = {}, 0
    for tick in range(3000):
        mover.move(tick * STEP, None, NOBODY)
        speeds = mover._numbers[mover._rows, 1]
        stands = {who: stands.get(who, 0) + 1 for who in mover._who[speeds < 0.3].tolist()}
        longest = max(longest, *stands.values(), 0)
    assert len(mover.actors) > 1.5 * mover.vehicles
    assert longest * STEP < 150.0


@pytest.mark.parametrize("plan", ["map columns=3 rows=3 lights", PLANS[4]])
def test_everybody_takes_a_shortest_way_to_an_exit_and_only_a_few_go_back(plan):
    """A slow exact algorithm: the least sums of lengths, until none becomes less."""
    mover = IdmMover(stage(plan), "dense")
    mover.start(None)
    lanes, network = mover.lanes, network_of(stage(plan).road, stage(plan).world)
    onward = {
        n: [mover.ids.index(each) for each in lanes_of(network)[key].successors]
        for n, key in enumerate(mover.ids)
    }
    assert mover.vehicles > 5

    @cache
    def away_from(goal):
        far, before = {goal: lanes.length[goal]}, {}
        while far != before:
            before = far.copy()
            for n, to in onward.items():
                if n != goal:
                    far[n] = lanes.length[n] + min((far.get(each, math.inf) for each in to), default=math.inf)
        return far

    back = 0
    for row in mover._rows:
        way = mover._ways[row, : mover._whole[row, 1]].tolist()
        goal = way[-1]
        assert not onward[goal]
        assert sum(lanes.length[way]) == pytest.approx(away_from(goal)[way[0]])
        back += len(way) > 1 and mover.ids[goal].road == mover.ids[way[0]].road
    assert not back


def test_who_comes_upon_somebody_standing_stops_behind_them():
    mover = empty(STRAIGHT)
    lane = mover.lanes.begins.nonzero()[0][0]
    mover.enter(lane, 10.0, 15.0)
    one = mover.lanes.sample[mover.lanes.first[lane] + 150]
    for tick in range(300):
        states = mover.move(tick * STEP, None, body(one[0], one[1], one[3], 0.0))
    gap = math.hypot(states[0, X] - one[0], states[0, Y] - one[1]) - 4.7 / 2 - mover.actors[0].size.length / 2
    assert states[0, SPEED] < 0.1
    assert 1.0 < gap < 3.0


def test_who_is_met_head_on_in_its_own_lane_brakes():
    mover = empty(STRAIGHT)
    lane = mover.lanes.begins.nonzero()[0][0]
    mover.enter(lane, 10.0, 15.0)
    one = mover.lanes.sample[mover.lanes.first[lane] + 120]
    for tick in range(25):
        along = 120 - 10.0 * tick * STEP
        there = mover.lanes.sample[mover.lanes.first[lane] + int(along)]
        states = mover.move(tick * STEP, None, body(there[0], there[1], one[3] + math.pi, 10.0))
    assert states[0, SPEED] < 12.0


@pytest.mark.parametrize("speed", [13.0, 0.0])
def test_who_gives_way_lets_the_tested_car_pass_and_then_goes(speed):
    """A side road with a stop sign; the tested car drives by on the road with priority, or stands before the
    junction, which may not keep the other for ever."""
    own = stage("straight 100 // t_junction straight priority // straight 100")
    mover = IdmMover(own, "light", is_filled=False)
    mover.comes_in = False
    network, crossing = network_of(own.road, own.world), own.road.passages[0]
    waits = next(
        n for n, key in enumerate(mover.ids)
        if mover.lanes.begins[n] and lanes_of(network)[key].control in ("yield", "stop")
    )  # fmt: skip
    s, station = max(mover.lanes.length[waits] - 30.0, 5.0), 5.0 if speed else crossing.start - 4.0
    lane = own.world.profile_of(own.road).middle(0.0)

    def tested(station):
        x, y, _ = own.road.at(station, lane)
        return traffic.TestedCar(x, y, float(own.road.heading(station)), speed, station, lane, 4.7, 1.86)

    mover.start(tested(station))
    mover.enter(waits, s, 8.0)
    leg, begin = legs_of(own.road, own.world)[1], mover.lanes.onward_of
    turns = mover.lanes.onward[begin[waits] : begin[waits + 1]]
    turn = next(n for n in turns if leg in lanes_of(network).gives_way_to(mover.ids[n]))
    mover._ways[1, 1], mover._whole[1, 1] = turn, 2  # from where on it plans anew
    entered, stood = None, 0.0
    for tick in range(int((own.road.length - 5.0) / 13.0 / STEP)):
        car = tested(station + speed * tick * STEP)
        states = mover.move(tick * STEP, car, NOBODY)
        lane_now = mover._ways[mover._rows[0], mover._whole[mover._rows[0], 0]] if len(mover._rows) else -1
        if entered is None and lane_now >= 0 and mover.lanes.junction[lane_now] >= 0:
            entered = car.s
        stood += STEP * (entered is None and states[0, SPEED] < 0.3)
        if not math.isnan(states[0, X]):
            box = shapely.Polygon(corners(states[0], mover.actors[0].size))
            assert not box.intersects(shapely.Point(car.x, car.y).buffer(1.0))
    assert entered is not None
    assert entered > crossing.start if speed else 3.0 < stood < 10.0


class AtCrossing:
    """Vehicles of the flow from one side and the tested car, which drives straight on across their way."""

    def __init__(self, control, side):
        self.own = stage(f"straight 100 // crossroads straight {control} // straight 100")
        self.mover = IdmMover(self.own, "light", is_filled=False)
        self.mover.comes_in = False
        self.road, lanes = self.own.road, lanes_of(network_of(self.own.road, self.own.world))
        self.line, self.t = self.road.passages[0].start, self.own.world.profile_of(self.road).middle(0.0)
        own, ids = self.road.heading(self.line), self.mover.ids
        self.way = next(
            n for n, key in enumerate(ids)
            if self.mover.lanes.junction[n] >= 0 and abs(lanes[key].turn) < 0.1
            and np.sin(lanes[key].heading(0.0) - own) * {"left": -1, "right": 1}[side] > 0.9
        )  # fmt: skip
        self.lane = ids.index(lanes[ids[self.way]].predecessors[0])
        self.mover.start(self.car(5.0, 0.0))

    def car(self, s, speed):
        x, y, _ = self.road.at(s, self.t)
        return traffic.TestedCar(x, y, float(self.road.heading(s)), speed, s, self.t, 4.7, 1.86)

    def enter(self, left, speed):
        """Lets somebody in whose middle is ``left`` metres before the junction and who drives straight on."""
        self.mover.enter(self.lane, self.mover.lanes.length[self.lane] - left, speed)
        row = self.mover._rows[-1]
        self.mover._ways[row, 1], self.mover._whole[row, 1] = self.way, 2

    def touches(self, states, car):
        box = corners(np.array([car.x, car.y, 0.0, car.heading, car.speed]), Size(4.7, 1.86, 1.5))
        there = [n for n in range(len(states)) if not math.isnan(states[n, X])]
        boxes = [shapely.Polygon(corners(states[n], self.mover.actors[n].size)) for n in there]
        return any(each.intersects(shapely.Polygon(box)) for each in boxes)

    def inside(self):
        rows = self.mover._rows
        return sum(self.mover._ways[rows, self.mover._whole[rows, 0]] == self.way)


@pytest.mark.parametrize("left", [34.0, 36.0, 38.0])
def test_who_has_priority_gives_its_way_back_to_a_tested_car_that_drives_on(left):
    """It has a grant when the tested car can no longer stop, 3 m before the junction with 6 m/s."""
    crossing = AtCrossing("yield", "left")
    begin = crossing.line - 2.35 - 4.0
    crossing.enter(left, 10.0)
    for tick in range(100):
        car = crossing.car(begin + 6.0 * tick * STEP, 6.0)
        assert not crossing.touches(crossing.mover.move(tick * STEP, car, NOBODY), car)
        assert tick > 0 or crossing.mover._whole[1, 2] == 1


def test_a_tested_car_that_has_waited_for_30_s_is_let_in():
    crossing = AtCrossing("yield", "left")
    car, inside = crossing.car(crossing.line - 4.0, 0.0), []
    for tick in range(500):
        if tick % 25 == 0:
            crossing.enter(50.0, 10.0)
        crossing.mover.move(tick * STEP, car, NOBODY)
        inside.append(crossing.inside())
    free = np.convolve(np.array(inside) > 0, np.ones(60), "valid") == 0  # for 6 s from then on
    assert not free[50:250].any()
    assert free[300:].any()


def test_a_tested_car_goes_in_its_turn_when_several_have_waited_for_the_same_one():
    crossing = AtCrossing("none", "left")
    mover, s = crossing.mover, crossing.line - 4.0
    x, y, _ = crossing.road.at(crossing.line + 12.0, crossing.t)
    crossing.enter(4.0, 0.0)
    for tick in range(400):
        goes = max(tick - 101, 0) * STEP  # 0.1 s after the way has become free
        car = crossing.car(s + 0.75 * goes * goes, 1.5 * goes)
        if car.s > crossing.line + 30.0:
            break
        blocks = body(x, y, 0.0, 0.0, 12.0, 12.0) if tick < 100 else NOBODY
        assert not crossing.touches(mover.move(tick * STEP, car, blocks), car)
        assert not crossing.inside() or car.s > crossing.line + 10.0


def test_lights_never_show_green_to_ways_that_cross_and_opposite_arms_have_it_together():
    own = stage("straight 100 // crossroads left lights // straight 100")
    network = network_of(own.road, own.world)
    lights = Lights(network, 5)
    (junction,) = network.junctions
    arms = [(arm.end, arm.direction) for arm in junction.arms]
    seen = {end: 0.0 for end, _ in arms}
    for tick in range(4000):
        open_ = [(end, way) for end, way in arms if lights.shown(end, tick * STEP) != RED]
        for _, one in open_:
            for _, two in open_:
                apart = abs((one - two + math.pi) % (2 * math.pi) - math.pi)
                assert apart < 1e-9 or apart > math.radians(135)
        for end, _ in arms:
            seen[end] += STEP * (lights.shown(end, tick * STEP) == GREEN)
    assert all(share == pytest.approx(400 * 15 / 40, rel=0.15) for share in seen.values())


@pytest.mark.parametrize("plan", [PLANS[1], PLANS[4]])
def test_boxes_are_in_the_lanes_whose_areas_they_overlap(plan):
    own = stage(plan)
    lanes = lanes_of(network_of(own.road, own.world))
    made, ids = lane_map(lanes, 20.0)
    areas = {key: lanes[key].area for key in ids}
    rng = np.random.default_rng(2)
    wrong = 0
    for _ in range(200):
        key = ids[int(rng.integers(len(ids)))]
        lane = lanes[key]
        s = float(rng.uniform(0, lane.length))
        x, y, _ = lane.at(s, float(rng.uniform(-2, 2)))
        heading = float(lane.heading(s)) + float(rng.normal(0, 0.3))
        entries = np.zeros((64, 5))
        count = touched(made, x, y, heading, 4.7, 1.8, 5.0, 7.0, entries, 0)
        found = {ids[int(entries[n, 0])] for n in range(count)}
        state = np.array([x, y, 0.0, heading, 5.0])
        for each, area in areas.items():
            small = shapely.Polygon(corners(state, Size(4.7, 1.2, 1.5)))
            large = shapely.Polygon(corners(state, Size(5.8, 2.1, 1.5)))
            wrong += small.intersection(area).area > 0.5 and each not in found
            wrong += large.intersection(area).area < 0.01 and each in found
    assert not wrong


@pytest.mark.parametrize(
    ("plan", "friction"),
    [
        ("turn x2 | lanes=2 against=2 len=400", 0.1),
        ("straight 100 // crossroads left lights // straight 100", 0.1),
        ("| lanes=2 len=200 // lane_drop // straight 150", 0.35),
        ("turn x4 | mountain lanes=2 against=2 len=600", 0.35),
    ],
)
def test_nobody_accelerates_more_than_friction_and_grade_allow(plan: str, friction: float) -> None:
    """Accelerations are measured on the recorded motion, rounded to 1 mm/s and 0.0001 rad every 0.1 s."""
    made = stage(plan)
    world = made.world.changed(friction=friction)
    mover = IdmMover(Stage(made.road, world, 2), "medium")
    seen = [mover.start(None)]
    for tick in range(400):
        seen.append(mover.move(tick * STEP, None, NOBODY))
        if tick % 20 == 0:
            assert not overlapping(mover, seen[-1])
    states = np.full((len(seen), len(mover.actors), 5), np.nan)
    for n, each in enumerate(seen):
        states[n, : len(each)] = each
    speed, (dx, dy, dz) = states[..., SPEED], np.diff(states[..., :3], axis=0).transpose(2, 0, 1)
    sine = np.abs(dz) / np.maximum(np.sqrt(dx**2 + dy**2 + dz**2), 0.02)
    along = np.maximum(np.abs(np.diff(speed, axis=0)) / STEP - 9.81 * sine, 0)
    across = np.abs(np.diff(states[..., HEADING], axis=0)) / STEP * (speed[1:] + speed[:-1]) / 2
    most = np.nanmax(np.hypot(along, across))
    assert 0.5 < most / (9.81 * friction) < 1 + 0.1 / (9.81 * friction)


def test_who_is_hit_brakes_as_the_road_lets_it() -> None:
    made = stage(STRAIGHT)
    for friction, most in ((1.0, 6.0), (0.2, 0.2 * 9.81)):
        mover = IdmMover(Stage(made.road, made.world.changed(friction=friction), 1), "light", is_filled=False)
        mover.comes_in = False
        mover.start(None)
        mover.enter(int(np.flatnonzero(mover.lanes.begins)[0]), 50.0, 12.0)
        state = mover._shown()[0]
        car = traffic.TestedCar(state[X], state[Y], state[HEADING], 12.0, 50.0, 0.0, 4.7, 1.8)
        speeds = [mover.move(n * STEP, car, NOBODY)[0, SPEED] for n in range(5)]
        np.testing.assert_allclose(np.diff(speeds) / STEP, -most, atol=0.02)
        assert mover.stopped == [0]
