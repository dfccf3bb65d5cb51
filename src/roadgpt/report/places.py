"""Finds the places of a Run to mark in pictures: the places of failures, other incidents and findings. For a
drive that passed, also finds the place where the largest share of the car was outside its lane."""

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from roadgpt.check import Finding
from roadgpt.drive import Drive
from roadgpt.report.canvas import DARKER, HALO, INK, SEVERE, VERMILLION, fitted, inches_of, plain
from roadgpt.run import Run
from roadgpt.verdict import Incident, Verdict, percent
from roadgpt.verdict.judging import far_beyond

MOST = 3  # findings; more would cover the road
LONGEST = 30  # letters of a line of a label
SIZE, STEP = 9.5, 0.18  # points; inches from line to line
WORDS = {
    "out of lane": "left its lane",
    "fell": "fell off the road",
    "stuck": "got stuck",
    "timeout": "time ran out",
    "wrong turn": "took a wrong turn",
    "wrong way": "drove the wrong way",
    "stop line": "did not stop",
    "off road": "a wheel off the road",
}
NEAR = 15.0  # m, from an incident to the next one of its kind; they share a label
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


def places_of(run: Run) -> list[MarkedPlace]:
    """Returns the places to mark, except those of incidents that did not cause the failure: where the drive
    failed; where the largest share of the car was outside its lane, if it passed; or of up to three
    findings."""
    verdict = run.verdict
    if verdict is not None and verdict.cause is not None and verdict.at_xy is not None:
        side = f"\nto the {verdict.side}" if verdict.side else ""
        s = verdict.at_s or 0.0
        station = "" if verdict.incidents is None else f", {s:.0f} m"
        text = f"{WORDS.get(verdict.cause, verdict.cause)}{side}{station}"
        return [MarkedPlace(*verdict.at_xy, s, text, _step(run, verdict.at_time))]
    if verdict is not None and verdict.kept and verdict.max_oob and run.drive is not None:
        return [_farthest(run.drive, verdict)]
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
        if verdict is not None and (each.kind, each.at_time) == (verdict.cause, verdict.at_time):
            continue
        group = latest.get(each.kind)
        if group is None or math.dist(group[-1].at_xy, each.at_xy) > NEAR:
            group = latest[each.kind] = []
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
    return f"{WORDS[group[0].kind]}{often}, {where}"


def _farthest(drive: Drive, verdict: Verdict) -> MarkedPlace:
    step = int(drive["outside"][: drive.lane_steps].argmax())
    x, y, s = (float(drive[name][step]) for name in ("x", "y", "s"))
    beyond = far_beyond(verdict.beyond)
    return MarkedPlace(
        x, y, s, f"{percent(verdict.max_oob)} of the car outside,\n{beyond}", step, SEVERE[verdict.severity]
    )


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
    if run.drive is None or time is None:
        return None
    return int(np.abs(run.drive["time"] - time).argmin())


def _where(run: Run, s: float | None, x: float | None, y: float | None) -> tuple[float, float, float] | None:
    if run.road is None or (s is None and x is None):
        return None
    if s is None:
        s = float(run.road.locate(x or 0.0, y or 0.0)[0])
    if x is None or y is None:
        x, y = (float(v) for v in run.road.at(s)[:2])
    return x, y, s
