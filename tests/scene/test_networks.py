"""Camera images of networks: what lies on the ground is seen where a straight look down finds it."""

import math

import numpy as np
import pytest
import shapely

from roadgpt.network import Route, made_from
from roadgpt.network.markings import arrows, signs
from roadgpt.road import CrossSection, World, read_design
from roadgpt.scene import Camera, CameraPlacement, Pose, Scenery
from roadgpt.scene.network_mesh import faces_of

HIGH = 40.0  # m, of a camera that looks down
STRAIGHT = {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0}


def route_of(world: World | None = None, lanes: dict[str, object] | None = None, **junction: object) -> Route:
    data = {
        "starting_point": [40, 60, 2],
        "theta": 0,
        **({"lanes": lanes} if lanes else {}),
        "road_segment1": STRAIGHT,
        "junction1": {"after": 1, **junction},
        "road_segment2": {**STRAIGHT, "incline": 6},
    }
    found = made_from(read_design(data)[0], world or World())
    assert isinstance(found, Route)
    return found


@pytest.fixture(scope="module")
def crossing() -> Scenery:
    return Scenery.of(route_of(kind="crossroads", take="left", control="stop"), World())


@pytest.fixture(scope="module")
def ring() -> Scenery:
    return Scenery.of(route_of(kind="roundabout", take="straight", radius=12), World())


def network_of(scene: Scenery) -> Route:
    assert isinstance(scene.road, Route)
    return scene.road


def camera(high: float = HIGH) -> Camera:
    return Camera(400, 400, math.radians(70), "above", CameraPlacement(0.0, high, -math.pi / 2))


def seen(
    scene: Scenery, middle: tuple[float, float, float], places: np.ndarray, high: float = HIGH
) -> np.ndarray:
    """The colours ``(n, 3)`` of places ``(n, 2)`` from above a point; north is on the left."""
    x, y, z = middle
    picture = scene.render(camera(high), Pose(x, y, z + 0.56, 0.0)).astype(int)
    per_metre = 200 / math.tan(math.radians(35)) / high
    columns = 200 - (places[:, 1] - y) * per_metre
    rows = 200 - (places[:, 0] - x) * per_metre
    return picture[rows.astype(int), columns.astype(int)]


def is_grey(pixels: np.ndarray) -> np.ndarray:
    return (np.ptp(pixels, axis=1) < 16) & (pixels.max(axis=1) < 150)


def is_green(pixels: np.ndarray) -> np.ndarray:
    return pixels[:, 1] > pixels[:, 2] + 20


def is_white(pixels: np.ndarray) -> np.ndarray:
    return pixels.min(axis=1) > 165


def inner(area: shapely.Geometry, step: float = 0.7) -> np.ndarray:
    x0, y0, x1, y1 = area.bounds
    grid = np.stack(np.meshgrid(np.arange(x0, x1, step), np.arange(y0, y1, step)), axis=-1).reshape(-1, 2)
    return grid[shapely.contains_xy(area, grid)]


def test_the_whole_junction_is_asphalt_without_lines(crossing: Scenery) -> None:
    network = network_of(crossing).network
    junction = network.junctions[0]
    inside = shapely.Polygon(network.outline(junction.id)).buffer(-0.5)
    close = shapely.Point(junction.node[:2]).buffer(24)
    pixels = seen(crossing, junction.node, inner(shapely.intersection(inside, close)))
    assert is_grey(pixels).mean() > 0.995


def test_side_arms_are_asphalt_and_have_their_lines(crossing: Scenery) -> None:
    network = network_of(crossing).network
    junction = network.junctions[0]
    for arm in junction.arms[1:]:
        member = network.road(arm.end.road)
        s = np.linspace(1.0, 4.0, 12)
        assert is_grey(seen(crossing, junction.node, member.road.at(s, 2.0)[:, :2])).all()
        at_edges = seen(crossing, junction.node, member.road.at(s, -4 + 0.175)[:, :2])
        assert is_white(at_edges).mean() > 0.4


def test_islands_are_not_asphalt(ring: Scenery) -> None:
    (roundabout,) = network_of(ring).network.roundabouts
    x, y, _ = roundabout.centre
    places = inner(shapely.Point(x, y).buffer(8))
    assert is_green(seen(ring, roundabout.centre, places)).mean() > 0.98
    on_ring = inner(
        shapely.difference(
            shapely.Point(x, y).buffer(roundabout.radius + 4.2),
            shapely.Point(x, y).buffer(roundabout.radius + 0.8),
        )
    )
    assert is_grey(seen(ring, roundabout.centre, on_ring)).mean() > 0.99


def test_signs_face_the_traffic_that_arrives() -> None:
    route = route_of(kind="crossroads", take="left", control="lights")
    for sign in signs(route.network):
        ahead = np.array([math.cos(sign.heading), math.sin(sign.heading), 0.0])
        heads = [face for face in faces_of(sign) if face.colour in ("dim red", "dim yellow", "green")]
        assert [face.colour for face in heads] == ["green", "dim yellow", "dim red"]  # lights are green
        assert heads[0].points[:, 2].mean() < heads[2].points[:, 2].mean()
        for face in heads:
            assert np.ptp(face.points[:, 2]) == pytest.approx(0.3, abs=0.01)  # m: the large lens of EN 12368
            normal = np.cross(face.points[1] - face.points[0], face.points[2] - face.points[1])
            assert normal @ ahead < -0.99 * np.linalg.norm(normal)


@pytest.mark.parametrize("control", ["yield", "lights"])
@pytest.mark.parametrize("shoulder", [0.0, 2.0])
def test_all_kinds_give_the_same_image_twice(control: str, shoulder: float) -> None:
    world = World(section=CrossSection(shoulder=shoulder))
    route = route_of(world, kind="t_junction", take="right", control=control)
    x, y, z = route.at(30.0, -2.0)
    pictures = [Scenery.of(route, world).render(Camera(64, 36), Pose(x, y, z + 0.56, 0.0)) for _ in range(2)]
    assert (pictures[0] == pictures[1]).all()


def test_the_route_begins_with_a_white_line_and_ends_with_a_chequered_band(crossing: Scenery) -> None:
    route = network_of(crossing)
    start, end = route.at(0.0), route.at(route.length)
    assert is_white(seen(crossing, tuple(start), route.at(np.full(9, 0.5), np.linspace(-3, -1, 9)))).all()
    across = np.linspace(-3.6, -0.3, 60)
    band = seen(crossing, tuple(end), route.at(np.full(60, route.length - 0.25), across)[:, :2])
    assert 0.3 < is_white(band).mean() < 0.7
    assert (band.max(axis=1) < 80).mean() > 0.3


@pytest.mark.parametrize(
    ("lanes", "solid", "broken"),
    [
        ({"forward": 2, "backward": 2, "centre": "broken"}, [], [-3.5, 0.0, 3.5]),
        ({"forward": 2, "backward": 2}, [0.0], [-3.5, 3.5]),
        ({"forward": 2, "backward": 1, "centre": "solid"}, [0.0], [-3.5]),
        ({"forward": 3, "backward": 0}, [], [-3.5, -7.0]),
        ({"forward": 1, "backward": 1, "centre": "none"}, [], []),
    ],
)
def test_lines_between_lanes_lie_where_lanes_meet(
    lanes: dict[str, object], solid: list[float], broken: list[float]
) -> None:
    data = {
        "starting_point": [40, 60, 2],
        "theta": 0,
        "lanes": {"width": 3.5, **lanes},
        "road_segment1": STRAIGHT,
        "junction1": {"after": 1, "kind": "crossroads", "take": "straight"},
        "road_segment2": STRAIGHT,
    }
    route = made_from(read_design(data)[0], World())
    assert isinstance(route, Route)
    scene = Scenery.of(route, World())
    x = np.arange(50.0, 66.0, 0.05)

    def white(t: float) -> float:
        pixels = seen(scene, (58.0, 60.0, 2.0), np.column_stack([x, np.full_like(x, 60.0 + t)]), 14.0)
        return float(is_white(pixels).mean())

    for t in solid:
        assert white(t) > 0.95
    for t in broken:
        assert 0.15 < white(t) < 0.6
    unpainted = {-1.75, 1.75 if lanes["backward"] else -5.25, *({0.0, -3.5, 3.5} - {*solid, *broken})}
    inside = [
        t
        for t in unpainted
        if -3.5 * int(str(lanes["forward"])) + 0.5 < t < 3.5 * int(str(lanes["backward"])) - 0.5
    ]
    assert inside
    for t in inside:
        assert white(t) < 0.02


def test_arrows_are_white_and_the_asphalt_beside_them_is_not() -> None:
    data = {
        "starting_point": [40, 60, 2],
        "theta": 0,
        "lanes": {"forward": 2, "backward": 2, "width": 3.5},
        "road_segment1": STRAIGHT,
        "junction1": {"after": 1, "kind": "crossroads", "take": "left"},
        "road_segment2": STRAIGHT,
    }
    route = made_from(read_design(data)[0], World())
    assert isinstance(route, Route)
    found = [shapely.Polygon(each.points[:, :2]) for each in arrows(route.network) if each.end.road == 1]
    assert len(found) == 2
    scene, place = Scenery.of(route, World()), (87.0, 57.0, 2.0)
    for outline in found:
        assert is_white(seen(scene, place, inner(outline.buffer(-0.04), 0.02), 6.0)).all()
        ring = shapely.difference(outline.buffer(0.2), outline.buffer(0.05))
        assert is_grey(seen(scene, place, inner(ring, 0.05), 6.0)).all()
