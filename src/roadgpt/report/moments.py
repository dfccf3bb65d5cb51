"""Draws what happened between the tested car and another one: top views of the decisive moments, and gap,
time to collision and both speeds over time."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from roadgpt.drive.drive import RUN_IN
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
from roadgpt.report.others import draw_others, first_of, look_of, moment_of, step_at
from roadgpt.report.plan_view import GROUND, Frame, draw_road
from roadgpt.run import Run

if TYPE_CHECKING:
    from roadgpt.verdict.measures import Measures

WIDTH, VIEW, PANEL, GAP = 9.6, 2.2, 1.15, 0.14  # inches
LEFT, RIGHT, BOTTOM, NAMES = 0.9, 0.3, 0.55, 0.42  # inches
BEFORE, AFTER = 3.0, 4.0  # s, that the charts show before the first moment and after the decisive one
EARLIER = 1.2  # s, of one view before the decisive one
APART = 0.4  # s, between two views at least
AROUND, LEAST, MOST = 7.0, 24.0, 70.0  # m, around both in a view, and of its side
SAME, LONGEST = 0.05, 10.0  # m, s


def moments(run: Run) -> Figure | None:
    """Returns the figure; None of a Run in which nobody else came near."""
    if run.road is None or run.drive is None or run.drive.others is None or not run.road.has_way:
        return None
    from roadgpt.verdict.measures import measure

    measured = measure(run.world.lay(run.road), run.drive, run.world)
    if not np.isfinite(measured.distance).any():
        return None
    when, who, word = _decisive(run, measured)
    t0 = [each.end for each in run.drive.handovers if each.by == RUN_IN]
    times = _times(run, when, t0)
    header = Header.of(run, WIDTH)
    high = header.height + NAMES + VIEW + 3 * (PANEL + GAP) + BOTTOM
    figure = new_figure(WIDTH, high)
    header.write(figure)
    wide = (WIDTH - LEFT - RIGHT + GAP) / len(times) - GAP
    side = _side(run, times, who, wide / VIEW)
    for number, time in enumerate(times):
        left = LEFT + number * (wide + GAP)
        axes = add_axes(
            figure, left, high - header.height - NAMES - VIEW, WIDTH - left - wide, header.height + 0.3
        )
        _view(axes, run, time, who, side * np.array([min(wide / VIEW, 1.0), min(VIEW / wide, 1.0)]))
        said = {**dict.fromkeys(t0, "T0, "), run.drive.duration: "end, ", when: f"{word}, "}.get(time, "")
        axes.set_title(f"{said}{time:.1f} s", size=9.5, color=INK)
    span = max(times[0] - BEFORE, 0.0), min(when + AFTER, run.drive.duration)
    for number, panel in enumerate((_gaps, _collision, _speeds)):
        bottom = BOTTOM + (2 - number) * (PANEL + GAP)
        axes = add_axes(figure, LEFT, bottom, RIGHT, high - bottom - PANEL)
        axes.set(xlim=span)
        axes.grid(color=FAINT, lw=0.8)
        axes.set_axisbelow(True)
        panel(axes, run, measured, who)
        for time in times:
            axes.axvline(time, color=VERMILLION if time == when else SOFT, lw=1.0, ls=(0, (4, 3)), zorder=1)
        axes.tick_params(labelbottom=number == 2)
    axes.set_xlabel("time, s")
    return figure


def _decisive(run: Run, measured: "Measures") -> tuple[float, int, str]:
    """Returns the decisive time, with whom, and what it is: the first contact, the failure, the first near
    miss, or else when somebody was nearest first."""
    assert run.drive is not None
    assert run.drive.others is not None
    hit, near, failure = (
        first_of(run, "collision"),
        first_of(run, "near miss"),
        run.verdict and run.verdict.at_time,
    )
    distance, time = measured.distance, moment_of(run)
    names = [each.name for each in run.drive.others.actors]
    word = "contact" if hit else "failure" if failure is not None else "near miss"
    if hit is None and failure is None and near is None:
        word, time = "closest", float(measured.time[(distance.min(axis=1) < distance.min() + SAME).argmax()])
    one = hit or (near if failure is None else None)
    if one is not None and one.other is not None:
        return time, names.index(one.other), word
    return (
        time,
        int(distance[min(int(np.searchsorted(measured.time, time)), len(distance) - 1)].argmin()),
        word,
    )


def _times(run: Run, when: float, t0: list[float]) -> list[float]:
    """Returns the times of the views: T0 or the first event, before the decisive one, then, and the end."""
    assert run.drive is not None
    begun = [each.time for each in (run.verdict and run.verdict.events) or () if each.time is not None]
    asked = [when, run.drive.duration, max(when - EARLIER, 0.0), *[*t0, *begun][:1], max(when - BEFORE, 0.0)]
    found = list[float]()
    for time in asked:
        if all(abs(time - other) > APART for other in found) and (time < when or len(found) < 2):
            found.append(time)
    return sorted(found[:4])


def _places(run: Run, time: float, who: int) -> Array:
    """Returns where the tested car and the other are, (1 or 2, 2): the other only where it is near."""
    assert run.drive is not None
    assert run.drive.others is not None
    own = run.drive.middles[step_at(run, time), :2]
    other = run.drive.others.at(time)[who, :2]
    is_near = np.hypot(*(other - own)) < MOST - 2 * AROUND  # false for NaN
    return np.stack([own, other]) if is_near else own[None]


def _side(run: Run, times: list[float], who: int, shape: float) -> float:
    """Returns the longer side of all views in metres: both are in each of them where they are near."""
    most = np.max([np.ptp(_places(run, time, who), axis=0) for time in times], axis=0) + 2 * AROUND
    need = max(most[0] / min(shape, 1.0), most[1] / min(1 / shape, 1.0))
    return float(np.clip(need, LEAST, MOST))


def _view(axes: Axes, run: Run, time: float, who: int, size: Array) -> None:
    assert run.road is not None
    assert run.drive is not None
    assert run.drive.others is not None
    middle = np.mean(_places(run, time, who), axis=0)
    (x0, y0), (x1, y1) = middle - size / 2, middle + size / 2
    frame = Frame(x0, x1, y0, y1)
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xticks=[], yticks=[])
    axes.set_facecolor(GROUND)
    per_inch = frame.height / VIEW
    draw_road(axes, run.road, run.world, per_inch)
    draw_others(axes, run, per_inch, time)
    name, state = run.drive.others.actors[who].name, run.drive.others.at(time)[who]
    axes.annotate(
        name, state[:2], (0, 9), textcoords="offset points", size=8.5, color=INK, ha="center",
        path_effects=HALO, zorder=11, annotation_clip=True,
    )  # fmt: skip
    scale = 10.0 if frame.width > 30 else 5.0
    at = np.array([x0 + 0.06 * frame.width, y0 + 0.06 * frame.height])
    axes.plot([at[0], at[0] + scale], [at[1], at[1]], color=INK, lw=2, zorder=11, path_effects=HALO)
    axes.text(
        at[0], at[1] + 0.02 * frame.height, f"{scale:.0f} m", size=8, color=INK, zorder=11, path_effects=HALO
    )


def _line(axes: Axes, time: Array, values: Array, colour: str, name: str) -> None:
    axes.plot(time, np.where(np.isfinite(values), values, np.nan), color=colour, lw=1.5, label=name)


def _gaps(axes: Axes, run: Run, measured: "Measures", who: int) -> None:
    distance, gap = measured.distance[:, who], measured.gap[:, who]
    _line(axes, measured.time, distance, SOFT, "between the boxes")
    _line(axes, measured.time, gap, BLUE, "gap in the lane")
    _finish(axes, "distance, m")


def _collision(axes: Axes, run: Run, measured: "Measures", who: int) -> None:
    both = measured.conflict[:, who], measured.ttc[:, who]
    _line(axes, measured.time, np.where(both[0] < LONGEST, both[0], np.nan), SOFT, "conflict time")
    _line(axes, measured.time, np.where(both[1] < LONGEST, both[1], np.nan), ORANGE, "time to collision")
    _finish(axes, "time, s")


def _speeds(axes: Axes, run: Run, measured: "Measures", who: int) -> None:
    assert run.drive is not None
    assert run.drive.others is not None
    actor, speed = run.drive.others.actors[who], 3.6 * run.drive.others.at(measured.time)[:, who, -1]
    _line(axes, run.drive["time"], 3.6 * run.drive["speed"], INK, "tested car")
    _line(axes, measured.time, speed, look_of(actor.kind)[1], actor.name)
    _finish(axes, "speed, km/h")


def _finish(axes: Axes, name: str) -> None:
    """Sets the upward axis to what is shown, and the legend."""
    low, high = axes.get_xlim()
    lines = [np.asarray(line.get_data(), float) for line in axes.lines]
    seen = np.concatenate([[0.0, 1.0], *(y[(x >= low) & (x <= high)] for x, y in lines)])
    axes.set(ylabel=name, ylim=(1.1 * float(np.nanmin(seen)), 1.45 * float(np.nanmax(seen))))
    if len(seen) == 2 or not np.isfinite(seen[2:]).any():
        note(axes, (0.5, 0.55), "nothing to show")
    axes.legend(loc="upper right", fontsize=8.5, frameon=False, ncols=2)
