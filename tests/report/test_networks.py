"""Pictures of routes: the whole network is seen, with its islands and lines, and junctions have names."""

import base64
import io
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text

from roadgpt.network import Route, made_from, network_of
from roadgpt.network.markings import arrows
from roadgpt.network.paved import paved_by
from roadgpt.report import birds_eye, height_profile, strip, view
from roadgpt.report.overview import pages
from roadgpt.report.page.maps import close_up
from roadgpt.report.plan_view import ASPHALT, GRASS, GROUND, KERB, PAINT, TINT, VERGE, Frame, draw_road
from roadgpt.road import Design, Profile, Road, World, read_design
from roadgpt.road.profile import LaneStrip
from roadgpt.run import Run, Setup, perform, prove, write_run

TWO = {
    "starting_point": [20, 90, 0],
    "theta": 0,
    "road_segment1": {"distance": 70, "direction": "straight", "incline": 3, "turn_degrees": 0},
    "junction1": {"after": 1, "kind": "crossroads", "take": "left", "control": "stop"},
    "road_segment2": {"distance": 40, "direction": "straight", "incline": 5, "turn_degrees": 0},
    "junction2": {"after": 2, "kind": "roundabout", "take": 3, "radius": 16},
    "road_segment3": {"distance": 60, "direction": "left", "incline": 0, "turn_degrees": 30},
}


def design() -> Design:
    return read_design(TWO)[0]


@pytest.fixture(scope="module")
def route() -> Route:
    found = made_from(design(), World())
    assert isinstance(found, Route)
    return found


@pytest.fixture(scope="module")
def alone(route: Route) -> Run:
    return replace(prove(route, setup=Setup(drives=False)), source="two.json")


@pytest.fixture(scope="module")
def above(alone: Run) -> Figure:
    return birds_eye(alone)


@pytest.fixture(scope="module")
def driven(route: Route) -> Run:
    return prove(route, 7)


def colour(text: str) -> np.ndarray:
    return np.array([int(text[i : i + 2], 16) for i in (1, 3, 5)])


@cache
def pixels_of(figure: Figure) -> np.ndarray:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())


def seen(figure: Figure, places: np.ndarray) -> np.ndarray:
    """The colours ``(n, 3)`` in bytes that a figure has at places ``(n, 2)`` in metres."""
    pixels = pixels_of(figure)
    at = figure.axes[0].transData.transform(places)
    return pixels[len(pixels) - 1 - at[:, 1].astype(int), at[:, 0].astype(int), :3].astype(int)


def near(pixels: np.ndarray, wanted: str, within: int = 12) -> np.ndarray:
    return np.abs(pixels - colour(wanted)).max(axis=1) <= within


def test_side_arms_are_asphalt(above: Figure, route: Route) -> None:
    on_route = {leg.road for leg in route.legs}
    arms = [each for each in route.network.plain_roads if each.id not in on_route]
    arms = [each for each in arms if each.id not in route.network.roundabout_of]
    assert len(arms) == 4
    places = [
        each.road.at(np.linspace(4, each.road.length - 4, 9), t)[:, :2] for each in arms for t in (-2, 2)
    ]
    assert near(seen(above, np.concatenate(places)), ASPHALT).all()


def test_the_lane_of_the_route_is_tinted_and_the_other_is_not(above: Figure, route: Route) -> None:
    first = route.network.road(route.legs[0].road).road
    s = np.linspace(5, 60, 40)
    assert near(seen(above, first.at(s, -3.2)[:, :2]), TINT).mean() > 0.8
    assert near(seen(above, first.at(s, 2.0)[:, :2]), ASPHALT).all()


def test_the_islands_are_not_asphalt(above: Figure, route: Route) -> None:
    (ring,) = route.network.roundabouts
    angles = np.linspace(0, 6, 20)
    places = np.array(ring.centre[:2]) + 9 * np.column_stack([np.cos(angles), np.sin(angles)])
    assert near(seen(above, places), GRASS).all()
    holes = [hole for part in shapely.get_parts(route.network.paved) for hole in part.interiors]
    small = [shapely.Polygon(hole) for hole in holes if shapely.Polygon(hole).area < 100]
    assert len(small) == 4
    dots = np.array([hole.representative_point().coords[0] for hole in small])
    # a wedge of a metre is few pixels wide, beside white lines
    assert (near(seen(above, dots), KERB, 30) | near(seen(above, dots), PAINT, 30)).all()


def test_no_line_crosses_a_junction(above: Figure, route: Route) -> None:
    crossing = route.network.junctions[0]
    inside = shapely.Polygon(route.network.outline(crossing.id)).buffer(-1.5)
    x0, y0, x1, y1 = inside.bounds
    grid = np.stack(np.meshgrid(np.arange(x0, x1, 0.3), np.arange(y0, y1, 0.3)), axis=-1).reshape(-1, 2)
    grid = grid[shapely.contains_xy(inside, grid)]
    pixels = seen(above, grid)
    is_white = near(pixels, PAINT, 8).mean()
    assert is_white < 0.01  # but for the arrow of the route
    assert near(pixels, ASPHALT).mean() > 0.5


def test_the_stop_line_is_white_where_the_road_ends(above: Figure, route: Route) -> None:
    first = route.network.road(route.legs[0].road).road
    t = np.linspace(-3.2, -0.8, 12)
    line = first.at(np.full(12, first.length - 0.25), t)[:, :2]
    before = first.at(np.full(12, first.length - 2.5), t)[:, :2]
    assert near(seen(above, line), PAINT, 40).mean() > 0.7
    assert not near(seen(above, before), PAINT, 40).any()


def test_a_key_explains_the_signs_that_are_drawn(above: Figure, alone: Run) -> None:
    entries = {"stop sign", "give-way sign", "priority sign", "traffic lights"}
    assert {text.get_text() for text in above.texts} & entries == entries - {"traffic lights"}
    centre = alone.road.network.roundabouts[0].centre  # type: ignore[union-attr]
    part = birds_eye(alone, frame=Frame(centre[0] - 40, centre[0] + 40, centre[1] - 40, centre[1] + 40))
    assert {text.get_text() for text in part.texts} & entries == {"give-way sign"}
    lone = birds_eye(alone, frame=Frame(-500, 500, -500, 500))
    assert not {text.get_text() for text in lone.texts} & entries


def test_heights_and_curvature_name_the_junctions(driven: Run) -> None:
    for figure in (height_profile(driven), strip(driven)):
        names = [text.get_text() for text in figure.findobj(Text)]
        assert names.count("crossroads") == 1
        assert names.count("roundabout") == 1


def greys(folder: Path) -> int:
    """How many pixels of an overview have the colour of asphalt."""
    (page,) = pages(folder)
    return int(near(pixels_of(page)[..., :3].reshape(-1, 3).astype(int), ASPHALT).sum())


def test_an_overview_shows_the_paved_area_behind_the_route(driven: Run, tmp_path: Path) -> None:
    write_run(driven, tmp_path)
    shown = greys(tmp_path)
    (tmp_path / "runs" / "0001" / "road.json").unlink()
    assert shown > greys(tmp_path) + 500


def test_the_place_of_a_failure_shows_the_junction_around_it(alone: Run, route: Route) -> None:
    """What is green or ground in it is not paved, and the rest is; apart from what lies near a border."""
    station = next(each.start for each in route.passages)
    svg = close_up(alone, station, "a place")
    data = base64.b64decode(svg.partition("base64,")[2].partition('"')[0])
    pixels = np.rint(255 * imread(io.BytesIO(data))[..., :3]).astype(int)
    x, y, _ = route.at(station, alone.world.profile_of(route).middle(station))
    at = (np.arange(len(pixels)) + 0.5) / len(pixels) * 52 - 26
    east, north = np.meshgrid(x + at, y - at)
    flat = pixels.reshape(-1, 3)
    is_green = np.any([near(flat, each) for each in (GRASS, VERGE, GROUND, KERB)], axis=0).reshape(east.shape)
    paved = shapely.contains_xy(route.network.paved, east, north)
    border = shapely.distance(route.network.paved.boundary, shapely.points(east, north))
    clear = (border > 0.5) & (np.hypot(east - x, north - y) < 25)
    assert 0.2 < paved[clear].mean() < 0.9
    assert (is_green == ~paved)[clear].mean() > 0.99


@pytest.mark.parametrize(
    "plan",
    [
        "straight 200 | lanes=4 against=0",
        "straight 80 | lanes=3 against=1 // crossroads straight // straight 80 | lanes=3 against=1",
    ],
)
def test_from_far_away_lines_lie_in_the_middle_of_carriageway_and_lane(plan: str) -> None:
    """Of the carriageway, half its width from the edge of the paved area; of the lane, where a car
    drives."""
    run = perform(plan, 1, setup=Setup(reader="plan", driver="reference"))
    assert run.road is not None
    assert run.drive is not None
    axes = Figure().add_subplot()
    draw_road(axes, run.road, run.world, 200.0)
    lines = [path.vertices for each in axes.collections for path in each.get_paths()]
    lines += [np.asarray(each.get_xydata()) for each in axes.lines]
    driven = shapely.LineString(np.stack([run.drive["x"], run.drive["y"]], axis=-1))
    network = network_of(run.road, run.world)
    for member, line in zip(network.roads, lines, strict=False):
        if member.junction is None:
            on, whole = shapely.LineString(line).interpolate(0.5, normalized=True), paved_by([member.road])
            half = whole.area / member.road.length / 2
            assert shapely.distance(whole.boundary, on) == pytest.approx(half, rel=0.02)
    if len(network.roads) > 1:
        away = shapely.distance(driven, shapely.points(lines[-1][40:-40]))
        assert away.max() < 1.0


def test_arrows_before_a_junction_are_drawn() -> None:
    data = {**TWO, "lanes": {"forward": 2, "backward": 2, "width": 3.5}}
    data["junction2"] = {**TWO["junction2"], "ring_lanes": 2}
    found = made_from(read_design(data)[0], World())
    assert isinstance(found, Route)
    picture = birds_eye(prove(found, setup=Setup(drives=False)))
    outer = next(each for each in arrows(found.network) if each.end.road == 1 and each.lane == -2)
    head = outer.points[np.argsort(outer.points[:, 0])[-8:]].mean(axis=0)
    assert near(seen(picture, head[None, :2]), PAINT, 40).all()


@pytest.mark.parametrize("is_route", [True, False])
def test_medians_are_green(is_route: bool) -> None:
    road: Road
    if is_route:
        lanes = {"forward": 2, "backward": 2, "width": 3.5, "divided": True}
        data = {**TWO, "lanes": lanes, "junction1": {**TWO["junction1"], "crosswalk": True}}
        data["junction2"] = {"after": 2, "kind": "crossroads", "take": "straight"}
        route = made_from(read_design(data)[0], World())
        assert isinstance(route, Route)
        road, profile = route, route.network.road(route.legs[0].road).profile
    else:
        plain = Profile.of(2, 2, 3.5)
        profile = replace(plain, left=(LaneStrip("median", 2.0, "solid"), *plain.left))
        road = Road.through([[20, 90, 0], [60, 90, 0], [120, 90, 3]]).with_profile(profile)
    run = prove(road, setup=Setup(drives=False))
    x = np.array([24.0, 32.0, 50.0, 65.0])
    y = np.full(4, 90 + sum(float(t) for t in profile.edges_of(1, 0.0)) / 2)
    assert near(seen(birds_eye(run), np.column_stack([x, y])), GRASS).all()
    told = view.scene(run)
    shown = told["network"]["roads"][0]["lanes"] if is_route else told["road"]["lanes"]
    strip_ = shown["median"]
    assert [shown["bounds"][strip_["strip"] + n]["t"] for n in (0, 1)] == [2.0, 0.0]
    assert (strip_["from"], strip_["to"]) == pytest.approx((0.0, 65.0 if is_route else road.length), abs=1e-3)
