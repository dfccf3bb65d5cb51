"""Pictures of roads: things are seen where a pinhole of our own says, and in the colours that they have."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from roadgpt.errors import UsageError
from roadgpt.road import Design, Road, Segment, World, build
from roadgpt.scene import Camera, CameraPlacement, Pose, Scenery

CAMERA = Camera(320, 180)
WORLD = World()
HIGH = 0.56  # m, centre of gravity


def design(turn: float, inclines: tuple[float, float] = (8, -8)) -> Design:
    return Design(
        starting_point=(60, 120, 0),
        theta=0,
        segments=(
            Segment(distance=50, direction="straight", incline=inclines[0]),
            Segment(distance=40, direction="left" if turn > 0 else "right", incline=0, turn_degrees=turn),
            Segment(distance=50, direction="straight", incline=inclines[1]),
        ),
    )


@pytest.fixture(scope="module")
def bent() -> Scenery:
    return Scenery.of(build(design(50)), WORLD)


@pytest.fixture(scope="module")
def straight() -> Scenery:
    return Scenery.of(Road.through([[0, 0], [50, 0], [100, 0], [160, 0]]), WORLD)


def on(road: Road, s: float, t: float = -2.0, **more: float) -> Pose:
    x, y, z = road.at(s, t)
    return Pose(x, y, z + HIGH, float(road.heading(s)), math.atan(float(road.grade(s))), **more)


def projected(camera: Camera, place: CameraPlacement, pose: Pose, points: np.ndarray) -> np.ndarray:
    """Columns, rows and depths of points, by rotations in Euler's way."""
    body = Rotation.from_euler("ZYX", [pose.heading, -pose.pitch, pose.roll])
    eye = np.array(pose[:3]) + body.apply([place.ahead, 0, place.up - HIGH])
    seen = (body * Rotation.from_euler("Y", -place.tilt)).inv().apply(points - eye)
    focal = camera.width / (2 * math.tan(camera.field_of_view / 2))
    column = camera.width / 2 - focal * seen[:, 1] / seen[:, 0]
    return np.column_stack([column, camera.height / 2 - focal * seen[:, 2] / seen[:, 0], seen[:, 0]])


def light(picture: np.ndarray, column: float, row: float) -> int:
    return int(picture[int(row), int(column)].min())


def markings(road: Road, s0: float) -> np.ndarray:
    """Middles of dashes, and of both edge lines, ahead."""
    s = np.arange(2.0, road.length - 4, 12.0)
    s = s[(s > s0 + 4) & (s < s0 + 26)]
    lines = s0 + np.array([6.0, 9.0, 13.0, 18.0])
    lines = lines[lines < road.length - 3]
    edge = WORLD.section.lane_width - 0.175
    return np.concatenate([road.at(s, 0.0), road.at(lines, edge), road.at(lines, -edge)])


@pytest.mark.parametrize(
    ("s", "t", "turned", "pitch", "roll"),
    [
        (5, -2, 0, 0, 0),
        (30, 0, 0.1, 0, 0.06),
        (60, -1, -0.2, 0.05, -0.05),
        (75, 1.5, 0.1, -0.04, 0),
        (95, -2, 0, 0, 0.1),
    ],
)
def test_markings_are_seen_where_a_pinhole_puts_them(
    bent: Scenery, s: float, t: float, turned: float, pitch: float, roll: float
) -> None:
    place = CameraPlacement(0.4, 2.2, -0.12)
    camera = Camera(640, 360, math.radians(80), "bonnet", place)
    at = on(bent.road, s, t)
    pose = at._replace(heading=at.heading + turned, pitch=at.pitch + pitch, roll=roll)
    picture = bent.render(camera, pose)
    found = 0
    for column, row, depth in projected(camera, place, pose, markings(bent.road, s)):
        if depth > 1 and 6 < column < 634 and 6 < row < 354:
            found += 1
            assert light(picture, column, row) > 150
            beside = picture[int(row), [int(column) - 40 if column > 46 else int(column) + 40]]
            assert beside.min() < 150
    assert found >= 4


def test_what_lies_behind_a_crest_is_hidden() -> None:
    over = Road.through([[x, 0, 9 * math.exp(-(((x - 60) / 22) ** 2))] for x in range(0, 141, 10)])
    scene = Scenery.of(over, WORLD)
    place = CameraPlacement(0.4, 1.3, 0.0)
    camera = Camera(640, 360, math.radians(40), "bonnet", place)
    pose = on(over, 20.0)
    eye = np.array(pose[:3]) + [place.ahead, 0, place.up - HIGH]
    s = np.arange(2.0, 120.0, 12.0)
    dashes = over.at(s, 0.0)
    sight = [
        (np.linspace(0, 1, 400)[:, None] * (dash - eye) + eye) for dash in dashes
    ]  # where the line of sight is above the road all along, the dash is seen
    free = np.array([(line[:-4, 2] > over.elevation.height(line[:-4, 0]) - 1e-3).all() for line in sight])
    seen = projected(camera, place, pose, dashes)
    ahead = (s > 28) & (seen[:, 1] < 355)
    assert (free & ahead).sum() >= 2
    assert (~free & (s > 70)).sum() >= 3
    picture = scene.render(camera, pose)
    for (column, row, _), is_free in zip(seen[ahead], free[ahead], strict=True):
        if is_free:
            assert light(picture, column, row) > 140
    looked_at = 0
    for column, row, _ in projected(camera, place, pose, dashes[~free & (s > 70)]):
        # on the near slope, where it has no paint of its own
        if 10 < column < 630 and row < 350 and min(abs(row - r) for _, r, _ in seen[free & ahead]) > 12:
            looked_at += 1
            assert light(picture, column, row) < 140
    assert looked_at >= 2


def test_left_is_left_and_a_mirrored_road_gives_a_mirrored_picture() -> None:
    pictures = []
    for turn in (60, -60):
        road = build(design(turn, (0, 0)))
        pictures.append(Scenery.of(road, WORLD).render(CAMERA, on(road, 25.0, 0.0)))
    left, right = (asphalt(picture) for picture in pictures)
    columns = np.arange(CAMERA.width)
    far = slice(80, 89)  # from where the bend begins
    assert (left[far] * columns).sum() / left[far].sum() < CAMERA.width / 2 - 10
    assert (right[far] * columns).sum() / right[far].sum() > CAMERA.width / 2 + 10
    assert (left == right[:, ::-1]).mean() > 0.96


def asphalt(picture: np.ndarray) -> np.ndarray:
    c = picture.astype(int)
    return (np.ptp(c, axis=2) < 14) & (c.mean(axis=2) < 130)


def test_a_straight_road_is_symmetric_and_has_its_colours(straight: Scenery) -> None:
    pose = on(straight.road, 20.0, 0.0)
    picture = straight.render(CAMERA, pose).astype(int)
    road = asphalt(picture)
    assert (road == road[:, ::-1]).mean() > 0.985
    grey = picture[150, 60]
    assert np.ptp(grey) < 16
    assert 60 < grey.mean() < 130
    r, g, b = picture[110, 8]
    assert g > r > b  # grass
    r, g, b = picture[20, 160]
    assert b > g > r  # sky
    assert b > 150
    assert picture[:, :, :].std() > 20


def test_the_same_pose_gives_the_same_bytes_in_any_thread(bent: Scenery) -> None:
    poses = [on(bent.road, s, steer=0.1, brake=0.5) for s in (10.0, 40.0, 70.0, 100.0)] * 2
    again = Scenery.of(build(design(50)), WORLD)
    one = [bent.render(CAMERA, pose, car=pose).tobytes() for pose in poses]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda pose: again.render(CAMERA, pose, car=pose).tobytes(), poses)) == one
    assert len(set(one)) == 4


def test_the_car_is_seen_from_behind_with_a_shadow_and_its_lights_brake(straight: Scenery) -> None:
    camera = Camera(320, 180, math.radians(50), "chase")
    pose = on(straight.road, 40.0)
    empty, still, braking = (
        straight.render(camera, pose, car=car).astype(int) for car in (None, pose, pose._replace(brake=0.4))
    )
    there = np.abs(still - empty).sum(axis=2) > 40
    rows, columns = np.nonzero(there)
    assert 0.02 < there.mean() < 0.25
    assert abs(columns.mean() - 160) < 25
    assert rows.mean() > 85
    red = (braking[..., 0] > 200) & (braking[..., 1] < 110)
    assert 15 < red.sum() < 800
    assert not ((still[..., 0] > 200) & (still[..., 1] < 110)).any()
    assert np.abs(red - red[:, ::-1].astype(int)).mean() < 0.02  # a lamp on either side
    shadow = (still.sum(axis=2) < empty.sum(axis=2) - 40) & (np.ptp(still, axis=2) < 20)
    assert shadow.sum() > 50


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"width": 0}, "0 by 360 pixels"),
        ({"field_of_view": 3.1}, "178 degrees|177.6 degrees"),
        ({"mount": "roof"}, "bonnet, chase, above"),
    ],
)
def test_a_camera_that_cannot_be_is_refused_in_a_sentence(numbers: dict, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        Camera(**numbers)
