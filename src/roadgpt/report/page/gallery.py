"""Draws galleries of roads: small maps in the colours of the outcomes, with links to the runs."""

from collections.abc import Sequence

import numpy as np

from roadgpt.geometry.curve import Array
from roadgpt.report.overview import Thumbnail
from roadgpt.report.page.svg import chart, number, tag, words
from roadgpt.verdict import percent, severity

CELL, GAP, TITLE, COLUMNS = 48.0, 8.0, 14.0, 10
POINTS = 36  # of the line of a road
STYLES = {"INVALID": "4 2", "ERROR": "1.5 2"}


def gallery(roads: Sequence[Thumbnail], size: float, label: str, columns: int = COLUMNS) -> str:
    """Returns maps of roads as SVG, at most ``columns`` in a row; a dot marks the start, a cross the place of
    a failure. ``size`` is the side of the map in metres, and ``label`` says what the picture shows, for
    screen readers.
    """
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
    hue, mark = f"var(--{road.outcome.lower()})", road.outcome.lower()
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
