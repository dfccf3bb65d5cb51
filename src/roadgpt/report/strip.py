"""Draws curvature, grade and, if there is a drive, speed over the distance, with the limits of the rules."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from roadgpt.drive.outlook import passages
from roadgpt.geometry.curve import Array
from roadgpt.report.canvas import (
    BLUE,
    FAINT,
    HALO,
    INK,
    ORANGE,
    SOFT,
    VERMILLION,
    Header,
    add_axes,
    new_figure,
    note,
)
from roadgpt.report.junctions import shade_junctions
from roadgpt.report.places import name_places, places_of
from roadgpt.report.plan_view import stations_of
from roadgpt.report.text_width import POINTS
from roadgpt.run import Run

WIDTH = 9.6  # inches
LEFT, RIGHT, BOTTOM = 1.1, 0.8, 0.62  # inches
PANEL, GAP = 1.55, 0.16  # inches
DARK_ORANGE = "#a06a00"  # for letters
LEAST_APART = 0.12  # of half a panel, between two numbers
RADII = (15, 20, 30, 60, 100, 200, 400, 1000, 2000, 5000)  # m, named on the right
SEEN, SMALL = 0.005, 0.25  # of a limit: values between these are drawn larger, and the limit is not shown


def strip(run: Run) -> Figure:
    """Returns a figure with panels for curvature, for grade and, if there is a drive, for speed."""
    assert run.road is not None
    panels = [_curvature, _grade] + ([_speed] if run.drive is not None else [])
    header = Header.of(run, WIDTH)
    high = header.height + BOTTOM + len(panels) * PANEL + (len(panels) - 1) * GAP
    figure = new_figure(WIDTH, high)
    header.write(figure)
    s = stations_of(run.road)
    for number, panel in enumerate(panels):
        top = header.height + number * (PANEL + GAP)
        axes = add_axes(figure, LEFT, high - top - PANEL, RIGHT, top)
        axes.set_xlim(0, run.length)
        axes.grid(color=FAINT, lw=0.8)
        axes.set_axisbelow(True)
        panel(axes, run, s)
        shade_junctions(axes, run.road, "foot" if panel is _grade else None)
        axes.yaxis.set_label_coords(-0.84 / (WIDTH - LEFT - RIGHT), 0.5)
        for place in places_of(run):
            axes.axvline(place.s, color=place.colour, lw=1.2, ls=(0, (4, 3)), zorder=4)
        if panel is panels[-1]:
            axes.set_xlabel("distance along the road, m")
        else:
            axes.tick_params(labelbottom=False)
    name_places(figure.axes[0], places_of(run), run.length)
    return figure


def _curvature(axes: Axes, run: Run, s: Array) -> None:
    assert run.road is not None
    bend, limit = run.road.curvature(s), 1 / run.world.limits.min_radius
    reach = _fill(axes, s, bend, limit)
    ends = [end for each in passages(run.road) for end in (each.start, each.end)]
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
    """Draws signed values so that their limit is visible, if they come near it; returns the largest value on
    the axis.
    """
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
    """Returns the radii whose labels do not overlap each other or zero, the tightest first."""
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


def _name_sides(axes: Axes, above: str, below: str) -> None:
    """Writes beside the numbers what lies above and below the zero line."""
    for y, text, colour in ((0.75, above, BLUE), (0.25, below, DARK_ORANGE)):
        axes.annotate(
            text, (0, y), (-0.6 * POINTS, 0), xycoords="axes fraction", textcoords="offset points",
            size=9, weight="bold", color=colour, ha="center", va="center", rotation=90,
        )  # fmt: skip


def _limits(axes: Axes, limit: float, text: str, ends: list[float]) -> None:
    """Draws both signs of a limit, from each station with an even index in ``ends`` to the next one. A limit
    that lies outside the axes is only named.
    """
    if limit > axes.get_ylim()[1]:
        note(axes, (0.995, 0.96), f"{text}, beyond this axis", 8.5)
        return
    for side in (-limit, limit):
        axes.hlines([side] * (len(ends) // 2), ends[::2], ends[1::2], VERMILLION, (0, (1, 1.5)), lw=1.1)
    _name_limit(axes, limit, text)


def _name_limit(axes: Axes, limit: float, text: str) -> None:
    """Writes the name of a limit above its line, at the right end."""
    axes.annotate(
        text, (1, limit), (-5, 3), xycoords=axes.get_yaxis_transform(), textcoords="offset points",
        ha="right", va="bottom", size=8.5, color=VERMILLION, path_effects=HALO,
    )  # fmt: skip
