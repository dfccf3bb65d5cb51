"""Pictures of roads in land: hills, contour lines, water, bridges and tunnels, and how far the driver sees.

The second opinions: land whose heights are known, what matplotlib's own contour lines lie on, formulas of
earthworks, and of stopping distances (AASHTO Green Book, 3.2.2)."""

import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.text import Text

from network.random_maps import map_route
from road_parts import design_of, named
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.ground.files import named as land_named
from roadgpt.ground.relief import Relief
from roadgpt.network.landscape import crossings, ground_around
from roadgpt.report import birds_eye, draw, height_profile, strip
from roadgpt.report.plan_view import Frame
from roadgpt.report.relief import CUT, FILL, WATER
from roadgpt.road import Road, World
from roadgpt.run import Run, Setup, prove

DESIGN = design_of((60, 0, 5), (45, 65, 2), (50, 0, 5), (75, -60, 0), start=(60.0, 60.0, 10.0))
CROSSED = "bridge len=40; tunnel len=50"
RIM = 7.0  # m from the centre line


@cache
def run(scene: str = "", ground: str = "", drives: bool = False) -> Run:
    world = World().changed(scene=scene, ground=ground, map_size=400)
    return named(prove(DESIGN, 7, world=world, setup=Setup(drives=drives)), "a road in land")


def on(heights: Array, road: Road) -> Run:
    """A road that is not driven, on land with heights every 10 m."""
    relief = Relief(0.0, 0.0, 10.0, heights, np.full_like(heights, np.nan), np.empty((0, 3)))
    world = World().changed(ground=land_named("x.npy", relief))
    return named(prove(road, world=world, setup=Setup(drives=False)), "a road on given land")


def level(length: float, height: float) -> Road:
    plan = PieceCurve(100.0, 200.0, 0.0, (Piece(length),))
    return Road(plan, GradeProfile.level(length, height))


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text) if text.get_text().strip()]


def contours(axes: Axes) -> list[QuadContourSet]:
    return [each for each in axes.collections if isinstance(each, QuadContourSet)]


def areas(axes: Axes, colour: str) -> float:
    """The area in m^2 of everything of this colour between two lines."""
    found = 0.0
    for each in axes.collections:
        if isinstance(each, PolyCollection) and to_rgba(each.get_facecolor()[0][:3]) == to_rgba(colour):
            for path in each.get_paths():
                x, y = path.vertices.T
                found += abs(float(x @ np.roll(y, 1) - y @ np.roll(x, 1))) / 2
    return found


@pytest.mark.parametrize("drives", [False, True])
def test_without_land_no_picture_shows_any(drives: bool) -> None:
    plain = run(drives=drives)
    assert not [image for axes in birds_eye(plain).axes[:1] for image in axes.images]
    assert not contours(birds_eye(plain).axes[0])
    for picture in (birds_eye, height_profile, strip):
        said = " ".join(words(picture(plain)))
        assert not re.search(r"bridge|tunnel|sight|\bcut\b|m³", said)
    assert not areas(height_profile(plain).axes[0], CUT) + areas(height_profile(plain).axes[0], FILL)
    labels = {axes.get_ylabel() for axes in strip(plain).axes}
    assert labels == {"curvature, 1/m", "radius, m", "grade, %"} | ({"speed, km/h"} if drives else set())


@pytest.mark.parametrize("ground", ["flat", "hilly:2", "mountain:3"])
def test_contour_lines_lie_at_their_heights_and_are_named_rightly(ground: str) -> None:
    given = run(ground=ground)
    axes = birds_eye(given).axes[0]
    (image,), (drawn,) = axes.images, contours(axes)
    assert given.road is not None
    exact = ground_around(given.road, given.world)
    steps = np.diff(drawn.levels)
    assert steps == pytest.approx(np.full(len(steps), steps[0]))
    assert 3 <= len(drawn.levels) <= 15
    assert drawn.levels / steps[0] == pytest.approx(np.rint(drawn.levels / steps[0]))
    lines = [path.vertices for path in drawn.get_paths()]
    assert min(map(len, lines)) > 2
    x, y = np.concatenate(lines).T
    apart = np.abs(exact.height(x, y) - np.repeat(drawn.levels, [*map(len, lines)]))
    beside = np.isnan(exact.road(x, y))
    assert beside.sum() > 300
    assert np.quantile(apart[beside], 0.98) < 0.05 * steps[0]
    heights = {f"{height:g} m" for height in drawn.levels}
    labels = [text for text in axes.texts if re.fullmatch(r"-?[\d.]+ m", text.get_text())]
    assert labels
    assert {text.get_text() for text in labels} <= heights
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    x0, x1, y0, y1 = image.get_extent()
    assert x0 <= left < right <= x1
    assert y0 <= low < high <= y1


def test_on_level_land_there_is_nothing_to_draw_a_line_around() -> None:
    given = on(np.full((41, 41), 10.0), level(160.0, 10.0))
    axes = birds_eye(given).axes[0]
    assert len(axes.images) == 1
    assert not contours(axes)
    assert areas(height_profile(given).axes[0], CUT) + areas(height_profile(given).axes[0], FILL) < 1e-6


@pytest.mark.parametrize("slope", [0.1, 0.4])
def test_hills_are_lit_from_the_north_west(slope: float) -> None:
    """A roof along the diagonal; the road lies on its ridge."""
    x = np.arange(0.0, 401.0, 10.0)
    roof = 50.0 - slope * np.abs(x - x[:, None])
    road = Road(PieceCurve(120.0, 120.0, math.pi / 4, (Piece(150.0),)), GradeProfile.level(150.0, 50.0))
    (image,) = birds_eye(on(roof, road)).axes[0].images
    colours = np.asarray(image.get_array(), float)[..., :3].mean(axis=-1)
    x0, x1, y0, y1 = image.get_extent()

    def brightness(east: float, north: float) -> float:
        rows, columns = colours.shape
        return float(colours[int((north - y0) / (y1 - y0) * rows), int((east - x0) / (x1 - x0) * columns)])

    for along in (140.0, 160.0, 180.0):
        lit, dark = brightness(along - 15, along + 15), brightness(along + 15, along - 15)
        assert lit > dark + 0.2 * slope


def test_water_is_blue_and_land_is_not() -> None:
    given = run("lake left")
    (image,) = birds_eye(given).axes[0].images
    colours = np.asarray(image.get_array(), float)[..., :3]
    x0, x1, y0, y1 = image.get_extent()
    rows, columns = colours.shape[:2]
    x = x0 + (np.arange(columns) + 0.5) * (x1 - x0) / columns
    y = y0 + (np.arange(rows) + 0.5) * (y1 - y0) / rows
    assert given.road is not None
    east, north = (each.ravel() for each in np.meshgrid(x, y))
    wet = ~np.isnan(ground_around(given.road, given.world).water(east, north)).reshape(rows, columns)
    blue = np.abs(colours - to_rgba(WATER)[:3]).max(axis=-1) < 1e-6
    assert 500 < wet.sum() < 0.8 * wet.size
    assert (wet == blue).mean() > 0.99


@pytest.mark.parametrize(
    "scene", [CROSSED, "river across", "ridge through; tunnel len=60", "bridge x2 len=30"]
)
def test_bridges_and_tunnels_are_named_where_they_are(scene: str) -> None:
    given = run(scene)
    assert given.road is not None
    found = crossings(given.road, given.world)
    for picture in (birds_eye, height_profile):
        axes = picture(given).axes[0]
        marks = [text for text in axes.texts if text.get_text() in ("bridge", "tunnel")]
        assert sorted(text.get_text() for text in marks) == sorted(each.kind for each in found)
        for each in found:
            middle = (each.start + each.end) / 2
            point = given.road.at(middle)
            own = [text for text in marks if text.get_text() == each.kind]
            at = [text.xy if hasattr(text, "xy") else text.get_position() for text in own]
            goal, reach = (point[:2], RIM + 1.0) if picture is birds_eye else ((middle, point[2]), 0.5)
            assert min(math.dist(place, goal) for place in at) < reach
    lines = [line for line in birds_eye(given).axes[0].lines if line.get_zorder() == 4.6]
    assert len(lines) == 2 * len(found)
    for line in lines:
        s, t = given.road.locate(*line.get_xydata().T)
        assert np.abs(t) == pytest.approx(np.full(len(t), RIM), abs=0.05)
        nearest = min(found, key=lambda each, s=s: abs(each.start - s[0]))
        assert s[[0, -1]] == pytest.approx([nearest.start, nearest.end], abs=0.5)
        assert (line.get_linestyle() == "-") == (nearest.kind == "bridge")


@pytest.mark.parametrize(("height", "colour"), [(14.0, CUT), (6.0, FILL)])
def test_along_the_road_cut_and_fill_are_drawn_and_told(height: float, colour: str) -> None:
    """On a plane 4 m above or below a road, with slopes of 1:2: a trapezium, and cones at the ends."""
    depth, length, wide = 4.0, 160.0, 8.0
    given = on(np.full((41, 41), height), level(length, 10.0))
    axes = height_profile(given).axes[0]
    across = (2 * RIM + wide) * depth
    volume = across * length + 2 * (2 * RIM * depth * wide / 2) + math.pi * wide**2 * depth / 3
    told = axes.get_xlabel()
    numbers = [float(each.replace(",", "")) for each in re.findall(r"(?:cut|fill) ([\d,]+) m³", told)]
    assert sorted(numbers) == pytest.approx([0.0, volume], rel=0.01)
    assert (numbers[0] > 0) == (colour == CUT)
    assert areas(axes, colour) == pytest.approx(depth * length, rel=0.01)
    assert areas(axes, FILL if colour == CUT else CUT) == 0.0
    dashed = [line for line in axes.lines if line.get_linestyle() != "-" and len(line.get_xdata()) > 20]
    assert np.concatenate([line.get_ydata() for line in dashed]) == pytest.approx(height)
    assert "m³" not in " ".join(words(height_profile(given, "thesis")))


@pytest.mark.parametrize("drives", [False, True])
def test_the_strip_has_a_panel_of_sight_only_with_land(drives: bool) -> None:
    """Before the bend in a cutting one sees less far than a car needs to stop from 70 km/h."""
    given, plain = run("cutting len=100", drives=drives), run(drives=drives)
    labels = [axes.get_ylabel() for axes in strip(given).axes]
    assert [label for label in labels if label != "sight, m"] == [
        axes.get_ylabel() for axes in strip(plain).axes
    ]
    assert labels.count("sight, m") == 1
    axes = strip(given).axes[labels.index("sight, m")]
    seen, needed = (line.get_xydata() for line in axes.lines if len(line.get_xdata()) > 20)
    top = axes.get_ylim()[1]
    speed = 70 / 3.6
    if not drives:
        assert needed[:, 1] == pytest.approx(2.5 * speed + speed**2 / (2 * 3.4))
    assert needed[:, 1].max() <= 2.5 * speed + speed**2 / (2 * 3.4) + 1.0
    assert 15 < seen[:, 1].min() < 80
    assert seen[-1, 1] == top  # to the end
    assert seen[[0, -1], 0] == pytest.approx([0.0, given.length])
    assert axes.get_xlabel() == "distance along the road, m"


def test_pictures_of_networks_have_land_too() -> None:
    world = World().changed(ground="rolling:1", scene="bridge", map_size=400)
    given = named(prove(map_route(1), world=world, setup=Setup(drives=False)), "a map")
    axes = birds_eye(given).axes[0]
    assert len(axes.images) == 1
    assert contours(axes)
    assert "bridge" in words(birds_eye(given))
    assert "bridge" in words(height_profile(given))
    part = birds_eye(given, frame=Frame(100.0, 180.0, 100.0, 160.0)).axes[0]
    x0, x1, y0, y1 = part.images[0].get_extent()
    assert (x1 - x0, y1 - y0) == pytest.approx((80.0, 60.0), abs=1.0)


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    given = run(CROSSED, "hilly:2")
    folders = tmp_path / "one", tmp_path / "other"
    for folder in folders:
        folder.mkdir()
    one, other = (draw(given, folder) for folder in folders)
    assert [path.name for path in one] == [path.name for path in other]
    assert all(a.read_bytes() == b.read_bytes() for a, b in zip(one, other, strict=True))
