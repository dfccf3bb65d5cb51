"""Draws the others on the road from above: their boxes at one moment, and how they came there."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon

from roadgpt.geometry.boxes import OUTLINE, corners, turned
from roadgpt.geometry.curve import Array
from roadgpt.language.names import ActorKind
from roadgpt.language.table import ROAD_USERS, VEHICLES
from roadgpt.report.canvas import BLUE, GREEN, INK, POINTS, SOFT, VERMILLION
from roadgpt.run import Run
from roadgpt.verdict import Incident
from roadgpt.verdict.verdict import IncidentKind

if TYPE_CHECKING:
    from roadgpt.traffic import Tracks

NAVY, BROWN, PINK = "#1f3763", "#7a4b16", "#c2408f"
COLOURS = {
    "car, van": BLUE, "truck, bus": NAVY, "two wheels": GREEN, "person": PINK, "animal": BROWN, "thing": SOFT,
}  # fmt: skip
"""The colours by what the key of a picture calls those that look alike."""
BOX = 2 * OUTLINE
TURN = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
SHAPES: dict[str, tuple[str, Any]] = {
    "two wheels": ("d", ((1, 0), (0, 1), (-1, 0), (0, -1))),
    "person": ("o", np.column_stack([np.cos(TURN), np.sin(TURN)])),
    "animal": ("^", ((1, 0), (-1, 1), (-1, -1))),
}
"""Markers in the key and outlines of what is not drawn as a box, in halves of its length and width."""
SLOWS, AROUND = 0.5, 0.2  # m/s^2, from which brake lights are on; s before and after, compared for it
PRESSED = 0.05  # of the tested car's brake pedal
RED = "#ff2a1f"
STAR: dict[str, Any] = {"marker": (8, 1), "ms": 11, "mfc": VERMILLION, "mec": "white", "zorder": 10.5}
TRAIL, STEP = 5.0, 0.2  # s of the way before the moment, and between its points
SMALLEST = 4.5  # points, of the longer side of a box


def look_of(kind: ActorKind) -> tuple[str, str]:
    """Returns what the key calls a kind, and its colour."""
    key = ROAD_USERS[kind].key
    return key, COLOURS[key]


def moment_of(run: Run) -> float:
    """Returns the time in seconds at which the others are shown: of the first contact, else of the
    failure, of the first near miss, or the end of the drive."""
    assert run.drive is not None
    hit, near = first_of(run, "collision"), first_of(run, "near miss")
    times = (each.at_time for each in (hit, run.verdict, near) if each is not None)
    return next((time for time in times if time is not None), run.drive.duration)


def first_of(run: Run, kind: IncidentKind) -> Incident | None:
    """Returns the first incident of a kind, such as a collision, if there was one."""
    incidents = (run.verdict and run.verdict.incidents) or ()
    return next((each for each in incidents if each.kind == kind), None)


def step_at(run: Run, time: float) -> int:
    """Returns the step of the drive that is nearest to a time in seconds."""
    assert run.drive is not None
    return int(np.abs(run.drive["time"] - time).argmin())


def draw_others(axes: Axes, run: Run, per_inch: float, time: float) -> None:
    """Draws everybody as a box with a trail that fades, and the tested car as a box. ``per_inch`` is the
    number of metres per inch; boxes that would be too small to see are drawn larger."""
    assert run.drive is not None
    others = run.drive.others
    if others is None:
        return
    least = SMALLEST / POINTS * per_inch
    before = np.arange(max(time - TRAIL, 0.0), time + STEP / 2, STEP)
    from roadgpt.traffic.actor import HEADING, X, Y

    ways = others.at(before)[..., [X, Y]]
    for number, (way, state, actor) in enumerate(
        zip(ways.swapaxes(0, 1), others.at(time), others.actors, strict=True)
    ):
        name, colour = look_of(actor.kind)
        way = way[~np.isnan(way[:, 0])]
        if len(way) > 1 and np.ptp(way, axis=0).max() > 0.5:
            pieces = np.stack([way[:-1], way[1:]], axis=1)
            shades = [(*to_rgb(colour), alpha) for alpha in np.linspace(0.05, 0.75, len(pieces))]
            axes.add_collection(LineCollection(list(pieces), colors=shades, linewidths=2.0, zorder=7.6))
        if not np.isnan(state[X]):
            size = max(1.0, least / max(actor.size[:2])) * np.array(actor.size[:2])
            outline = np.array(SHAPES.get(name, ("s", BOX))[1]) * size / 2
            axes.add_patch(_box(turned(outline, state[HEADING]) + state[[X, Y]], colour))
            if _brakes(others, number, time):
                _lit(axes, corners(state[[X, Y]], state[HEADING], size))
    step = step_at(run, time)
    own = run.drive.corners(step)
    middle = own.mean(axis=0)
    own = middle + max(1.0, least / run.drive.car.length) * (own - middle)
    axes.add_patch(_box(own, INK))
    if run.drive["brake"][step] > PRESSED:
        _lit(axes, own)
    contact = first_of(run, "collision")
    if contact is not None and contact.contact is not None and contact.at_time <= time + STEP / 2:
        axes.plot(*contact.contact.xy, **STAR)


def _brakes(others: "Tracks", number: int, time: float) -> bool:
    """Whether a vehicle slows down at a time, or stands and once moved."""
    from roadgpt.traffic.actor import SPEED, STILL

    if others.actors[number].kind not in VEHICLES:
        return False
    speeds = np.abs(others.at(time + np.array([-AROUND, 0.0, AROUND]))[:, number, SPEED])
    stands = speeds[1] < STILL and np.nanmax(np.abs(others.states[:, number, SPEED])) > STILL
    return bool(stands or speeds[0] - speeds[2] > SLOWS * 2 * AROUND)


def _lit(axes: Axes, box: Array) -> None:
    """Draws brake lights along the rear edge of a box, of corners as in BOX."""
    axes.plot(*box[[0, 3]].T, color=RED, lw=2.4, solid_capstyle="butt", zorder=8.7)


def key_of(run: Run) -> list[tuple[str, float, dict[str, Any]]]:
    """Returns the entries of the key: the tested car, and the kinds of others that are on the road."""
    others = run.drive.others if run.drive is not None else None
    if others is None or not others.actors:
        return []
    kinds = {actor.kind for actor in others.actors}
    named = dict(look_of(kind) for kind in ROAD_USERS if kind in kinds)
    style = {"ms": 6, "mec": "white", "mew": 0.6, "ls": "none", "markevery": [0]}
    found = [
        (name, 0.06, {**style, "mfc": colour, "marker": SHAPES.get(name, "s")[0]})
        for name, colour in {"tested car": INK, **named}.items()
    ]
    return [*found, ("brakes", 0.12, {"color": RED, "lw": 2.4})]


def _box(outline: Array, colour: str) -> Polygon:
    return Polygon(outline, closed=True, fc=colour, ec="white", lw=0.8, zorder=8.5)
