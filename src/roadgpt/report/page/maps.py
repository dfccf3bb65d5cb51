"""Draws small maps for a page as SVG: galleries of roads, and the place of one failure.

Charts with axes are drawn by matplotlib (``page.charts``). For a gallery of a hundred linked roads, it would
take 1.6 s and write 1.8 times the bytes, without the titles that appear when the pointer is on a road."""

from base64 import b64encode
from collections.abc import Sequence
from html import escape

import numpy as np

from roadgpt.geometry.curve import Array
from roadgpt.report.birds_eye import driven_path, mark, places_of
from roadgpt.report.canvas import HALO, INK, encoded, in_our_style, new_figure
from roadgpt.report.others import draw_others, moment_of
from roadgpt.report.overview import Thumbnail
from roadgpt.report.plan_view import GROUND, draw_road
from roadgpt.run import Run
from roadgpt.verdict import percent, severity

INCH = 90.0  # px, of pictures
NARROW = 384.0  # px; a chart that is meant to be narrower is not widened on any screen
CELL, GAP, TITLE, COLUMNS = 48.0, 8.0, 14.0, 10
POINTS = 36  # of the line of a road
STYLES = {"NOT TESTED": "8 2", "INVALID": "4 2", "ERROR": "1.5 2"}
SIDE, ACROSS, SCALE = 2.8, 52.0, 10.0  # inches and metres of a place that is shown; metres of its bar


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
    said = road.outcome.lower()
    hue = f"var(--{said.replace(' ', '-')})"
    if road.graded != road.outcome and road.share is not None:
        hue, said = f"var(--{severity(road.share).split()[0]})", percent(road.share)
    out = [
        tag("title", f"road {road.number}: {road.graded}"),
        tag("text", f"{road.number}", x=x + 1, y=top - 3.5, font_size=10, class_="soft"),
        tag(
            "rect", x=x, y=top, width=CELL, height=CELL, rx=2, fill="var(--wash)", stroke="var(--line)",
            class_="frame",
        ),
    ]  # fmt: skip
    if road.graded not in ("PASS", "VALID"):
        shown = tag("tspan", said, fill=hue)
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


@in_our_style
def close_up(run: Run, station: float, label: str) -> str:
    """Returns a picture of the road of a Run around a station, north up, with the way of the car and the
    others, as an ``svg`` element."""
    assert run.road is not None
    x, y, _ = run.road.at(station, run.world.profile_of(run.road).middle(station)).tolist()
    figure, per_inch, low, foot = new_figure(SIDE, SIDE), ACROSS / SIDE, x - ACROSS / 2, y - ACROSS / 2
    figure.set_facecolor(GROUND)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(low, low + ACROSS), ylim=(foot, foot + ACROSS))
    axes.set_axis_off()
    draw_road(axes, run.road, run.world, per_inch)
    if run.drive is not None:
        driven_path(axes, run.drive)
        draw_others(axes, run, per_inch, moment_of(run))
    for place in places_of(run):
        mark(axes, run, place)
    axes.plot([low + 2, low + 2 + SCALE], [foot + 2] * 2, color=INK, lw=1.4, zorder=12)
    axes.text(low + 2, foot + 2.8, f"{SCALE:g} m", size=9, color=INK, path_effects=HALO, zorder=12)
    return embedded_png(encoded(figure, "png"), SIDE, SIDE, label)
