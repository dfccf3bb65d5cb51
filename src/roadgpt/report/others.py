"""Draws the others on the road from above: their boxes at one moment, how they came there, and a contact."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke

from roadgpt.geometry.boxes import OUTLINE, corners, turned
from roadgpt.geometry.curve import Array
from roadgpt.language.names import ActorKind
from roadgpt.language.table import ROAD_USERS, VEHICLES
from roadgpt.report.canvas import BLUE, GREEN, HALO, INK, POINTS, SOFT, VERMILLION, inches_of
from roadgpt.report.plan_view import Frame, draw_road
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
INSET = 2.1  # inches, the height of the inset
ROOM = 2.5  # m around the boxes in the inset
LEAST_MOVED = 0.3  # m/s, from which an arrow shows where somebody goes
ARROW = 0.2  # s of the way that an arrow shows


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
    if contact is not None and contact.contact is not None:
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


def draw_contact(axes: Axes, run: Run, contact: Incident) -> None:
    """Draws the tested car and the one that it touched first, enlarged, at the moment of contact, on axes
    that are wider than high, with arrows for their speeds."""
    from roadgpt.traffic.actor import HEADING, X, Y

    assert run.drive is not None
    assert run.drive.others is not None
    assert run.road is not None
    assert contact.contact is not None
    found, others = contact.contact, run.drive.others
    number = next(n for n, actor in enumerate(others.actors) if actor.name == contact.other)
    state, actor = others.at(contact.at_time)[number], others.actors[number]
    own = _corners_at(run, contact.at_time)
    boxes = (own, corners(state[:2], state[HEADING], np.array(actor.size)))
    shown = np.concatenate(boxes)
    low, high = shown.min(axis=0) - ROOM, shown.max(axis=0) + ROOM
    wide, tall = (float(each) for each in inches_of(axes))
    per_inch = max((high[0] - low[0]) / (0.6 * wide), (high[1] - low[1]) / tall)
    x, y = (low + high) / 2
    reach = np.array([wide, tall]) * per_inch / 2
    frame = Frame(x - reach[0], x + reach[0], y - reach[1], y + reach[1])
    axes.set(xlim=(frame.x0, frame.x1), ylim=(frame.y0, frame.y1), aspect="equal", xticks=[], yticks=[])
    axes.set_facecolor("#eef1ea")
    draw_road(axes, run.road, run.world, per_inch)
    before = np.arange(max(contact.at_time - TRAIL, 0.0), contact.at_time, STEP / 4)
    ways = (
        np.stack([np.interp(before, run.drive["time"], run.drive[name]) for name in ("x", "y")], axis=-1),
        others.at(before)[:, number, [X, Y]],
    )
    course = (float(run.drive["heading"][step_at(run, contact.at_time)]), float(state[HEADING]))
    speeds, lengths = (found.speed, found.other_speed), (run.drive.car.length, actor.size.length)
    names, colours = ("tested car", actor.name), (INK, look_of(actor.kind)[1])
    left = int(boxes[1].mean(axis=0)[0] < boxes[0].mean(axis=0)[0])
    both = zip(boxes, ways, course, speeds, lengths, names, colours, strict=True)
    for number, (box, way, ahead, speed, length, name, colour) in enumerate(both):
        axes.plot(way[:, 0], way[:, 1], color=colour, lw=1.6, alpha=0.35, zorder=6)
        axes.add_patch(Polygon(box, closed=True, fc=colour, ec="white", lw=1.2, zorder=8))
        middle = box.mean(axis=0)
        if abs(speed) > LEAST_MOVED:
            along = math.copysign(1.0, speed) * np.array([math.cos(ahead), math.sin(ahead)])
            edge, tip = (middle + along * (length / 2 + way) for way in (0, min(abs(speed) * ARROW, ROOM)))
            around = [withStroke(linewidth=3.6, foreground=colour)]
            style = {"arrowstyle": "-|>", "color": "white", "lw": 1.3, "shrinkA": 0, "shrinkB": 0}
            arrow = {**style, "path_effects": around}
            axes.annotate("", tip, edge, arrowprops=arrow, zorder=9, annotation_clip=True)
        is_left = number == left
        text = f"{name}\n{abs(speed) * 3.6:.0f} km/h" if abs(speed) > LEAST_MOVED else f"{name}\nstanding"
        axes.annotate(
            text, (frame.x0 if is_left else frame.x1, frame.y1), (8 if is_left else -8, -6),
            textcoords="offset points", color=colour, zorder=11, path_effects=HALO, linespacing=1.2,
            ha="left" if is_left else "right", va="top", size=9.5, weight="bold",
        )  # fmt: skip
    axes.plot(*found.xy, **STAR)


def _box(outline: Array, colour: str) -> Polygon:
    return Polygon(outline, closed=True, fc=colour, ec="white", lw=0.8, zorder=8.5)


def _corners_at(run: Run, time: float) -> Array:
    """The corners of the tested car's box at a time between two steps."""
    assert run.drive is not None
    drive = run.drive
    after = int(np.clip(np.searchsorted(drive["time"], time), 1, len(drive) - 1))
    share = (time - drive["time"][after - 1]) / (drive["time"][after] - drive["time"][after - 1])
    return np.asarray((1 - share) * drive.corners(after - 1) + share * drive.corners(after))
