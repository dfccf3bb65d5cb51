"""Draws the bird's-eye view of a road, to scale and with north at the top."""

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle

from roadgpt.check import Finding
from roadgpt.drive import Drive
from roadgpt.geometry.curve import Array
from roadgpt.network import network_of, only_road
from roadgpt.plural import plural
from roadgpt.report.canvas import (
    DARKER,
    HALO,
    INK,
    SEVERE,
    SOFT,
    VERMILLION,
    Header,
    add_axes,
    fitted,
    in_our_style,
    inches,
    inches_of,
    new_figure,
    note,
    plain,
    save,
)
from roadgpt.report.others import draw_others, first_of, key_of, moment_of, step_at
from roadgpt.report.plan_view import (
    GROUND,
    Frame,
    Labels,
    draw_ends,
    draw_road,
    is_far,
    plan_points,
    show_from_above,
)
from roadgpt.road import Road, World
from roadgpt.run import Run
from roadgpt.verdict import SEVERITIES, Incident, Severity, Verdict, percent, severity
from roadgpt.verdict.judging import far_beyond
from roadgpt.verdict.oracle import margins

KeyEntry = tuple[str, float, dict[str, Any]]
"""The meaning of a line, the width of its sample in inches, and how matplotlib draws it."""
Scale = Literal["equal", "thesis"]
"""Axes that fit the road ("equal"), or x and y from 0 to 220 m as in RoadGPT's thesis ("thesis")."""

THESIS = Frame(0.0, 220.0, 0.0, 220.0)
SIDE = 6.6  # inches, the longer side of what shows the road
LEFT, BOTTOM, BAR, KEY = 0.75, 0.62, 1.15, 0.22  # inches
MARGIN, LEAST = 16.0, 60.0  # m, around the road and across the picture
MOST_PIECES = 600  # of the path, in the picture
SHARE = 0.04  # of a long road's extent, around it
SLOWEST = 10.0  # km/h; the scale of colours reaches at least this speed

RIM = 8.0  # points, width of the rim around the path
MINOR = 6.5  # points, marker of an incident that did not cause the failure
KEY_SIZE, FOOT = 9, 0.14  # points; inches above the foot of the figure
SWATCH, DOT, GAP = 0.25, 0.06, 0.11  # inches
OUTSIDE: tuple[Severity, ...] = SEVERITIES[1:]

# plasma without its lightest end, which has too little contrast on asphalt
SPEEDS = LinearSegmentedColormap.from_list("speeds", colormaps["plasma"](np.linspace(0.0, 0.86, 64)))
BEFORE, AFTER = 50.0, 20.0  # m of road that are shown
PLACE_ROOM = 6.0  # m beside it
PLACE_LEAST = 45.0  # m across


MOST = 3  # findings; more would cover the road
LONGEST = 30  # letters of a line of a label
SIZE, STEP = 9.5, 0.18  # points; inches from line to line
WORDS = {
    "out of lane": "left its lane",
    "fell": "fell off the road",
    "rolled": "rolled over",
    "crashed": "crashed",
    "sank": "drove into water",
    "stuck": "got stuck",
    "timeout": "time ran out",
    "wrong turn": "took a wrong turn",
    "wrong way": "drove the wrong way",
    "stop line": "did not stop",
    "red light": "ran a red light",
    "failure to yield": "did not give way",
    "off road": "a wheel off the road",
    "collision": "contact",
    "near miss": "near miss",
    "blocked": "stood before a free way",
    "speeding": "too fast",
}
NEAR = 15.0  # m, from an incident to the next one of its kind; they share a label
SAME = 0.05  # s, from an incident to the control step that decided
RULES = {
    "inside_map": "leaves the map",
    "no_overlap": "overlaps itself",
    "too_tight": "too tight",
    "too_steep": "too steep",
    "below_floor": "below the ground",
    "leaves_map": "leaves the map",
    "conflicting_overlap": "roads overlap",
}


@dataclass(frozen=True)
class MarkedPlace:
    """A place on a road with a label; x, y and the station s are in metres."""

    x: float
    y: float
    s: float
    text: str  # the label; empty if the place has only a marker
    step: int | None = None
    """Index of the step of the drive at which the car was there; None if the place does not come from a
    drive."""
    colour: str = VERMILLION
    is_minor: bool = False
    """Whether the place is that of an incident that did not cause the failure; it has a smaller marker."""

    @property
    def sign(self) -> str:
        """The marker for matplotlib: a cross for a failure, an incident or a finding. A diamond marks the
        place where the largest share of the car was outside, in a drive that passed."""
        return "X" if self.colour == VERMILLION or self.is_minor else "d"

    @property
    def letters(self) -> str:
        """Colour of the label on a light background."""
        return DARKER.get(self.colour, self.colour)


def birds_eye(run: Run, scale: Scale = "equal", frame: Frame | None = None) -> Figure:
    """Returns a picture of the road of a Run from above, with the driven path and the places of failures and
    findings. It shows ``frame``, or the axes of ``scale``."""
    road, world = run.road, run.world
    assert road is not None
    centre = plan_points(road)
    is_part = frame is not None
    frame = frame or (THESIS if scale == "thesis" else _frame(run, centre))
    across = SIDE * min(1.0, frame.width / frame.height)
    right = BAR if run.drive is not None else 0.3
    header = Header.of(run, LEFT + across + right)
    per_inch = frame.width / across
    found = severities(run.drive)
    rims = {name: {"lw": RIM, "color": SEVERE[name]} for name in OUTSIDE if name in found}
    outside: list[KeyEntry] = [(f"{name} its lane", SWATCH, style) for name, style in rims.items()]
    rows = [row for row in (outside, _network_key(road, world, frame, per_inch), key_of(run)) if row]
    foot = BOTTOM + KEY * len(rows)
    figure = new_figure(header.width, foot + across * frame.height / frame.width + header.height)
    axes = add_axes(figure, LEFT, foot, right, header.height)
    header.write(figure)
    for number, row in enumerate(reversed(rows)):
        _draw_key(figure, FOOT + KEY * number, row)
    size = world.site.map_size
    show_from_above(axes, frame, 8)
    axes.set_facecolor("#d5d8dc")
    axes.add_patch(Rectangle((0, 0), size, size, fc=GROUND, ec="none", zorder=0))
    axes.add_patch(Rectangle((0, 0), size, size, fc="none", ec=SOFT, lw=1.4, ls=(0, (6, 3)), zorder=0.6))
    if world.has_ground:
        from roadgpt.report.relief import draw_land

        draw_land(axes, world.lay(road), world, frame)
    draw_road(axes, road, world, per_inch)
    draw_ends(axes, road, world)
    if run.drive is not None:
        _path(figure, axes, run)
        draw_others(axes, run, per_inch, moment_of(run))
    _mark_and_label(axes, run, frame, centre, per_inch)
    if not is_part and not all(frame.holds(x, y) for x, y in centre):
        note(axes, (0.98, 0.98), "the road goes on beyond these axes", zorder=12)
    return figure


def _mark_and_label(axes: Axes, run: Run, frame: Frame, centre: Array, per_inch: float) -> None:
    """Draws and labels the marked places, the border of the map and the ends of the road. Incidents that did
    not cause the failure come last, in smaller letters."""
    road, world = run.road, run.world
    assert road is not None
    minor, places = minor_places_of(run), places_of(run)
    clear_of = np.concatenate([centre, [(each.x, each.y) for each in minor]]) if minor else centre
    labels = Labels(axes, frame, per_inch, clear_of, world.profile_of(road).paved_reach + 1.0)
    labels.name_border(world.site.map_size)
    for place in [*minor, *places]:
        mark(axes, run, place)
    for place in places:
        labels.put((place.x, place.y), place.text, place.letters)
    ends = ((0.0, "start", -1.0), (road.length, "end", 1.0)) if road.has_way else ()
    for s, text, sign in ends:
        heading = float(road.heading(s))
        x, y, _ = road.at(s, float(world.profile_of(road).middle(s)))
        if frame.holds(x, y):
            labels.put((x, y), text, INK, sign * np.array([np.cos(heading), np.sin(heading)]))
    put = [
        labels.put((each.x, each.y), each.text, each.letters, is_minor=True) for each in minor if each.text
    ]
    if not all(put):
        said = f"no room for {plural(put.count(False), 'label')} of black crosses"
        axes.annotate(
            said, (1, 0), (0, -24), xycoords="axes fraction", textcoords="offset points",
            ha="right", va="top", size=KEY_SIZE, color=SOFT,
        )  # fmt: skip


def _frame(run: Run, centre: Array) -> Frame:
    assert run.road is not None
    shown = centre
    if run.drive is not None:
        shown = np.concatenate([centre, np.stack([run.drive["x"], run.drive["y"]], axis=-1)])
    wide = run.world.profile_of(run.road).reach
    margin = max(MARGIN, wide, SHARE * float(np.ptp(shown, axis=0).max()))
    return Frame.around(shown, margin, LEAST, run.world.site.map_size)


def _path(figure: Figure, axes: Axes, run: Run) -> None:
    assert run.drive is not None
    line = driven_path(axes, run.drive)
    shown = axes.get_position()
    inch = 1 / figure.get_figwidth()
    box = (shown.x1 + 0.18 * inch, shown.y0 + 0.1 * shown.height, 0.16 * inch, 0.8 * shown.height)
    bar = figure.colorbar(line, cax=figure.add_axes(box))
    bar.set_label("speed, km/h", size=10, color=INK)
    bar.ax.tick_params(labelsize=9, colors=SOFT, length=3)
    bar.outline.set_visible(False)


def driven_path(axes: Axes, drive: Drive) -> LineCollection:
    """Draws the path of the car's centre of gravity, coloured by speed in km/h, and returns the drawn path.
    The path has a coloured outline where the car was outside its lane."""
    track = np.stack([drive["x"], drive["y"]], axis=-1)
    speed = drive["speed"] * 3.6
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    x, y = track.T
    every = max(1, int(((x > x0) & (x < x1) & (y > y0) & (y < y1)).sum()) // MOST_PIECES)
    track = np.concatenate([track[::every], track[-1:]])
    speed = np.r_[speed[::every], speed[-1]]
    norm = Normalize(0.0, max(SLOWEST, float(speed.max())))
    axes.plot(track[:, 0], track[:, 1], color="white", lw=4.2, zorder=6, solid_capstyle="round")
    pieces = np.stack([track[:-1], track[1:]], axis=1)
    found = severities(drive, every)
    for name in (each for each in OUTSIDE if each in found):
        some = [piece for piece, where in zip(pieces, found, strict=False) if where == name]
        rim = LineCollection(some, colors=SEVERE[name], linewidths=RIM, zorder=5.5, capstyle="round")
        axes.add_collection(rim)
    line = LineCollection(list(pieces), cmap=SPEEDS, norm=norm, linewidths=2.6, zorder=7, capstyle="round")
    line.set_array((speed[:-1] + speed[1:]) / 2)
    axes.add_collection(line)
    return line


def mark(axes: Axes, run: Run, place: MarkedPlace) -> None:
    """Draws a marker at a place and, if it comes from a drive, the outline of the car; both only small or not
    at all for an incident that did not cause the failure."""
    if place.is_minor:
        axes.plot(place.x, place.y, place.sign, ms=MINOR, mfc=place.colour, mec="white", mew=0.8, zorder=9.5)
        return
    if place.step is not None and run.drive is not None:
        car = Polygon(
            run.drive.corners(place.step), closed=True, fc="none", ec=place.letters, lw=1.6, zorder=9
        )
        axes.add_patch(car)
    axes.plot(place.x, place.y, place.sign, ms=10, mfc=place.colour, mec="white", mew=1.4, zorder=10)


def severities(drive: Drive | None, every: int = 1) -> list[Severity]:
    """Returns how far outside its lane the car was at most in each ``every`` steps that the verdict
    checks."""
    if drive is None or not drive.lane_steps:
        return []
    shares = np.where(drive.counts, drive["outside"], 0.0)[: drive.lane_steps]
    return [severity(share) for share in np.maximum.reduceat(shares, np.arange(0, len(shares), every))]


def _network_key(road: Road, world: World, frame: Frame, per_inch: float) -> list[KeyEntry]:
    if only_road(road, world) is not None:
        return []
    from roadgpt.report.plan_view import FAR_ROUTE, SIGN_NAMES, TINT, sign_style, signs_shown

    colour = FAR_ROUTE if is_far(road, world, per_inch) else TINT
    lane = [("lane of the route", SWATCH, {"lw": RIM, "color": colour})]
    shown = signs_shown(network_of(road, world), per_inch)
    found = {sign.control for sign in shown if frame.holds(*sign.place[:2])}
    signs = [
        (SIGN_NAMES[control], DOT, {**sign_style(control), "markevery": [0]})
        for control in SIGN_NAMES
        if control in found
    ]
    return lane + signs if road.has_way else signs


def _draw_key(figure: Figure, above: float, entries: list[KeyEntry]) -> None:
    wide, high = figure.get_size_inches()
    left, y = LEFT, above / high
    for text, width, style in entries:
        figure.add_artist(Line2D((left / wide, (left + width) / wide), (y, y), **style))
        figure.text((left + width + GAP) / wide, y, text, size=KEY_SIZE, color=SOFT, va="center")
        left += width + 3 * GAP + inches(text, KEY_SIZE)


@in_our_style
def draw_place(run: Run, station: float, said: str, path: Path) -> Path:
    """Writes a picture of a Run's road around a station, with a description in its header."""
    assert run.road is not None
    s = run.road.sample(1.0)
    near = (s.s >= station - BEFORE) & (s.s <= station + AFTER)
    margin = PLACE_ROOM + run.world.profile_of(run.road).paved_reach
    frame = Frame.around(s.points[near][:, :2], margin, PLACE_LEAST, run.world.site.map_size)
    return save(birds_eye(replace(run, description=said), frame=frame), path)


def places_of(run: Run) -> list[MarkedPlace]:
    """Returns the places to mark, except those of incidents that did not cause the failure: where the drive
    failed; where the largest share of the car was outside its lane, if it passed; or of up to three
    findings."""
    verdict = run.verdict
    if verdict is not None and verdict.cause is not None and verdict.at_xy is not None:
        side = f"\nto the {verdict.side}" if verdict.side else ""
        s = verdict.at_s or 0.0
        station = "" if verdict.incidents is None else f", {s:.0f} m"
        hit = first_of(run, "collision") if verdict.cause == "collision" else None
        whom = f" with {hit.other}" if hit and hit.other else ""
        text = f"{WORDS.get(verdict.cause, verdict.cause)}{whom}{side}{station}"
        return [MarkedPlace(*verdict.at_xy, s, text, _step(run, verdict.at_time))]
    if verdict is not None and verdict.kept and verdict.max_oob and run.drive is not None:
        return [_farthest(run, run.drive, verdict)]
    places = []
    for finding in run.findings:
        where = _where(run, finding.s, finding.x, finding.y)
        if where is not None:
            places.append(MarkedPlace(*where, _said(finding)))
    return places[:MOST]


def minor_places_of(run: Run) -> list[MarkedPlace]:
    """Returns the places of all incidents on a route, without the cause of the failure. Incidents of one kind
    that follow each other within 15 m share one label, with their number and stations, at the first."""
    verdict = run.verdict
    incidents = () if verdict is None else verdict.incidents or ()
    groups: list[list[Incident]] = []
    latest: dict[str, list[Incident]] = {}
    for each in incidents:
        since = math.inf if verdict is None or verdict.at_time is None else verdict.at_time - each.at_time
        if verdict is not None and each.kind == verdict.cause and 0 <= since < SAME:
            continue
        group = latest.get(f"{each.kind}{each.other}")
        if group is None or math.dist(group[-1].at_xy, each.at_xy) > NEAR:
            group = latest[f"{each.kind}{each.other}"] = []
            groups.append(group)
        group.append(each)
    places = []
    for group in groups:
        texts = [_named(group), *[""] * (len(group) - 1)]
        places += [
            MarkedPlace(*each.at_xy, each.at_s, text, _step(run, each.at_time), INK, is_minor=True)
            for each, text in zip(group, texts, strict=True)
        ]
    return places


def _named(group: Sequence[Incident]) -> str:
    first, last = (f"{limit(each.at_s for each in group):.0f}" for limit in (min, max))
    where = f"{first} m" if first == last else f"{first} to {last} m"
    often = f"\n{len(group)} times" if len(group) > 1 else ""
    other = f" with {group[0].other}" if group[0].other else ""
    return f"{WORDS[group[0].kind]}{other}{often}, {where}"


def _farthest(run: Run, drive: Drive, verdict: Verdict) -> MarkedPlace:
    step = int(np.where(drive.counts, drive["outside"], 0.0).argmax())
    said = f"{percent(verdict.max_oob)} of the car outside,\n{far_beyond(verdict.beyond)}"
    if run.world.limits.lane_departure:  # which is judged by the front tyres
        assert run.road is not None
        margin = np.where(drive.counts, margins(run.road, drive, run.world), np.inf)
        step, said = int(margin.argmin()), f"{margin.min():.2f} m sideways\nfrom failing"
    x, y, s = (float(drive[name][step]) for name in ("x", "y", "s"))
    return MarkedPlace(x, y, s, said, step, SEVERE[verdict.severity])


def _said(finding: Finding) -> str:
    if finding.rule == "promises":
        return textwrap.fill(plain(finding.sentence), LONGEST)
    return RULES.get(finding.rule, finding.rule.replace("_", " "))


def name_places(axes: Axes, places: Sequence[MarkedPlace], length: float, at_top: bool = False) -> None:
    """Labels places on axes whose x is the distance along a road of ``length`` metres, each farther from the
    bottom of the axes than the one before; with ``at_top``, farther from the top."""
    wide, high = inches_of(axes)
    for number, place in enumerate(places):
        is_late = place.s > length / 2
        share = place.s / length
        text = fitted(place.text, wide * max(share, 1 - share) - 0.2, SIZE)
        away = (0.07 + STEP * number + (0.17 if at_top else 0)) / high
        axes.annotate(
            text, (place.s, 1 - away if at_top else away), (-5 if is_late else 5, 0),
            xycoords=axes.get_xaxis_transform(), textcoords="offset points", size=SIZE, color=place.letters,
            ha="right" if is_late else "left", va="top" if at_top else "bottom", path_effects=HALO, zorder=8,
            annotation_clip=True,
        )  # fmt: skip


def _step(run: Run, time: float | None) -> int | None:
    return None if run.drive is None or time is None else step_at(run, time)


def _where(run: Run, s: float | None, x: float | None, y: float | None) -> tuple[float, float, float] | None:
    if run.road is None or (s is None and x is None):
        return None
    if s is None:
        s = float(run.road.locate(x or 0.0, y or 0.0)[0])
    if x is None or y is None:
        x, y = (float(v) for v in run.road.at(s)[:2])
    return x, y, s
