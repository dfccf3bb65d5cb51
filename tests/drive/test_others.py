"""A drive among others: what the driver sees, when the car touches somebody, how it goes on, and its file."""

import io
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from roadgpt.drive import Command, Drive, View, simulate
from roadgpt.drive.company import in_sight, look_around
from roadgpt.drive.drive_monitor import DriveMonitor
from roadgpt.errors import UsageError
from roadgpt.geometry.boxes import corners
from roadgpt.ground.sight import OPEN
from roadgpt.road import Limits, Road, World
from roadgpt.traffic import SIZES, Actor, Tracks

LIMIT = 36 / 3.6
WORLD = World(limits=Limits(speed_limit=LIMIT))
ROAD = Road.through([[20, 100, 0], [120, 100, 4], [220, 100, 4]])
LANE = 98.0  # y of the middle of the car's lane


class Straight:
    """Keeps its wheels straight and its speed; notes what it sees."""

    name = "straight"

    def __init__(self, brakes: bool = False) -> None:
        self.views: list[View] = []
        self.brakes = brakes

    def steer(self, view: View) -> Command:
        self.views.append(view)
        return Command(0.0, *((0.0, 1.0) if self.brakes else (0.3 * max(LIMIT - view.vx, 0.0), 0.0)))


def tracks(*rows: tuple[str, float, float, float, float]) -> Tracks:
    """Actors by kind, x and y at first, heading and speed, for 60 s; on the road at the car's height."""
    time = np.arange(0, 60, 0.1)[:, None]
    kinds, x, y, heading, speed = zip(*rows, strict=True)
    x, y = (
        np.array(first) + time * np.array(speed) * turn(heading) for first, turn in ((x, np.cos), (y, np.sin))
    )
    z = np.interp(x, [20, 120, 220], [0, 4, 4])
    states = np.stack([x, y, z, x * 0 + heading, x * 0 + speed], axis=-1)
    actors = tuple(Actor(f"{kind} {n}", kind, SIZES[kind]) for n, kind in enumerate(kinds))
    return Tracks(actors, np.round(states, 3))


def test_boxes_touch_where_shapely_says_so_and_the_nearest_come_first() -> None:
    rng = np.random.default_rng(1)
    for _ in range(300):
        n = int(rng.integers(1, 9))
        kinds = rng.choice([*SIZES], n)
        states = np.column_stack(
            [rng.uniform(-12, 12, (n, 2)), rng.choice([0, 0, 0, 9], n), rng.uniform(-9, 9, n), np.zeros(n)]
        )
        states[:, 0] *= rng.choice([1, 1, 30], n)
        states[rng.random(n) < 0.1] = np.nan
        car = np.array([1.0, -2.0, 0.0, rng.uniform(-9, 9), 4.7, 1.86])
        looks, order = np.array([(*SIZES[kind], 1, 200) for kind in kinds], float), np.zeros(n, np.int64)
        count, touches = look_around(states, looks, car, order, np.zeros((n, 7)))
        box = shapely.Polygon(corners(np.array(car[:2]), car[3], np.array([4.7, 1.86])))
        level = [k for k in range(n) if states[k, 2] == 0]
        others = [
            shapely.Polygon(corners(states[k][:2], states[k][3], np.array(SIZES[kinds[k]]))) for k in level
        ]
        assert touches == any(box.intersects(other) for other in others)
        far = np.hypot(*(states[:, :2] - car[:2]).T)
        assert order[:count].tolist() == [k for k in np.argsort(far) if far[k] <= 200]


@pytest.fixture(scope="module")
def crash() -> tuple[Drive, Straight, Tracks]:
    others = tracks(
        ("truck", 200, 105, 3.1, 12), ("barrier", 90, LANE - 1, 0, 0), ("adult", 60, 90, np.pi / 2, 0.1),
        ("bus", 500, LANE, 0, 0),
    )  # fmt: skip
    driver = Straight()
    return simulate(ROAD, WORLD, driver, 1, replay=others), driver, others


def test_the_car_rolls_brakes_from_the_first_contact_on_and_stops_being_driven_3_s_later(
    crash: tuple[Drive, Straight, Tracks],
) -> None:
    drive, _, others = crash
    assert drive.ended == "collision"
    assert drive["speed"][0] == pytest.approx(LIMIT, abs=1e-9)
    assert np.abs(drive["ax"][1:25]).max() < 2.0
    assert np.abs(np.diff(drive["vz"][:25])).max() / 0.02 < 1.0  # m/s^2: no jolt
    touching = []
    for step, time in enumerate(drive["time"].tolist()):
        box, states = shapely.Polygon(drive.corners(step)), others.at(time)
        touching += [
            time
            for state, actor in zip(states, others.actors, strict=True)
            if box.intersects(shapely.Polygon(corners(state[:2], state[3], np.array(actor.size))))
        ]
    assert drive.duration == pytest.approx(touching[0] + 3.0, abs=1e-6)
    later = drive["time"] > touching[0] + 0.01
    assert (drive["brake"][later] == 1).all()
    assert (drive["throttle"][later] == 0).all()
    assert (drive["brake"][~later][1:] == 0).all()
    assert drive["speed"][-1] < 0.1


def test_the_driver_sees_who_is_within_200_m_and_the_file_holds_everybody(
    crash: tuple[Drive, Straight, Tracks], tmp_path: Path
) -> None:
    drive, driver, others = crash
    for view in driver.views[::20]:
        box = drive.car
        x, y = view.x + box.ahead * np.cos(view.heading), view.y + box.ahead * np.sin(view.heading)
        expected = []
        for state, actor in zip(others.at(view.time), others.actors, strict=True):
            far = float(np.hypot(state[0] - x, state[1] - y))
            if far <= 200:
                expected.append((far, (actor.kind, *state[[0, 1, 3, 4]].tolist(), *actor.size[:2])))
        assert [other[0] for other in view.others] == [other[0] for _, other in sorted(expected)]
        for seen, (_, there) in zip(view.others, sorted(expected), strict=True):
            assert seen[1:7] == pytest.approx(there[1:], abs=1e-6)
    assert {"truck", "barrier", "adult"} == {other.kind for other in driver.views[0].others}
    assert drive.others is not None
    count = len(drive.others)
    assert (count - 1) * 0.1 >= drive.duration
    np.testing.assert_array_equal(drive.others.states, others.states[:count])
    (tmp_path / "drive.npz").write_bytes(drive.to_bytes())
    back = Drive.load(tmp_path / "drive.npz")
    assert back.others is not None
    assert back.others.actors == others.actors
    np.testing.assert_array_equal(back.others.states, drive.others.states)
    assert back.to_bytes() == drive.to_bytes()
    again = simulate(ROAD, WORLD, Straight(), 1, replay=others)
    assert again.to_bytes() == drive.to_bytes()


@pytest.mark.parametrize(
    ("scene", "lit", "unlit"),
    [("fog 30", 30, 30), ("night", 300, 50), ("fog 20..40", 0, 0), ("low_sun", 1e9, 1e9)],
)
def test_weather_hides_who_is_beyond_the_visual_range_and_changes_nothing_else(
    crash: tuple[Drive, Straight, Tracks], scene: str, lit: float, unlit: float
) -> None:
    clear, before, others = crash
    driver = Straight()
    drive = simulate(ROAD, WORLD.changed(scene=scene), driver, 1, replay=others)
    assert drive.to_bytes() == clear.to_bytes()  # nobody looks, and contact is contact
    if ".." in scene:  # drawn by the seed, and told to drivers
        lit = unlit = driver.views[0].world.scene.weather[0].amount.lo
        assert 20 < lit < 40
        assert lit == driver.views[0].world.scene.weather[0].amount.hi
    for view, whole in zip(driver.views[::20], before.views[::20], strict=True):
        middle = drive.car.ahead * np.array([np.cos(view.heading), np.sin(view.heading)]) + [view.x, view.y]
        near = [
            other for other in whole.others
            if np.hypot(*(middle - [other.x, other.y])) - other.length / 2
            <= (lit if other.kind in ("truck", "bus") else unlit)
        ]  # fmt: skip
        assert list(view.others) == near
    assert (
        min(len(view.others) for view in driver.views) < min(len(view.others) for view in before.views)
    ) == (scene != "low_sun")


def test_nobody_leaves_no_trace(crash: tuple[Drive, Straight, Tracks]) -> None:
    alone = replace(crash[0], others=None)
    with np.load(io.BytesIO(alone.to_bytes())) as archive:
        assert "others" not in archive.files
        assert "others" not in json.loads(str(archive["header"]))
    code = (
        "import sys; from roadgpt import simulate, World; from roadgpt.road import Road\n"
        "simulate(Road.through([[20, 100], [40, 100]]), World(), 'pure_pursuit').to_bytes()\n"
        "print([name for name in sys.modules if name.startswith('roadgpt.traffic')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_who_is_gone_has_no_numbers_and_files_of_before_are_read(
    crash: tuple[Drive, Straight, Tracks], tmp_path: Path
) -> None:
    states = crash[0].others.states.copy()  # type: ignore[union-attr]
    states[:4, 1] = np.nan
    drive = replace(crash[0], others=Tracks(crash[0].others.actors, states))  # type: ignore[union-attr]
    with np.load(io.BytesIO(drive.to_bytes())) as archive:
        parts = {name: np.array(archive[name]) for name in archive.files}
    assert np.isnan(parts["others"][:4, 1]).all()
    np.testing.assert_array_equal(parts["others"][..., 0], np.rint(1000 * states[..., 0]))
    np.savez(
        tmp_path / "drive.npz", **parts | {"others": np.nan_to_num(parts["others"], nan=-(2**62)).astype(int)}
    )
    others = Drive.load(tmp_path / "drive.npz").others
    assert others is not None
    np.testing.assert_array_equal(others.states, states)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda parts: parts.pop("others"), "others"),
        (lambda parts: parts["header"].pop("others"), "unknown: others"),
        (lambda parts: parts.update(others=parts["others"][:, :2]), "five whole numbers"),
        (lambda parts: parts.update(others=parts["others"].astype(np.float32)), "five whole numbers"),
        (lambda parts: parts.update(others=parts["others"] + 0.5), "five whole numbers"),
        (lambda parts: parts["others"].__setitem__((3, 1, 2), np.inf), "five whole numbers"),
        (lambda parts: parts.update(others=parts["others"][:5]), "until the end"),
        (lambda parts: parts["others"].__setitem__((3, 1, 2), -(2**62)), "as a whole"),
        (lambda parts: parts["others"].__setitem__((3, 1, 2), np.nan), "as a whole"),
        (lambda parts: parts["header"]["others"][0].__setitem__(1, "tank"), "tank"),
        (lambda parts: parts["header"]["others"][0].__setitem__(2, [1, 0, 1]), "sizes above 0"),
        (lambda parts: parts["header"]["others"][0].__setitem__(0, "bus 3"), "different names"),
    ],
)
def test_a_file_with_wrong_others_is_told_so(
    crash: tuple[Drive, Straight, Tracks], tmp_path: Path, change, why
) -> None:
    with np.load(io.BytesIO(crash[0].to_bytes())) as archive:
        parts = {name: np.array(archive[name]) for name in archive.files}
    parts["header"] = json.loads(str(parts["header"]))
    change(parts)
    parts["header"] = np.array(json.dumps(parts["header"]))
    np.savez(tmp_path / "drive.npz", **parts)
    with pytest.raises(UsageError, match=rf"(?s)not a drive .*{why}"):
        Drive.load(tmp_path / "drive.npz")


def test_among_others_who_stands_is_stuck_after_120_s_and_the_lane_may_be_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    beside = tracks(("van", 100, 80, 0, 0))
    drive = simulate(ROAD, WORLD, Straight(brakes=True), replay=beside)
    assert drive.ended == "stuck"
    moves = np.flatnonzero(np.hypot(np.diff(drive["x"]), np.diff(drive["y"])) > 1e-3)[-1]
    assert drive.duration == pytest.approx(120.0 + drive["time"][moves], abs=1.0)
    bend = Road.through([[20, 100], [60, 100], [90, 120], [100, 150], [100, 190]])
    assert simulate(bend, WORLD, Straight()).ended == "out_of_lane"
    monkeypatch.setattr("roadgpt.drive.drive_monitor.STUCK_AMONG_OTHERS", 10.0)
    left = simulate(bend, WORLD, Straight(), replay=beside)
    assert left.max_outside == 1.0
    assert left.ended in ("fell", "stuck")
    assert DriveMonitor(ROAD, WORLD, drive.car, among_others=True).limit == pytest.approx(ROAD.length + 30)


def test_a_driver_in_a_process_of_its_own_sees_the_same(tmp_path: Path) -> None:
    (tmp_path / "looker.py").write_text(
        "from roadgpt.drive import Command\n\n\nclass Looker:\n    def steer(self, view):\n"
        "        near = [each for each in view.others if each.kind == 'car' and each.speed < 1]\n"
        "        return Command(0.0, 0.2, 0.0) if not near else Command(0.01 * near[0].width, 0.0, 0.2)\n"
    )
    others = tracks(("car", 260, 140, 0, 0), ("car", 100, 102, 3, 2))
    road = Road.through([[20, 100, 0], [70, 100, 0], [120, 100, 0]])
    there = simulate(road, WORLD, f"{tmp_path / 'looker.py'}:Looker", replay=others)
    sys.path.insert(0, str(tmp_path))
    try:
        from looker import Looker  # type: ignore[import-not-found]
    finally:
        sys.path.remove(str(tmp_path))
    here = simulate(road, WORLD, Looker, replay=others)
    assert here.to_bytes() == there.to_bytes()
    assert here["brake"].max() == 0.2


def test_a_simulator_without_others_refuses_them() -> None:
    class Lonely:
        def simulate(self, *given: object) -> Drive:
            raise AssertionError

    with pytest.raises(UsageError, match="cannot move others on the road yet"):
        simulate(ROAD, WORLD, "reference", simulator=Lonely(), replay=tracks(("car", 1, 2, 0, 0)))
    with pytest.raises(UsageError, match=r"cannot apply the weather, .* leave the scene out"):
        simulate(ROAD, WORLD.changed(scene="fog 60"), "reference", simulator=Lonely())
    with pytest.raises(UsageError, match="cannot move others"):
        simulate(ROAD, WORLD.changed(scene="light; fog 60"), "reference", simulator=Lonely())
    with pytest.raises(UsageError, match="cannot move others"):
        simulate(ROAD, WORLD, "reference", simulator="beamng", replay=tracks(("car", 1, 2, 0, 0)))


def seen_by_samples(eye: np.ndarray, boxes: list[np.ndarray], k: int, spare: float) -> bool:
    """Whether a line from the eye to the top of box ``k``, at its middle or a corner, passes all other boxes,
    which are ``spare`` metres larger on all sides; tried at many points of the line."""
    for point in [
        boxes[k][:2],
        *corners(boxes[k][:2], boxes[k][3], boxes[k][5:7]),
    ]:
        share = np.linspace(0, 1, 4001)[:, None]
        line = eye + share * (np.array([*point, boxes[k][2] + boxes[k][7]]) - eye)
        is_free = True
        for m, box in enumerate(boxes):
            c, s = np.cos(box[3]), np.sin(box[3])
            dx, dy = line[:, 0] - box[0], line[:, 1] - box[1]
            inside = (np.abs(dx * c + dy * s) < box[5] / 2 + spare) & (
                np.abs(dy * c - dx * s) < box[6] / 2 + spare
            )
            inside &= (line[:, 2] > box[2] - spare) & (line[:, 2] < box[2] + box[7] + spare)
            is_free = is_free and (m == k or not inside.any())
        if is_free:
            return True
    return False


def in_view(eye: np.ndarray, boxes: np.ndarray, road: np.ndarray, reach: float = 200.0) -> set[int]:
    order = np.argsort(np.hypot(*(boxes[:, :2] - eye[:2]).T))
    seen = np.ascontiguousarray(boxes[order, :4])
    # in one piece, as in drives: for others it would be compiled again
    states, sizes = np.ascontiguousarray(boxes[:, :5]), np.ascontiguousarray(boxes[:, 5:])
    kept = in_sight(states, sizes, eye, road, OPEN, order, seen, len(boxes), reach)
    np.testing.assert_array_equal(seen[:kept, :2], boxes[order[:kept], :2])
    far = np.hypot(*(boxes[order[:kept], :2] - eye[:2]).T)
    assert (np.diff(far) >= 0).all()
    return set(order[:kept].tolist())


def test_boxes_hide_what_is_lower_behind_them() -> None:
    rng, eye, none, hidden = np.random.default_rng(3), np.array([1.0, -2.0, 1.2]), np.empty((0, 3)), 0
    for _ in range(40):
        n = int(rng.integers(2, 9))
        sizes = np.array([SIZES[kind] for kind in rng.choice([*SIZES], n)])
        boxes = np.column_stack(
            [
                rng.uniform(3, 40, n),
                rng.uniform(-9, 9, n),
                np.zeros(n),
                rng.uniform(-9, 9, n),
                np.zeros(n),
                sizes,
            ]
        )
        found = in_view(eye, boxes, none)
        for k in range(n):
            surely, perhaps = (seen_by_samples(eye, [*boxes], k, spare) for spare in (0.02, -0.02))
            assert not surely or k in found
            assert perhaps or k not in found
        hidden += n - len(found)
    assert hidden > 25


def test_a_crest_hides_who_is_low_behind_it_and_nobody_is_seen_beyond_the_reach() -> None:
    eye = np.array([0.0, 0.0, 1.2])
    x = np.arange(-200.0, 205.0, 5.0)
    road = np.column_stack([x, 0 * x, -(x**2) / 2000.0])  # a crest of 1,000 m, on which the car stands
    # the line that touches a parabola of radius R from h above it is sqrt(2 R h) long
    for kind in ("adult", "car", "truck", "lost_load"):
        farthest = np.sqrt(2000 * 1.2) + np.sqrt(2000 * SIZES[kind].height)
        for at, expected in ((farthest - 6, True), (farthest + 6, False)):
            box = np.array([[at, 0, -(at**2) / 2000, 0, 0, *SIZES[kind]]])
            assert (in_view(eye, box, road) == {0}) is expected
            assert in_view(eye, box, road + [0, 30, 0]) == {0}  # a road elsewhere hides nobody
            assert in_view(eye, box, road, at - 1) == set()
