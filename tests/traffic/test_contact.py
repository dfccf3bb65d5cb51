"""Who is to hit the tested car, or another one, hits it where the scene tells.

Times and places of touches are those of polygons (shapely) that move between the recorded samples; a referee
of exported scenes judges the same where it is at hand."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely

from boxed import corners
from outside_judge import traffic_referee
from roadgpt.brief.plan import plan, read_plan
from roadgpt.drive import Drive
from roadgpt.errors import BriefError
from roadgpt.run import Run, Setup, perform
from roadgpt.run.exporting import export
from roadgpt.traffic.actor import Tracks

STEP = 0.005  # s
NEAR = 0.02  # m, of a corner that touches


@pytest.fixture(autouse=True)
def who_stands_is_soon_stuck(monkeypatch: pytest.MonkeyPatch) -> None:
    """After 20 s instead of 120."""
    monkeypatch.setattr("roadgpt.drive.drive_monitor.STUCK_AMONG_OTHERS", 20.0)


@cache
def run_of(words: str, driver: str = "robot") -> Run:
    return perform(words, seed=3, setup=Setup(driver=driver, reader="plan"))


def parts(words: str, driver: str = "robot") -> tuple[Run, Drive, Tracks]:
    run = run_of(words, driver)
    assert run.drive is not None, run.description
    assert run.drive.others is not None
    return run, run.drive, run.drive.others


def box(state: np.ndarray, size: tuple[float, float]) -> shapely.Polygon:
    return shapely.Polygon(corners(state, size))


def own_box(drive: Drive, time: float) -> tuple[np.ndarray, shapely.Polygon]:
    x, y, heading = (float(np.interp(time, drive["time"], each)) for each in drive.middles.T)
    state = np.array([x, y, 0.0, heading])
    return state, box(state, drive.car[:2])


def touched(drive: Drive, others: Tracks, name: str) -> tuple[float, str, float]:
    """When somebody first touches the tested car, on which of its faces, and where along that: from the left
    of front and rear, from the front of the sides."""
    number = [each.name for each in others.actors].index(name)
    size = others.actors[number].size[:2]
    far = np.hypot(*(others.at(drive["time"])[:, number, :2] - drive.middles[:, :2]).T)

    def boxes(time: float) -> tuple[shapely.Polygon, shapely.Polygon]:
        return own_box(drive, time)[1], box(others.at(time)[number], size)

    times = np.arange(drive["time"][np.nanargmax(far < 12.0)], drive.duration, STEP)
    time = next(float(each) for each in times if shapely.intersects(*boxes(each)))
    before = time - STEP
    for _ in range(12):
        middle = (before + time) / 2
        before, time = (before, middle) if shapely.intersects(*boxes(middle)) else (middle, time)
    state, pair = own_box(drive, time)[0], boxes(time)
    points = [shapely.Point(each) for one in pair for each in one.exterior.coords[:4]]
    near = [each for each in points if max(each.distance(one) for one in pair) < NEAR]
    spot = np.mean([[each.x, each.y] for each in near], axis=0) - state[:2]
    turn = np.exp(-1j * state[3]) * complex(*spot)
    length, width = drive.car[:2]
    depths = {
        "front": length / 2 - turn.real, "rear": length / 2 + turn.real,
        "left": width / 2 - turn.imag, "right": width / 2 + turn.imag,
    }  # fmt: skip
    face = min(depths, key=lambda each: depths[each])
    along = 0.5 - (turn.imag / width if face in ("front", "rear") else turn.real / length)
    return float(time), face, along


TWO_LANES, BOTH_WAYS = "straight 400 | lanes=2 && ", "straight 400 | lanes=1 against=1 && "
TOLD = {
    # it stops, and is hit from behind
    "straight 400 && ego v=50: stop s=150, wait 5; car behind v=50 hits=rear impact=30": ("rear", 0.7),
    "straight 400 && ego v=50: brake 6 time=5, wait 9; truck behind v=50 hits=rear": ("rear", 0.5),
    "straight 400 && ego v=40; motorcycle behind v=70 hits=rear impact=80": ("rear", 0.2),
    # it stands, or drives, and a mirror is scraped
    "straight 400 && ego v=0: wait 20; truck lane left v=50 hits=mirror": ("left", 0.35),
    f"{BOTH_WAYS}ego v=50; truck oncoming v=50 hits=mirror": ("left", 0.35),
    f"{TWO_LANES}ego v=60 lane=2; van lane right v=70 hits=mirror": ("right", 0.35),
    # somebody cuts in too early
    f"{TWO_LANES}ego v=50; van lane left v=50 hits=left impact=5: cut_in": ("left", 0.05),
    f"{TWO_LANES}ego v=50; van lane left v=40 hits=front impact=20: cut_in": ("front", 0.2),
    # head on, and what lies on the road
    f"{BOTH_WAYS}ego v=50; car oncoming v=50 hits=front impact=20: drift": ("front", 0.8),
    "straight 400 && ego v=50; cones ahead hits=front impact=10": ("front", 0.9),
    "straight 400 && ego v=50; car ahead v=0 hits=front impact=75": ("front", 0.25),
    # from the side
    "straight 300 && ego v=30; car parked right hits=right impact=30: pull_out to=30": ("right", 0.3),
    "crossroads straight && ego v=40; car junction left v=40 hits=left impact=70: cross": ("left", 0.7),
}


@pytest.mark.parametrize("words", TOLD)
def test_somebody_hits_the_told_place_of_a_car_that_does_not_react(words: str) -> None:
    face, share = TOLD[words]
    run, drive, others = parts(words)
    assert run.verdict is not None
    hit = next(each for each in run.verdict.incidents or () if each.contact)
    time, its_face, along = touched(drive, others, str(hit.other))
    assert hit.contact is not None
    assert hit.contact.place is not None
    assert (its_face, hit.contact.face) == (face, face), run.description
    assert along == pytest.approx(share, abs=0.05)
    assert hit.contact.place == pytest.approx(along, abs=0.02)
    assert hit.at_time == pytest.approx(time, abs=0.02)


@pytest.mark.parametrize("words", [*TOLD][:3] + [*TOLD][6:9])
def test_a_referee_of_exported_scenes_sees_the_same(words: str, tmp_path: Path) -> None:
    referee, face = traffic_referee(), TOLD[words][0]
    export(run_of(words), tmp_path, ["opendrive", "openscenario"], print)
    told = {"outcome": {"collision": True, "hit": "side" if face in ("left", "right") else face}}
    holds, measured = referee.check(str(tmp_path / "road.drive.xosc"), told)
    assert all(holds.values()), json.dumps(referee.plain(measured["outcome"]))


def test_a_driver_that_reacts_is_not_hit_where_it_can_avoid_that() -> None:
    words = f"{TWO_LANES}ego v=50; van lane left v=40 hits=front impact=20: cut_in"
    run, drive, others = parts(words, "lane_centring")
    assert run.outcome == "PASS", run.description
    size = others.actors[0].size[:2]
    for time in np.arange(0.0, drive.duration, 0.05):
        if np.isfinite(others.at(time)[0, 0]):
            assert not own_box(drive, time)[1].intersects(box(others.at(time)[0], size))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("straight 300 && ego v=50; car behind v=40 hits=rear", ["car 1", "rear", "never touch"]),
        (
            f"{TWO_LANES}ego v=50; van lane left v=50 lead=2 hits=left impact=60: cut_in",
            ["van 1", "left", "%"],
        ),
    ],
)
def test_a_hit_that_cannot_be_is_refused_in_one_sentence(words: str, said: list[str]) -> None:
    run = run_of(words)
    assert run.outcome == "INVALID"
    assert run.description.startswith("refused: ")
    assert all(each in run.description for each in said), run.description


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ("car behind hits=mirror impact=30", "mirror"),
        ("car behind hits=rear impact=130", "rear"),
        ("car behind hits=van 1", "van 1"),
        ("car behind hits=roof", "roof"),
        ("car x2 behind hits=rear", "one hits"),
        ("car ahead; car behind hits=car 2", "name another"),
    ],
)
def test_what_cannot_be_hit_is_named(scene: str, said: str) -> None:
    with pytest.raises(BriefError, match=said):
        read_plan(f"straight && {scene}")


def test_plans_hold_who_hits_whom() -> None:
    for words in ("van ahead; car lane left hits=van 1: cut_in", "car behind impact=30 hits=rear"):
        read = read_plan(f"straight && {words}")
        assert read_plan(plan(read)).scene == read.scene


AMONG = {
    # somebody cuts in and does not see that the van brakes; head on; across a junction
    f"{TWO_LANES}ego v=50; van ahead gap=60 v=50: brake 4; car lane left v=50 hits=van 1: cut_in": (
        "car",
        "van",
    ),
    f"{BOTH_WAYS}ego v=50; car ahead gap=60 v=50; truck oncoming v=50 hits=car 1: drift": ("truck", "car"),
    "crossroads straight none && ego v=40; car junction left v=40: cross; van junction opposite v=40 "
    "hits=car 1: cross": ("van", "car"),
}
MASSES = {"car": 1700.0, "van": 2500.0, "truck": 16000.0}  # kg, of the table


@pytest.mark.parametrize("words", AMONG)
def test_two_others_hit_each_other_and_come_to_rest(words: str) -> None:
    kinds = AMONG[words]
    run, drive, others = parts(words, "lane_centring")
    assert run.outcome == "PASS", run.description  # who comes behind them brakes in time
    names = [each.name for each in others.actors]
    rows = [names.index(f"{kind} 1") for kind in kinds]
    sizes, states = [others.actors[row].size[:2] for row in rows], others.states[:, rows]
    overlaps = np.array([
        0.0 if np.isnan(pair).any() else box(pair[0], sizes[0]).intersection(box(pair[1], sizes[1])).area
        for pair in states
    ])  # fmt: skip
    first = int(np.flatnonzero(overlaps)[0])
    assert overlaps.max() < 0.1  # m2: nobody goes through the other
    (event,) = [each for each in drive.history if each.what == f"hits {kinds[1]} 1"]
    assert (event.who, event.time) == (f"{kinds[0]} 1", pytest.approx(0.1 * first, abs=0.11))
    assert f"{event.who} {event.what} at {event.time:.1f} s" in run.description
    velocity = np.diff(states[..., :2], axis=0) / 0.1
    masses = np.array([MASSES[kind] for kind in kinds])
    momenta = np.einsum("k,nkx->nx", masses, velocity)
    sliding = masses.sum() * 6.0 * 0.35  # kg m/s, by the deceleration between the two
    assert np.hypot(*(momenta[first + 1] - momenta[first - 2])) < sliding + 0.05 * np.hypot(
        *momenta[first - 2]
    )
    speeds = np.hypot(*np.moveaxis(velocity[first + 1 :], -1, 0))
    gains = np.diff(speeds, axis=0) / 0.1
    assert gains.max() < 0.5
    for own, change in zip(speeds.T, gains.T, strict=True):
        slides = own[1:] > 1.5
        assert np.allclose(change[slides], -6.0, atol=0.6)
    assert np.abs(states[-1, :, 4]).max() == 0.0


def test_traffic_behind_a_collision_of_others_stops_and_collides_with_nobody() -> None:
    words = (
        f"{TWO_LANES}ego v=50; van ahead gap=60 v=50: brake 4; car lane left v=50 hits=van 1: cut_in; medium"
    )
    _, drive, others = parts(words, "lane_centring")
    two = {"van 1", "car 1"}
    (hit,) = [each for each in drive.history if each.what == "hits van 1"]
    assert hit.time is not None
    for states in others.states[: round(10 * hit.time) + 400 : 2]:
        there = [n for n, each in enumerate(states) if np.isfinite(each[0])]
        boxes = [box(states[n], others.actors[n].size[:2]) for n in there]
        pairs = shapely.STRtree(boxes).query(boxes, predicate="intersects").T
        met = [{others.actors[there[n]].name for n in pair} for pair in pairs.tolist() if pair[0] < pair[1]]
        assert met in ([], [two])


@pytest.mark.parametrize(
    ("scene", "side"),
    [
        ("ego v=30 t=-0.8; car parked right gap=50: open_door", "left"),
        ("ego v=30 t=-0.8; van parked right gap=50: open_door left time=2", "left"),
        ("ego v=30; car parked left gap=50: open_door right ttc=4", "right"),
    ],
)
def test_a_door_opens_a_metre_into_the_way(scene: str, side: str) -> None:
    run, _, others = parts(f"straight 200 | lanes=1 against=1 && {scene}")
    car, door = others.states[:, 0], others.states[:, 1]
    assert others.actors[1].kind == "door"
    times = np.flatnonzero(np.isfinite(door[:, 0]))
    body = box(car[0], others.actors[0].size[:2])
    reach = [body.hausdorff_distance(body.union(box(door[n], others.actors[1].size[:2]))) for n in times]
    assert reach[0] < 0.4 < 0.9 < max(reach) < 1.15  # m
    turn = np.exp(-1j * car[0, 3]) * complex(*(door[-1, :2] - car[0, :2]))
    assert 0 < turn.real < others.actors[0].size[0] / 2  # a front door
    is_along = abs(np.angle(np.exp(1j * (car[0, 3] - run.drive["heading"][0])))) < 1.0
    assert (turn.imag > 0) == ((side == "left") == is_along)
    assert run.verdict is not None
    assert (run.verdict.cause == "collision") == ("t=-0.8" in scene), run.description
    assert all(each.other == "door 1" for each in run.verdict.incidents or () if each.contact)


@pytest.mark.parametrize(("who", "v"), [("truck ahead v=50", 50), ("pickup ahead thw=3 v=60", 60)])
def test_a_load_that_is_dropped_slides_and_lies_on_the_road(who: str, v: int) -> None:
    _, drive, others = parts(f"straight 400 && ego v=50; {who}: drop time=3", "lane_centring")
    load = others.states[:, [each.name for each in others.actors].index("lost_load 1")]
    there = load[np.isfinite(load[:, 0])]
    gone = np.hypot(*(there[-1, :2] - there[0, :2]))
    assert gone == pytest.approx((v / 3.6) ** 2 / 2 / (0.5 * 9.81), rel=0.05)
    assert there[-1, 4] == 0.0
    assert drive.history[0].time == 3.0


def test_a_bicycle_has_no_door() -> None:
    with pytest.raises(BriefError, match="no door"):
        read_plan("straight && bicycle parked right: open_door")
