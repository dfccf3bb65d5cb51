"""Curvature, grade and, of a driven road, speed over the distance, with the limits of the rules."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from roadgpt.report.canvas import (
    BLUE,
    FAINT,
    HALO,
    HEADER,
    INK,
    ORANGE,
    SOFT,
    VERMILLION,
    add_axes,
    header,
    new_figure,
)  # fmt: skip
from roadgpt.report.places import places_of
from roadgpt.report.scenery import Array, stations_of
from roadgpt.run import Run

WIDTH = 9.6  # inches
LEFT, RIGHT, BOTTOM = 0.85, 0.8, 0.62  # inches
PANEL, GAP = 1.55, 0.16  # inches
RADII = (15, 20, 30, 60)  # m, named on the right


def strip(run: Run) -> Figure:
    """Panels one above the other over the same distance."""
    assert run.road is not None
    panels = [_curvature, _grade] + ([_speed] if run.drive is not None else [])
    high = HEADER + BOTTOM + len(panels) * PANEL + (len(panels) - 1) * GAP
    figure = new_figure(WIDTH, high)
    header(figure, run)
    s = stations_of(run.road)
    for number, panel in enumerate(panels):
        top = HEADER + number * (PANEL + GAP)
        axes = add_axes(figure, LEFT, high - top - PANEL, RIGHT, top)
        axes.set_xlim(0, run.length)
        axes.grid(color=FAINT, lw=0.8)
        axes.set_axisbelow(True)
        panel(axes, run, s)
        for place in places_of(run):
            axes.axvline(place.s, color=VERMILLION, lw=1.2, ls=(0, (4, 3)), zorder=4)
        if panel is panels[-1]:
            axes.set_xlabel("distance along the road, m")
        else:
            axes.tick_params(labelbottom=False)
    _name_places(figure, run)
    return figure


def _curvature(axes: Axes, run: Run, s: Array) -> None:
    assert run.road is not None
    bend, limit = run.road.curvature(s), 1 / run.world.min_radius
    reach = max(1.25 * limit, 1.1 * float(np.abs(bend).max()))
    axes.set_ylim(-reach, reach)
    axes.fill_between(s, bend, 0, where=bend >= 0, color=BLUE, alpha=0.35, lw=0)
    axes.fill_between(s, bend, 0, where=bend <= 0, color=ORANGE, alpha=0.45, lw=0)
    axes.plot(s, bend, color=INK, lw=1.4)
    axes.axhline(0, color=SOFT, lw=0.8)
    _limits(axes, limit, f"limit: radius {run.world.min_radius:.1f} m")
    axes.set_ylabel("curvature, 1/m")
    style: dict[str, Any] = {
        "size": 9,
        "weight": "bold",
        "transform": axes.transAxes,
        "va": "center",
        "path_effects": HALO,
    }
    axes.text(0.008, 0.62, "left", color=BLUE, **style)
    axes.text(0.008, 0.38, "right", color="#a06a00", **style)
    other = axes.twinx()
    other.set_ylim(-reach, reach)
    ticks = [sign / radius for sign in (1, -1) for radius in RADII]
    other.set_yticks(ticks, [f"{abs(1 / tick):.0f}" for tick in ticks])
    other.set_ylabel("radius, m", size=10, color=INK)
    other.tick_params(labelsize=8, colors=SOFT, length=3)
    for side in other.spines.values():
        side.set_visible(False)


def _grade(axes: Axes, run: Run, s: Array) -> None:
    assert run.road is not None
    grade, limit = run.road.grade(s) * 100, run.world.max_grade * 100
    reach = max(1.25 * limit, 1.1 * float(np.abs(grade).max()))
    axes.set_ylim(-reach, reach)
    axes.fill_between(s, grade, 0, where=grade >= 0, color=BLUE, alpha=0.35, lw=0)
    axes.fill_between(s, grade, 0, where=grade <= 0, color=ORANGE, alpha=0.45, lw=0)
    axes.plot(s, grade, color=INK, lw=1.4)
    axes.axhline(0, color=SOFT, lw=0.8)
    _limits(axes, limit, f"limit: {limit:.0f} %")
    axes.set_ylabel("grade, %")
    style: dict[str, Any] = {
        "size": 9,
        "weight": "bold",
        "transform": axes.transAxes,
        "va": "center",
        "path_effects": HALO,
    }
    axes.text(0.008, 0.62, "up", color=BLUE, **style)
    axes.text(0.008, 0.38, "down", color="#a06a00", **style)


def _speed(axes: Axes, run: Run, s: Array) -> None:
    assert run.drive is not None
    speed, limit = run.drive["speed"] * 3.6, run.world.speed_limit * 3.6
    axes.set_ylim(0, 1.2 * max(limit, float(speed.max())))
    axes.plot(run.drive["s"], speed, color=INK, lw=1.4)
    axes.axhline(limit, color=VERMILLION, lw=1.1, ls=(0, (1, 1.5)))
    _name_limit(axes, limit, f"limit: {limit:.0f} km/h")
    axes.set_ylabel("speed, km/h")


def _limits(axes: Axes, limit: float, text: str) -> None:
    for side in (-limit, limit):
        axes.axhline(side, color=VERMILLION, lw=1.1, ls=(0, (1, 1.5)))
    _name_limit(axes, limit, text)


def _name_limit(axes: Axes, limit: float, text: str) -> None:
    axes.text(
        0.992, limit, text, transform=axes.get_yaxis_transform(), ha="right", va="center", size=8.5,
        color=VERMILLION, bbox={"fc": "white", "ec": "none", "pad": 1.2},
    )  # fmt: skip


def _name_places(figure: Figure, run: Run) -> None:
    """Say at the uppermost panel what the vertical lines mean."""
    axes = figure.axes[0]
    for place in places_of(run):
        is_late = place.s > run.length / 2
        axes.annotate(
            place.text.replace("\n", " "), (place.s, 0.05), (-5 if is_late else 5, 0),
            xycoords=axes.get_xaxis_transform(), textcoords="offset points", size=9.5, color=VERMILLION,
            ha="right" if is_late else "left", va="bottom", path_effects=HALO, zorder=8,
        )  # fmt: skip
