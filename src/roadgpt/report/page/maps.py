"""Draws small maps for a page as SVG: galleries of roads, and the place of one failure.

Charts with axes are drawn by matplotlib (``page.charts``). For a gallery of a hundred linked roads, it would
take 1.6 s and write 1.8 times the bytes, without the titles that appear when the pointer is on a road."""

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from roadgpt.drive import Drive
from roadgpt.geometry.curve import Array
from roadgpt.network import Network, network_of, only_road
from roadgpt.network.markings import arrows, strokes
from roadgpt.report.overview import Thumbnail
from roadgpt.report.plan_view import rings_of
from roadgpt.road import Road, World
from roadgpt.verdict import percent, severity

INCH = 90.0  # px, of pictures
NARROW = 384.0  # px; a chart that is meant to be narrower is not widened on any screen
CELL, GAP, TITLE, COLUMNS = 48.0, 8.0, 14.0, 10
POINTS = 36  # of the line of a road
STYLES = {"NOT TESTED": "8 2", "INVALID": "4 2", "ERROR": "1.5 2"}
SIDE = 240.0  # px
ACROSS = 52.0  # m that are shown
BEHIND = 8.0  # m by which the middle of the picture lies before the failure, to show what led to it
REACH = 60.0  # m of road that are drawn, before and after
SCALE = 10.0  # m, of the bar


def tag(name: str, content: str = "", /, **attributes: object) -> str:
    """Returns an element; ``_`` in an attribute's name stands for ``-``, and ``class_`` is ``class``."""
    given = ""
    for key, value in attributes.items():
        text = number(value) if isinstance(value, float) else str(value)
        given += f' {key.rstrip("_").replace("_", "-")}="{escape(text)}"'
    return f"<{name}{given}>{content}</{name}>" if content else f"<{name}{given}/>"


def number(value: float) -> str:
    """Returns a number with at most two decimals, and no trailing zeros."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def words(x: float, y: float, text: str, size: float, is_soft: bool = False) -> str:
    """Returns a text element that begins at (x, y)."""
    style = {"class_": "soft"} if is_soft else {}
    return tag("text", escape(text), x=x, y=y, font_size=size, **style)


def chart(width: float, height: float, content: str, label: str) -> str:
    """Returns an ``svg`` element of ``width`` by ``height`` px; ``label`` is for screen readers."""
    return tag(
        "svg",
        content,
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {number(width)} {number(height)}",
        width=width,
        height=height,
        class_="chart" if width >= NARROW else "chart narrow",
        role="img",
        aria_label=label,
    )


def embedded_png(png: bytes, wide: float, high: float, label: str) -> str:
    """Returns a picture of ``wide`` by ``high`` inches as an ``svg`` element that holds it."""
    width, height = INCH * wide, INCH * high
    data = f"data:image/png;base64,{b64encode(png).decode()}"
    return chart(width, height, tag("image", href=data, width=width, height=height), label)


def gallery(roads: Sequence[Thumbnail], size: float, label: str, columns: int = COLUMNS) -> str:
    """Returns maps of roads as SVG, at most ``columns`` in a row; a dot marks the start, a cross the place of
    a failure. ``size`` is the side of the map in metres, and ``label`` is for screen readers."""
    columns = min(columns, max(len(roads), 1))
    rows = -(-len(roads) // columns)
    out = []
    for place, road in enumerate(roads):
        row, column = divmod(place, columns)
        x, y = 2 + column * (CELL + GAP), row * (CELL + TITLE + GAP)
        cell = _cell(road, x, y, size)
        out.append(tag("a", cell, href=road.href) if road.href else cell)
    wide, high = 4 + columns * (CELL + GAP) - GAP, rows * (CELL + TITLE + GAP)
    return chart(wide, high, "".join(out), label)


def _cell(road: Thumbnail, x: float, y: float, size: float) -> str:
    top = y + TITLE
    mark = road.outcome.lower()
    hue = f"var(--{mark.replace(' ', '-')})"
    if road.graded != road.outcome and road.share is not None:
        hue, mark = f"var(--{severity(road.share).split()[0]})", percent(road.share)
    out = [
        tag("title", f"road {road.number}: {road.graded}"),
        words(x + 1, top - 3.5, f"{road.number}", 10, is_soft=True),
        tag(
            "rect", x=x, y=top, width=CELL, height=CELL, rx=2, fill="var(--wash)", stroke="var(--line)",
            class_="frame",
        ),
    ]  # fmt: skip
    if road.graded not in ("PASS", "VALID"):
        shown = tag("tspan", mark, fill=hue)
        text = f'<text x="{number(x + CELL - 1)}" y="{number(top - 3.5)}" font-size="9.5" text-anchor="end">'
        out.append(f"{text}{shown}</text>")
    if not len(road.points):
        return "".join(out)

    def on_map(points: Array) -> Array:
        placed = np.clip(points / size, -0.02, 1.02) * [CELL, -CELL] + [x, top + CELL]
        return np.asarray(placed)

    some = np.linspace(0, len(road.points) - 1, min(POINTS, len(road.points))).astype(int)
    line = on_map(road.points[some])
    path = " ".join(f"{number(a)},{number(b)}" for a, b in line)
    dash = {"stroke_dasharray": STYLES[road.outcome]} if road.outcome in STYLES else {}
    out.append(tag("polyline", points=path, fill="none", stroke=hue, stroke_width=2, **dash))
    out.append(tag("circle", cx=line[0, 0], cy=line[0, 1], r=2.4, fill="var(--ink)"))
    if road.failed_at is not None:
        a, b = on_map(np.asarray([road.failed_at]))[0]
        cross = f"M{number(a - 4)} {number(b - 4)}l8 8m0 -8l-8 8"
        out.append(tag("path", d=cross, stroke="var(--fail)", stroke_width=2.2, fill="none"))
    return "".join(out)


@dataclass(frozen=True, eq=False)
class FailureSite:
    """The lines of the picture that shows where a car failed, each as points of shape ``(n, 2)`` in
    metres."""

    rings: tuple[Array, ...]  # outlines of the paved area, and, the other way round, of the holes in it
    lines: tuple[tuple[Array, bool], ...]
    """Edges of the road, and markings: the points of each, and whether it is a broken line."""
    path: Array  # path of the car's centre of gravity up to the failure; empty if there is no drive
    car: Array | None  # four corners of the car at the failure; None if there is no drive
    at: Array  # position ``(2,)`` of the middle of the driven lane at the station of the failure
    heading: float
    """Heading, in radians, of the road shortly before the place of the failure; this direction points up in
    the picture."""
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
    if only_road(road, world) is None:
        network = network_of(road, world)
        painted = _near([arrow.points[:, :2] for arrow in arrows(network)], at)
        return FailureSite(*_network_around(network, at), path, car, at, heading, painted)
    s = np.arange(max(0.0, station - REACH), min(road.length, station + REACH) + 0.5)
    (_, left), *inner, (_, right) = [(mark, road.at(s, t)[:, :2]) for mark, t in profile.boundaries(s)]
    marked = [(line, mark == "broken") for mark, line in inner if mark != "none"]
    lines = ((left, False), *marked, (right, False))
    return FailureSite((np.concatenate([left, right[::-1]]),), lines, path, car, at, heading)


def _network_around(network: Network, at: Array) -> tuple[tuple[Array, ...], tuple[tuple[Array, bool], ...]]:
    import shapely

    box = shapely.box(*(at - ACROSS), *(at + ACROSS))
    outlines = rings_of(shapely.orient_polygons(shapely.intersection(network.paved, box)))
    lines = _near([stroke.points[:, :2] for stroke in strokes(network)], at)
    return tuple(outlines), tuple((line, False) for line in lines)


def _near(lines: Sequence[Array], at: Array) -> tuple[Array, ...]:
    return tuple(line for line in lines if np.abs(line - at).max(axis=1).min() < ACROSS)


def draw_site(of: FailureSite, label: str) -> str:
    """Returns the picture as SVG, rotated so that the road leads upwards to the failure."""
    turned = np.pi / 2 - of.heading
    turn = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
    size = SIDE / ACROSS

    def placed(points: Array) -> Array:
        there = (points - of.at) @ turn.T * size
        return np.asarray([SIDE / 2, SIDE / 2 - BEHIND * size] + there * [1, -1])

    outline = "".join(f"M{_points(placed(ring))}z" for ring in of.rings)
    out = [
        tag("rect", width=SIDE, height=SIDE, fill="var(--wash)"),
        tag("path", d=outline, fill="var(--road)"),
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


def _points(points: Array) -> str:
    return " ".join(f"{number(x)},{number(y)}" for x, y in points.tolist())


def _line(points: Array, colour: str, width: float, **more: str) -> str:
    return tag("polyline", points=_points(points), fill="none", stroke=colour, stroke_width=width, **more)
