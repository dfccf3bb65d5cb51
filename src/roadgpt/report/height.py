"""Draws the height over the distance along the road, to scale or on the axes of RoadGPT's thesis."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from roadgpt.geometry.curve import Array
from roadgpt.report.birds_eye import Scale
from roadgpt.report.canvas import FAINT, HALO, INK, Header, add_axes, inches_of, new_figure, note
from roadgpt.report.junctions import shade_junctions
from roadgpt.report.places import name_places, places_of
from roadgpt.report.plan_view import stations_of
from roadgpt.run import Run

WIDTH = 9.6  # inches
LEFT, BOTTOM, RIGHT = 0.78, 0.62, 0.3  # inches
LOWEST = 1.45  # inches, least height of the axes
THESIS_HEIGHT = 3.6  # inches
THESIS_X, THESIS_Z = 200.0, 20.0  # m
SAME_GRADE = 0.004  # slopes within this are one stretch
SHORTEST = 0.55  # inches, of a stretch that is worth a label, and between labels
LEAST = 0.005  # ratio: a grade below this counts as level
OVER_THE_FRAME = 3  # pixels by which a line on the border of the axes may reach over it
EARTH, SURFACE = "#dcd9c3", "#4b5563"


def height_profile(run: Run, scale: Scale = "equal") -> Figure:
    """Returns a picture of the height over the distance along the road, with the grades of long sections."""
    assert run.road is not None
    s = stations_of(run.road)
    z = run.road.at(s)[:, 2]
    across = WIDTH - LEFT - RIGHT
    header = Header.of(run, WIDTH)
    if scale == "thesis":
        figure, axes, z, label = _thesis(run, z, header.height)
    else:
        per_inch = run.length * 1.03 / across
        tall = max(LOWEST, np.ptp(z) / per_inch + 0.9)
        figure = new_figure(WIDTH, header.height + tall + BOTTOM)
        axes = add_axes(figure, LEFT, BOTTOM, RIGHT, header.height)
        middle = (z.min() + z.max()) / 2 + 0.1 * per_inch
        axes.set(xlim=(-0.015 * run.length, 1.015 * run.length))
        axes.set_ylim(middle - tall / 2 * per_inch, middle + tall / 2 * per_inch)
        axes.set_aspect("equal")
        axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
        label = "height, m"
    header.write(figure)
    axes.set_xlabel("distance along the road, m")
    axes.set_ylabel(label)
    axes.grid(color=FAINT, lw=0.8)
    axes.set_axisbelow(True)
    shade_junctions(axes, run.road)
    low, high = axes.get_ylim()
    axes.fill_between(s, z, low, color=EARTH, lw=0)
    # on the thesis' axes a level road lies on the frame; it is drawn over the frame to be visible
    (surface,) = axes.plot(s, z, color=SURFACE, lw=2.4, solid_capstyle="round", zorder=4)
    surface.set_clip_box(axes.bbox.padded(OVER_THE_FRAME))
    _slopes(axes, run, s, z)
    places = places_of(run)
    for place in places:
        at = float(np.interp(place.s, s, z))
        axes.plot([place.s, place.s], [low, high], color=place.colour, lw=1, ls=(0, (4, 3)), zorder=3)
        (cross,) = axes.plot(place.s, at, place.sign, ms=10, mfc=place.colour, mec="white", mew=1.2, zorder=6)
        cross.set_clip_box(axes.bbox.padded(2 * OVER_THE_FRAME))
    is_low = bool(places) and float(np.interp(places[0].s, s, z)) < (low + high) / 2
    name_places(axes, places, axes.get_xlim()[1], at_top=scale == "thesis" and is_low)
    return figure


def _thesis(run: Run, z: Array, top: float) -> tuple[Figure, Axes, Array, str]:
    """Returns figure, axes, heights and label as in RoadGPT's thesis.

    Heights of a road that does not lie between 0 and 20 m are measured from its lowest point.
    """
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


def _slopes(axes: Axes, run: Run, s: Array, z: Array) -> None:
    """Labels stretches of constant grade with their grade in percent, other stretches with the steepest."""
    assert run.road is not None
    grade = run.road.grade(s)
    left, right = axes.get_xlim()
    shortest = SHORTEST * (right - left) / (WIDTH - LEFT - RIGHT)
    low, high = axes.get_ylim()
    lift = 0.13 * (high - low) / inches_of(axes)[1]
    for middle, slope in _labelled_slopes(s, grade, shortest):
        if not left <= middle <= right - shortest / 2:
            continue
        text = "level" if abs(slope) < 5e-4 else f"{slope:+.1%}".replace("%", " %").replace("-", "−")
        axes.text(
            middle, np.interp(middle, s, z) + lift, text, ha="center", va="bottom", size=9, color=INK,
            path_effects=HALO,
        )  # fmt: skip


def _labelled_slopes(s: Array, grade: Array, shortest: float) -> list[tuple[float, float]]:
    """Returns station in metres and value of each slope that gets a label."""
    breaks = np.flatnonzero(np.abs(np.diff(grade)) > SAME_GRADE * (s[1] - s[0]) / 2)
    found = [
        ((s[a] + s[b]) / 2, float(grade[(a + b) // 2]))
        for a, b in pairwise(np.r_[0, breaks + 1, len(s) - 1])
        if s[b] - s[a] >= shortest
    ]
    way = np.where(np.abs(grade) < LEAST, 0, np.sign(grade))
    for a, b in pairwise(np.r_[0, np.flatnonzero(np.diff(way)) + 1, len(s) - 1]):
        room = min(shortest, s[b] - s[a]) / 2
        steepest = a + int(np.abs(grade[a : b + 1]).argmax())
        place = float(np.clip(s[steepest], s[a] + room, s[b] - room))
        is_alone = not any(s[a] <= middle <= s[b] or abs(place - middle) < shortest for middle, _ in found)
        if way[a] and s[b] - s[a] >= shortest / 2 and is_alone:
            found.append((place, float(grade[steepest])))
    return found
