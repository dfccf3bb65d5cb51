"""Draws two roads in one figure, with bird's-eye views and heights, as in the survey of RoadGPT's thesis."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from roadgpt.report.birds_eye import SHARE, THESIS, Scale, driven_path, mark, places_of
from roadgpt.report.canvas import (
    FAINT,
    HALO,
    INK,
    SOFT,
    VERMILLION,
    add_axes,
    fitted,
    in_our_style,
    inches,
    inches_of,
    new_figure,
    note,
)
from roadgpt.report.height import THESIS_X, THESIS_Z, draw_heights, exaggeration, label_heights
from roadgpt.report.plan_view import (
    GROUND,
    Frame,
    Labels,
    draw_ends,
    draw_road,
    plan_points,
    show_from_above,
    stations_of,
)
from roadgpt.road import Road, World
from roadgpt.run import Run
from roadgpt.verdict.oracle import margins

WIDTH, LEFT, RIGHT, BOTTOM, TOP, BETWEEN = 10.6, 0.7, 0.25, 0.62, 0.62, 1.1  # inches
SIDE = 3.3  # inches, of the square that shows a road from above
ROW = SIDE + BOTTOM + TOP
SIZE = (WIDTH, 2 * ROW)  # inches
MARGIN, LEAST = 14.0, 60.0  # m, around the roads and across the square
CORNER = (0.985, 0.97)  # of axes, where it is written that a road goes on
ROOM = 1.0  # inches of the axes above and under the heights


@in_our_style
def pair(one: Run, other: Run, scale: Scale = "equal", drivers: tuple[str, str] | None = None) -> Figure:
    """Returns a figure that shows two roads, one above the other, on the same scales: axes that fit both
    ("equal"), or the fixed axes of RoadGPT's thesis. If ``drivers`` names two drivers, the figure shows how
    they drove, and how far outside its lane the car was instead of the heights."""
    figure = new_figure(*SIZE)
    runs = [(run, run.road) for run in (one, other) if run.road is not None]
    plans = [plan_points(road) for _, road in runs]
    half = max(LEAST, *((1 + 2 * SHARE) * float(np.ptp(plan, axis=0).max()) for plan in plans)) / 2 + MARGIN
    spans = [float(np.ptp(road.at(stations_of(road))[:, 2])) for _, road in runs]
    shown = max(one.length, other.length), max(spans)
    for number, ((run, road), plan) in enumerate(zip(runs, plans, strict=True)):
        foot = (1 - number) * ROW + BOTTOM
        x, y = (plan.min(axis=0) + plan.max(axis=0)) / 2
        frame = THESIS if scale == "thesis" else Frame(x - half, x + half, y - half, y + half)
        over = SIZE[1] - foot - SIDE
        above = add_axes(figure, LEFT, foot, WIDTH - LEFT - SIDE, over)
        draw_plan(above, road, run.world, frame, frame.width / SIDE)
        if not all(frame.holds(x, y) for x, y in plan):
            note(above, CORNER, "goes on beyond these axes", 9, zorder=13)
        beside = add_axes(figure, LEFT + SIDE + BETWEEN, foot, RIGHT, over)
        seed = f"seed {run.request.seed}, road {run.index}, " if run.words else ""
        if drivers is None:
            name, said = f"Road {number + 1}", run.outcome.lower()
            _beside(beside, road, shown, scale)
        else:
            name, said = f"{drivers[number]}: {run.outcome}", run.description
            _outside(above, beside, run, shown[0])
        at = (foot + SIDE + 0.32) / SIZE[1]
        figure.text(LEFT / WIDTH, at, name, size=11, weight="bold", color=INK, parse_math=False)
        after = LEFT + 0.15 + inches(name, 11, bold=True)
        title = fitted(run.title, WIDTH - RIGHT - after, 11)
        figure.text(after / WIDTH, at, title, size=11, color=INK, parse_math=False)
        said = fitted(f"{seed}{run.length:.0f} m, {said}", WIDTH - LEFT - RIGHT, 8.5)
        figure.text(LEFT / WIDTH, at - 0.2 / SIZE[1], said, size=8.5, color=SOFT, parse_math=False)
    return figure


def _outside(above: Axes, beside: Axes, run: Run, long: float) -> None:
    assert run.road is not None
    assert run.drive is not None
    driven_path(above, run.drive).set(array=None, color=INK)
    for place in places_of(run):
        mark(above, run, place)
    s, far, most = run.drive["s"], 100 * run.drive["outside"], 100 * run.world.limits.oob_tolerance
    told, what, high = f"FAIL above {most:g} %", "share of the car outside its lane, %", (0.0, 105.0)
    if run.world.limits.lane_departure:  # a tyre over the marking decides as well
        far, most = -margins(run.road, run.drive, run.world), 0.0
        told, what = "FAIL above 0 m", "distance beyond where it fails, m"
        high = (min(-1.0, float(far.min())), max(0.5, 1.1 * float(far.max())))
    beside.fill_between(s, far, high[0], color=VERMILLION, alpha=0.3, lw=0)
    beside.plot(s, far, color=VERMILLION, lw=1.8)
    beside.axhline(most, color=INK, lw=1.2, ls=(0, (4, 3)))
    beside.annotate(told, (long, most), (-4, -4), textcoords="offset points", size=9,
                    color=INK, ha="right", va="top", path_effects=HALO)  # fmt: skip
    beside.set(xlim=(0, long), ylim=high, xlabel="distance along the road, m")
    beside.set_ylabel(what)
    beside.grid(color=FAINT, lw=0.8)


def draw_plan(axes: Axes, road: Road, world: World, frame: Frame, per_inch: float) -> None:
    """Draws a road from above, its ends named, on axes that show ``frame``, ``per_inch`` metres per inch."""
    show_from_above(axes, frame, 7)
    axes.set_facecolor(GROUND)
    draw_road(axes, road, world, per_inch)
    draw_ends(axes, road, world)
    labels = Labels(axes, frame, per_inch, plan_points(road), world.profile_of(road).paved_reach + 1.0)
    for s, text, sign in ((0.0, "start", -1.0), (road.length, "end", 1.0)):
        heading, (x, y, _) = float(road.heading(s)), road.at(s)
        labels.put((x, y), text, INK, sign * np.array([np.cos(heading), np.sin(heading)]))


def _beside(axes: Axes, road: Road, shown: tuple[float, float], scale: Scale) -> None:
    s, (long, span) = stations_of(road), shown
    z = road.at(s)[:, 2]
    if scale == "thesis":
        z = z - min(float(z.min()), 0.0)
        axes.set(xlim=(0, THESIS_X), ylim=(0, THESIS_Z))
    else:
        per_inch = long / inches_of(axes)[0]
        high = SIDE * per_inch / exaggeration(span, long, per_inch, SIDE - ROOM)
        middle = (z.min() + z.max()) / 2
        axes.set(xlim=(0, long), ylim=(middle - high / 2, middle + high / 2))
        axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    draw_heights(axes, s, z)
    label_heights(axes, s, z, road.grade(s))
    if scale == "thesis" and (road.length > THESIS_X or z.max() > THESIS_Z):
        note(axes, CORNER, f"goes on to {road.length:.0f} m, {z.max():.0f} m high", 9, zorder=13)
