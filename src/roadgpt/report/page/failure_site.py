"""Draws the place of one failure from above: road, lane, driven path, and the car at the failure."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from roadgpt.drive import Drive
from roadgpt.geometry.curve import Array
from roadgpt.network import Route
from roadgpt.network.arrows import arrows
from roadgpt.network.markings import strokes
from roadgpt.report.page.svg import chart, number, tag, words
from roadgpt.road import Road, World

SIDE = 240.0  # px
ACROSS = 52.0  # m that are shown
BEHIND = 8.0  # m by which the middle of the picture lies before the failure, to show what led to it
REACH = 60.0  # m of road that are drawn, before and after
SCALE = 10.0  # m, of the bar


@dataclass(frozen=True, eq=False)
class FailureSite:
    """The lines of the picture that shows where a car failed, each as points of shape ``(n, 2)`` in
    metres.
    """

    left: Array
    """Points of the left edge of the road."""
    lines: tuple[tuple[Array, bool], ...]
    """Markings between the lanes: the points of each, and whether it is a broken line."""
    right: Array
    path: Array
    """Path of the car's centre of gravity up to the failure; empty if there is no drive."""
    car: Array | None
    """Four corners of the car at the failure; None if there is no drive."""
    at: Array
    """Position ``(2,)`` of the middle of the driven lane at the station of the failure."""
    heading: float
    """Heading, in radians, of the road shortly before the place of the failure; this direction points up in
    the picture."""
    rings: tuple[Array, ...] = ()
    """The outlines of the paved area of a network, and of the holes in this area; empty for a road without
    junctions. For a network, ``left`` and ``right`` are empty instead."""
    arrows: tuple[Array, ...] = ()
    """The outlines of the arrows that are painted before the junctions of a network."""


def site_of(road: Road, world: World, drive: Drive | None, station: float) -> FailureSite:
    """Returns the lines to draw for a failure that occurred ``station`` metres along a road."""
    path, car = np.empty((0, 2)), None
    if drive is not None:
        reached = np.flatnonzero(drive["s"] >= station)
        last = int(reached[0]) if len(reached) else len(drive) - 1
        near = np.flatnonzero(drive["s"][:last] >= station - REACH)[::5]
        path = np.stack([drive["x"], drive["y"]], axis=1)[[*near, last]]
        car = drive.corners(last)
    heading = float(road.heading(max(0.0, station - 2 * BEHIND)))
    profile = world.profile_of(road)
    at = road.at(station, profile.middle(station))[:2]
    if isinstance(road, Route):
        none = np.empty((0, 2))
        rings, lines = _network_around(road, at)
        painted = _near([arrow.points[:, :2] for arrow in arrows(road.network)], at)
        return FailureSite(none, lines, none, path, car, at, heading, rings, painted)
    s = np.arange(max(0.0, station - REACH), min(road.length, station + REACH) + 0.5)
    (_, left), *inner, (_, right) = [(mark, road.at(s, t)[:, :2]) for mark, t in profile.boundaries(s)]
    lines = tuple((line, mark == "broken") for mark, line in inner if mark != "none")
    return FailureSite(left, lines, right, path, car, at, heading)


def _network_around(route: Route, at: Array) -> tuple[tuple[Array, ...], tuple[tuple[Array, bool], ...]]:
    """Returns the outlines of the paved area around a place, and the lines that are painted there."""
    import shapely

    box = shapely.box(*(at - ACROSS), *(at + ACROSS))
    parts = shapely.get_parts(shapely.intersection(route.network.paved, box))
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    lines = _near([stroke.points[:, :2] for stroke in strokes(route.network)], at)
    outlines = tuple(np.asarray(ring.coords, float)[:, :2] for ring in rings)
    return outlines, tuple((line, False) for line in lines)


def _near(lines: Sequence[Array], at: Array) -> tuple[Array, ...]:
    """Returns the lines ``(n, 2)`` that come near a place."""
    return tuple(line for line in lines if np.abs(line - at).max(axis=1).min() < ACROSS)


def draw_site(of: FailureSite, label: str) -> str:
    """Returns the picture as SVG, rotated so that the road leads upwards to the failure; ``label`` is for
    screen readers.
    """
    turned = np.pi / 2 - of.heading
    turn = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
    size = SIDE / ACROSS

    def placed(points: Array) -> Array:
        there = (points - of.at) @ turn.T * size
        return np.asarray([SIDE / 2, SIDE / 2 - BEHIND * size] + there * [1, -1])

    left, right = placed(of.left), placed(of.right)
    road = _points(np.concatenate([left, right[::-1]]))
    out = [
        tag("rect", width=SIDE, height=SIDE, fill="var(--wash)"),
        _surface([placed(ring) for ring in of.rings])
        if of.rings
        else tag("polygon", points=road, fill="var(--road)"),
        *(_line(edge, "var(--edge)", 1.4) for edge in (left, right) if len(edge)),
        *(
            _line(placed(each), "var(--edge)", 1.2, **({"stroke_dasharray": "9 7"} if is_broken else {}))
            for each, is_broken in of.lines
        ),
        *(tag("polygon", points=_points(placed(each)), fill="var(--edge)") for each in of.arrows),
    ]
    if len(of.path):
        out.append(_line(placed(of.path), "var(--s0)", 2.4))
    if of.car is not None:
        car = _points(placed(of.car))
        out.append(tag("polygon", points=car, fill="var(--fail)", fill_opacity=0.85, stroke="var(--paper)"))
    bar, below = SCALE * size, SIDE - 12.0
    out += [
        tag(
            "rect", x=7, y=below - 16, width=bar + 10, height=21, rx=2, fill="var(--wash)", fill_opacity=0.85
        ),
        tag("line", x1=12, y1=below, x2=12 + bar, y2=below, class_="axis"),
        words(12, below - 5, f"{SCALE:.0f} m", 10.5),
    ]
    return chart(SIDE, SIDE, "".join(out), label)


def _surface(rings: list[Array]) -> str:
    outline = "".join(f"M{_points(ring)}z" for ring in rings)
    return tag("path", d=outline, fill="var(--road)", fill_rule="evenodd")


def _points(points: Array) -> str:
    return " ".join(f"{number(x)},{number(y)}" for x, y in points.tolist())


def _line(points: Array, colour: str, width: float, **more: str) -> str:
    return tag("polyline", points=_points(points), fill="none", stroke=colour, stroke_width=width, **more)
