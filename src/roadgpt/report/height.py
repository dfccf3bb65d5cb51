"""Draws what lies along the road: height, curvature and grade, and speed, with the limits of the rules."""

from itertools import pairwise
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator
from numpy.typing import NDArray

from roadgpt.brief.junctions import NAMES
from roadgpt.geometry.curve import Array
from roadgpt.report.birds_eye import STEP, Scale, name_places, places_of
from roadgpt.report.canvas import (
    BLUE,
    FAINT,
    HALO,
    INK,
    ORANGE,
    POINTS,
    SOFT,
    VERMILLION,
    Header,
    add_axes,
    inches,
    inches_of,
    new_figure,
    note,
)
from roadgpt.report.plan_view import stations_of
from roadgpt.road import Road
from roadgpt.run import Run

WIDTH = 9.6  # inches
LEFT, BOTTOM, RIGHT = 0.96, 0.62, 0.3  # inches
EXAGGERATIONS = (1, 2, 5, 10, 20, 50)
TALLEST = 1.8  # inches, from the lowest point of an exaggerated road to its highest
FLATTEST, FLATTEST_M = 0.005, 2.0  # of the length, and metres: a road with smaller heights is shown as flat
LOWEST = 1.3  # inches, least height of the axes
ABOVE, UNDER = 0.5, 0.4  # inches of the axes above the road and under it
THESIS_HEIGHT = 3.6  # inches
THESIS_X, THESIS_Z = 200.0, 20.0  # m
SAME_GRADE, LEVEL = 0.004, 0.0005  # grades within this are one stretch; a grade that is told as level
SHORTEST = 0.55  # inches, of a stretch that is worth a label, and between labels
SIZE = 9  # points
LEAST = 0.005  # ratio: a grade below this counts as level
CLEAR = 0.06  # inches between a label and the road
OVER_THE_FRAME = 3  # pixels by which a line on the border of the axes may reach over it
STRAIGHT = 5000.0  # m: a radius above this counts as straight
EARTH, SURFACE = "#dcd9c3", "#4b5563"

STRIP_LEFT, STRIP_RIGHT = 1.1, 0.8  # inches
PANEL, GAP = 1.55, 0.16  # inches
DARK_ORANGE = "#a06a00"  # for letters
LEAST_APART = 0.12  # of half a panel, between two numbers
RADII = (15, 20, 30, 60, 100, 200, 400, 1000, 2000, 5000)  # m, named on the right
SEEN, SMALL = 0.005, 0.25  # of a limit: values between these are drawn larger, and the limit is not shown
SHADE = "#e4e8ee"
NAME_SIZE, NAME_LINE = 8.5, 0.16  # points; inches from one line of names to the next
REACTION, BRAKING = 2.5, 3.4  # s; m/s^2
LINES = 3  # of names, where they stand close together


def strip(run: Run) -> Figure:
    """Returns a figure with panels for curvature, for grade and, if there is a drive, for speed."""
    assert run.road is not None
    panels = [_curvature, _grade] + ([_speed] if run.drive is not None else [])
    panels += [_sight] if run.world.has_ground and run.road.has_way else []
    header = Header.of(run, WIDTH)
    high = header.height + BOTTOM + len(panels) * PANEL + (len(panels) - 1) * GAP
    figure = new_figure(WIDTH, high)
    header.write(figure)
    s = stations_of(run.road)
    for number, panel in enumerate(panels):
        top = header.height + number * (PANEL + GAP)
        axes = add_axes(figure, STRIP_LEFT, high - top - PANEL, STRIP_RIGHT, top)
        axes.set_xlim(0, run.length)
        axes.grid(color=FAINT, lw=0.8)
        axes.set_axisbelow(True)
        panel(axes, run, s)
        shade_junctions(axes, run.road, "foot" if panel is _grade else None)
        axes.yaxis.set_label_coords(-0.84 / (WIDTH - STRIP_LEFT - STRIP_RIGHT), 0.5)
        for place in places_of(run):
            axes.axvline(place.s, color=place.colour, lw=1.2, ls=(0, (4, 3)), zorder=4)
        if panel is panels[-1]:
            axes.set_xlabel("distance along the road, m")
        else:
            axes.tick_params(labelbottom=False)
    name_places(figure.axes[0], places_of(run), run.length)
    return figure


def is_plain(road: Road) -> bool:
    """Returns whether a road is straight and its grade the same everywhere, so that there is nothing to see
    along it."""
    s = stations_of(road)
    return float(np.abs(road.curvature(s)).max()) < 1 / STRAIGHT and float(np.ptp(road.grade(s))) < LEAST


def _curvature(axes: Axes, run: Run, s: Array) -> None:
    assert run.road is not None
    bend, limit = run.road.curvature(s), 1 / run.world.limits.min_radius
    reach = _fill(axes, s, bend, limit)
    ends = [end for each in run.road.passages for end in (each.start, each.end)]
    # ways through junctions have a limit of their own
    _limits(axes, limit, f"limit: radius {run.world.limits.min_radius:.1f} m", [0.0, *ends, run.length])
    axes.set_ylabel("curvature, 1/m")
    _name_sides(axes, "left", "right")
    other = axes.twinx()
    other.set_ylim(-reach, reach)
    ticks = [sign / radius for sign in (1, -1) for radius in _labelled_radii(reach)]
    other.set_yticks(ticks, [f"{abs(1 / tick):.0f}" for tick in ticks])
    other.set_ylabel("radius, m", size=10, color=INK)
    other.tick_params(labelsize=8, colors=SOFT, length=3)
    for side in other.spines.values():
        side.set_visible(False)


def _fill(axes: Axes, s: Array, values: Array, limit: float) -> float:
    """Draws signed values so that their limit is visible, if they come near it; returns the axis' largest
    value."""
    largest = float(np.abs(values).max())
    is_small = SEEN * limit < largest < SMALL * limit
    reach = 1.6 * largest if is_small else max(1.35 * limit, 1.1 * largest)
    axes.set_ylim(-reach, reach)
    axes.fill_between(s, values, 0, where=values >= 0, color=BLUE, alpha=0.35, lw=0)
    axes.fill_between(s, values, 0, where=values <= 0, color=ORANGE, alpha=0.45, lw=0)
    axes.plot(s, values, color=INK, lw=1.4)
    axes.axhline(0, color=SOFT, lw=0.8)
    return reach


def _labelled_radii(reach: float) -> list[float]:
    found: list[float] = []
    for radius in RADII:
        below = 1 / found[-1] if found else reach
        if min(below - 1 / radius, 1 / radius) > LEAST_APART * reach:
            found.append(radius)
    return found


def _grade(axes: Axes, run: Run, s: Array) -> None:
    assert run.road is not None
    grade, limit = run.road.grade(s) * 100, run.world.limits.max_grade * 100
    _fill(axes, s, grade, limit)
    _limits(axes, limit, f"limit: {limit:.0f} %", [0.0, run.length])
    axes.set_ylabel("grade, %")
    _name_sides(axes, "up", "down")


def _speed(axes: Axes, run: Run, s: Array) -> None:
    assert run.drive is not None
    speed, limit = run.drive["speed"] * 3.6, run.world.limits.speed_limit * 3.6
    axes.set_ylim(0, 1.3 * max(limit, float(speed.max())))
    axes.plot(run.drive["s"], speed, color=INK, lw=1.4)
    axes.axhline(limit, color=VERMILLION, lw=1.1, ls=(0, (1, 1.5)))
    _name_limit(axes, limit, f"limit: {limit:.0f} km/h")
    axes.set_ylabel("speed, km/h")


def _sight(axes: Axes, run: Run, s: Array) -> None:
    """How far the driver sees along the road, and how far a car goes until it stands (AASHTO Green Book,
    3.2.2: after 2.5 s, at 3.4 m/s^2), from the speed of the drive, or else the speed limit."""
    from roadgpt.network.sight import sight_along

    assert run.road is not None
    stations, sight = sight_along(run.road, run.world)
    speed = np.full_like(stations, run.world.limits.speed_limit)
    if run.drive is not None:
        order = np.argsort(run.drive["s"], kind="stable")
        speed = np.interp(stations, run.drive["s"][order], run.drive["speed"][order])
    need = speed * REACTION + speed**2 / (2 * BRAKING)
    top = 1.3 * max(float(need.max()), float(np.max(sight, where=np.isfinite(sight), initial=60.0)))
    axes.set_ylim(0, top)
    axes.plot(stations, np.minimum(sight, top), color=INK, lw=1.4)
    axes.plot(stations, need, color=VERMILLION, lw=1.1, ls=(0, (1, 1.5)))
    axes.fill_between(stations, sight, need, where=sight < need, color=ORANGE, alpha=0.45, lw=0)
    axes.set_ylabel("sight, m")
    note(axes, (0.995, 0.95), "dotted: stopping distance; line at the top: seen to the end")


def _name_sides(axes: Axes, above: str, below: str) -> None:
    for y, text, colour in ((0.75, above, BLUE), (0.25, below, DARK_ORANGE)):
        axes.annotate(
            text, (0, y), (-0.6 * POINTS, 0), xycoords="axes fraction", textcoords="offset points",
            size=9, weight="bold", color=colour, ha="center", va="center", rotation=90,
        )  # fmt: skip


def _limits(axes: Axes, limit: float, text: str, ends: list[float]) -> None:
    """Draws both signs of a limit, from each station with an even index in ``ends`` to the next; one outside
    the axes is only named."""
    if limit > axes.get_ylim()[1]:
        note(axes, (0.995, 0.96), f"{text}, beyond this axis", 8.5)
        return
    for side in (-limit, limit):
        axes.hlines([side] * (len(ends) // 2), ends[::2], ends[1::2], VERMILLION, (0, (1, 1.5)), lw=1.1)
    _name_limit(axes, limit, text)


def _name_limit(axes: Axes, limit: float, text: str) -> None:
    axes.annotate(
        text, (1, limit), (-5, 3), xycoords=axes.get_yaxis_transform(), textcoords="offset points",
        ha="right", va="bottom", size=8.5, color=VERMILLION, path_effects=HALO,
    )  # fmt: skip


def shade_junctions(axes: Axes, road: Road, names: Literal["top", "foot"] | None = "top") -> None:
    """Shades the stretches inside junctions. On the axes, x is the distance along the road; the limits of x
    must be set already. ``names`` is where the names of the junctions are written; None writes none."""
    wide, high = inches_of(axes)
    low, top = axes.get_xlim()
    per_inch = (top - low) / wide
    ends = [low] * LINES
    for passage in road.passages:
        axes.axvspan(passage.start, passage.end, fc=SHADE, ec="none", zorder=0.4)
        if names is None:
            continue
        name = NAMES[passage.entered.kind][0]
        half = (inches(name, NAME_SIZE) / 2 + 0.05) * per_inch
        middle = min(max((passage.start + passage.end) / 2, low + half), top - half)
        row = next((n for n, end in enumerate(ends) if middle - half >= end), 0)
        ends[row] = middle + half
        away = (0.05 + NAME_LINE * row) / high
        axes.text(
            middle, 1 - away if names == "top" else away, name,
            transform=axes.get_xaxis_transform(), size=NAME_SIZE, color=SOFT, ha="center",
            va="top" if names == "top" else "bottom", path_effects=HALO, zorder=7,
        )  # fmt: skip


def height_profile(run: Run, scale: Scale = "equal") -> Figure:
    """Returns a picture of the height over the distance along the road, with grades, crests and sags.

    The height is exaggerated where it would be hard to see to scale; the axis says how many times."""
    assert run.road is not None
    s = stations_of(run.road)
    z = run.road.at(s)[:, 2]
    header = Header.of(run, WIDTH)
    places, junctions = places_of(run), run.road.passages
    if scale == "thesis":
        figure, axes, z, label = _thesis(run, z, header.height)
    else:
        per_inch = run.length * 1.03 / (WIDTH - LEFT - RIGHT)
        times = exaggeration(float(np.ptp(z)), run.length, per_inch)
        foot, head = UNDER + STEP * len(places), ABOVE + (NAME_LINE * LINES if junctions else 0)
        spare = max(0.0, LOWEST - float(np.ptp(z)) * times / per_inch - foot - head) / 2
        foot, head = foot + spare, head + spare
        tall = np.ptp(z) * times / per_inch + foot + head
        figure = new_figure(WIDTH, header.height + tall + BOTTOM)
        axes = add_axes(figure, LEFT, BOTTOM, RIGHT, header.height)
        axes.set(xlim=(-0.015 * run.length, 1.015 * run.length))
        axes.set_ylim(z.min() - foot * per_inch / times, z.max() + head * per_inch / times)
        axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
        label = "height, m"
    header.write(figure)
    shade_junctions(axes, run.road)
    draw_heights(axes, s, z, label)
    if run.world.has_ground and scale != "thesis":
        from roadgpt.report.relief import draw_land_along

        draw_land_along(axes, run.world.lay(run.road), run.world, s, z)
    low, high = axes.get_ylim()
    for place in places:
        at = float(np.interp(place.s, s, z))
        axes.plot([place.s, place.s], [low, high], color=place.colour, lw=1, ls=(0, (4, 3)), zorder=3)
        (cross,) = axes.plot(place.s, at, place.sign, ms=10, mfc=place.colour, mec="white", mew=1.2, zorder=6)
        cross.set_clip_box(axes.bbox.padded(2 * OVER_THE_FRAME))
    is_low = bool(places) and float(np.interp(places[0].s, s, z)) < (low + high) / 2
    name_places(axes, places, axes.get_xlim()[1], at_top=scale == "thesis" and is_low)
    label_heights(axes, s, z, run.road.grade(s))
    return figure


def exaggeration(span: float, length: float, per_inch: float, tallest: float = TALLEST) -> int:
    """Returns how many times heights that span ``span`` metres are exaggerated in a picture with ``per_inch``
    metres of road per inch, so that they are ``tallest`` inches high at most. Heights of less than 0.5 % of
    the length, or of 2 m, are drawn as if they were as much."""
    shown = max(span, FLATTEST * length, FLATTEST_M)
    return max(each for each in EXAGGERATIONS if each == 1 or each * shown / per_inch <= tallest)


def draw_heights(axes: Axes, s: Array, z: Array, label: str = "height, m") -> None:
    """Draws heights ``z`` over stations ``s``, each ``(n,)``, on axes whose limits are set."""
    wide, high = inches_of(axes)
    times = float(np.ptp(axes.get_xlim()) / wide / (np.ptp(axes.get_ylim()) / high))
    axes.set_ylabel(label if abs(times - 1) < 0.05 else f"{label}\n(exaggerated {float(f'{times:.2g}'):g} x)")
    axes.set_xlabel("distance along the road, m")
    axes.grid(color=FAINT, lw=0.8)
    axes.set_axisbelow(True)
    axes.fill_between(s, z, axes.get_ylim()[0], color=EARTH, lw=0)
    # a level road may lie on the frame; it is drawn over the frame to be visible
    (surface,) = axes.plot(s, z, color=SURFACE, lw=2.4, solid_capstyle="round", zorder=4)
    surface.set_clip_box(axes.bbox.padded(OVER_THE_FRAME))


def _thesis(run: Run, z: Array, top: float) -> tuple[Figure, Axes, Array, str]:
    """Heights of a road that does not lie between 0 and 20 m are measured from its lowest point."""
    figure = new_figure(WIDTH, top + THESIS_HEIGHT + BOTTOM)
    axes = add_axes(figure, LEFT, BOTTOM, RIGHT, top)
    label = "height, m"
    if z.min() < 0 or z.max() > THESIS_Z:
        z, label = z - z.min(), "height above the lowest point, m"
    axes.set(xlim=(0, THESIS_X), ylim=(0, THESIS_Z))
    axes.xaxis.set_major_locator(MultipleLocator(25))
    axes.yaxis.set_major_locator(MultipleLocator(5))
    if run.length > THESIS_X:
        note(axes, (0.995, 0.97), f"goes on to {run.length:.0f} m →")
    return figure, axes, z, label


def label_heights(axes: Axes, s: Array, z: Array, grade: Array) -> None:
    """Labels crests and sags with their heights, then stretches of constant grade and the steepest place of
    each slope with the grade in percent. ``s``, ``z`` and ``grade``, each ``(n,)``, belong to the drawn line.
    A label that finds no place beside the texts and markers on the axes is left out."""
    (left, right), (wide, high) = axes.get_xlim(), inches_of(axes)
    per_inch, clear = (right - left) / wide, CLEAR * float(np.ptp(axes.get_ylim())) / high
    marks = [line for line in axes.lines if np.size(line.get_xdata()) < len(s)]
    s, z, grade = np.stack([s, z, grade])[:, s <= right]
    taken = [each.get_window_extent().padded(2) for each in (*axes.texts, *marks)]
    for text, start, end, is_under in _labels(s, z, grade, SHORTEST * per_inch):
        half = (inches(text, SIZE) / 2 + CLEAR) * per_inch
        for share in (0.5, 0.35, 0.65, 0.2, 0.8):
            middle = float(np.clip(start + share * (end - start), left + half, right - half))
            near = z[(s > middle - half) & (s < middle + half)]
            label = axes.text(
                middle, near.min() - clear if is_under else near.max() + clear, text, ha="center",
                va="top" if is_under else "bottom", size=SIZE, color=INK, path_effects=HALO, zorder=7,
            )  # fmt: skip
            box = label.get_window_extent()
            if axes.bbox.y0 < box.y0 and box.y1 < axes.bbox.y1 and not box.count_overlaps(taken):
                taken.append(box.padded(2))
                break
            label.remove()


def _labels(s: Array, z: Array, grade: Array, shortest: float) -> list[tuple[str, float, float, bool]]:
    """Returns labels, the most important first: text, the stations between which it may stand, and whether it
    stands under the road. Stretches shorter than ``shortest`` metres have none."""
    way = np.where(np.abs(grade) < LEAST, 0, np.sign(grade))
    slopes = [(a, b) for a, b in _parts(np.diff(way) != 0) if way[a] and s[b] - s[a] >= shortest / 2]
    even = _parts(np.abs(np.diff(grade)) > SAME_GRADE / shortest * np.diff(s))
    found = [(s[a], s[b], grade[(a + b) // 2]) for a, b in even if s[b] - s[a] >= shortest]
    labels = []
    for a, b in slopes:
        at = a + int(np.abs(grade[a:b]).argmax())
        if all(abs(slope - grade[at]) > SAME_GRADE or not s[a] <= start < s[b] for start, _, slope in found):
            found.append((max(s[a], s[at] - shortest), min(s[b], s[at] + shortest), grade[at]))
    for (a, b), (c, d) in pairwise(slopes):
        if way[a] != way[c] and min(s[b] - s[a], s[d] - s[c]) >= shortest:
            at = a + int((way[a] * z[a : d + 1]).argmax())
            name = "crest" if way[a] > 0 else "sag"
            labels.append((f"{name}, {z[at]:.0f} m", s[at], s[at], name == "sag"))
    for start, end, slope in sorted(found, key=lambda each: each[0] - each[1]):
        percents = f"{100 * slope:+.1f}".removesuffix(".0").replace("-", "−")
        labels.append(("level" if abs(slope) < LEVEL else f"{percents} %", start, end, False))
    return labels


def _parts(breaks: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Returns first and last index of each part of a line; ``breaks`` says after which points it breaks."""
    return list(pairwise([0, *(np.flatnonzero(breaks) + 1).tolist(), len(breaks)]))
