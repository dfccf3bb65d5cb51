"""Makes the pictures, films and 3-D views that raters see; they contain no verdict and no measurements.

The plots of all roads of a survey have the same axes, as in RoadGPT's thesis, so that roads can be compared
by size. If all roads fit, the axes are those of the thesis: x and y from 0 to 220 m in the bird's-eye view,
and 200 m along the road by 20 m of height in the height plot.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

from roadgpt.errors import UsageError
from roadgpt.report.birds_eye import THESIS
from roadgpt.report.canvas import SOFT, add_axes, in_our_style, new_figure, save
from roadgpt.report.film import Settings, film_of, split_film
from roadgpt.report.film.encoding import encoder
from roadgpt.report.height import THESIS_X, THESIS_Z, draw_heights
from roadgpt.report.pair import draw_plan
from roadgpt.report.plan_view import Frame, plan_points, stations_of
from roadgpt.report.view import page_of, scene
from roadgpt.road import Road, World
from roadgpt.run import Run
from roadgpt.run.atomic import write_whole

SIDE = 4.2  # inches of both plots, so that they can be read on a phone
LEFT, BOTTOM, RIGHT, TOP = 0.86, 0.58, 0.2, 0.16  # inches
MARGIN = 12.0  # m around the roads, where they do not fit on the thesis' axes
BEFORE_THE_END = 0.1  # s; at the end of a drive, films show its outcome, which raters should not know
WHY_NONE = (
    "there are no films, because the library for them is not installed; raters see plots and the 3-D view. "
    "To add films, install the extra 'film' and make the survey again"
)
HIDDEN = {"outcome": "", "description": "", "about": "", "words": "", "places": []}
"""Replacements for what a 3-D view shows to users but must not show to raters."""


@dataclass(frozen=True)
class Axes:
    """The limits of the axes of all plots of a survey, metres."""

    frame: Frame
    along: float
    height: float

    @classmethod
    def of(cls, roads: Sequence[Road]) -> "Axes":
        """Returns the thesis' axes if all roads fit on them; otherwise, axes on which all roads fit."""
        lines = [road.at(stations_of(road)) for road in roads]
        points = np.concatenate([plan_points(road) for road in roads])
        frame = THESIS
        if not all(frame.holds(*point) for point in points[::5]):
            low, high = points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
            x, y = (low + high) / 2
            half = float(np.max(high - low)) / 2
            frame = Frame(x - half, x + half, y - half, y + half)
        along = max(THESIS_X, *(road.length * 1.02 for road in roads))
        return cls(frame, along, max(THESIS_Z, *(float(np.ptp(line[:, 2])) * 1.05 for line in lines)))


@in_our_style
def draw_plots(road: Road, world: World, axes: Axes, folder: Path, name: str) -> tuple[str, str]:
    """Writes ``NAME-above.png`` (bird's-eye view) and ``NAME-height.png``; returns the two file names."""
    names = f"{name}-above.png", f"{name}-height.png"
    figures = [new_figure(LEFT + SIDE + RIGHT, BOTTOM + SIDE + TOP) for _ in names]
    above, beside = (add_axes(figure, LEFT, BOTTOM, RIGHT, TOP) for figure in figures)
    draw_plan(above, road, world, axes.frame, axes.frame.width / SIDE)
    s = stations_of(road)
    z = road.at(s)[:, 2] - road.at(s)[:, 2].min()
    beside.set(xlim=(0, axes.along), ylim=(0, axes.height))
    beside.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    beside.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    draw_heights(beside, s, z, "height above the lowest point, m")
    beside.plot([road.length, road.length], [0, z[-1]], color=SOFT, lw=1, ls=(0, (3, 3)), zorder=3)
    for figure, file in zip(figures, names, strict=True):
        save(figure, folder / file)
    return names


def can_film() -> bool:
    """Returns whether the library that encodes films is installed."""
    try:
        encoder()
    except UsageError:
        return False
    return True


def make_film(runs: Sequence[Run], path: Path, view: str) -> None:
    """Writes an MP4 film of one run's drive, or of two drives in a split screen. The film ends before the
    outcome is visible. ``view`` is the camera: "chase" or "bonnet" (the hood camera)."""
    longest = max(run.drive.duration for run in runs if run.drive is not None)
    settings = Settings(seconds=max(longest - BEFORE_THE_END, BEFORE_THE_END))
    if len(runs) == 1:
        film_of(runs[0], path, view, settings)
    else:
        split_film(runs[0], runs[1], path, view, settings)


def write_view(runs: Sequence[Run], titles: Sequence[str], path: Path) -> None:
    """Writes the 3-D view of one road or of two, each with its title, as an HTML page."""
    scenes = [scene(run) | {"title": title} | HIDDEN for run, title in zip(runs, titles, strict=True)]
    write_whole(path, page_of(scenes))
