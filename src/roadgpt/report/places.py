"""Finds the places of a Run to mark in pictures: those of failures and findings and, for a drive that passed,
the place where the largest share of the car was outside its lane.
"""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from roadgpt.check import Finding
from roadgpt.drive import Drive
from roadgpt.report.canvas import DARKER, HALO, SEVERE, VERMILLION
from roadgpt.report.text_width import fitted, plain
from roadgpt.run import Run
from roadgpt.verdict import Verdict, percent
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
}
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
    text: str
    step: int | None = None
    """Index of the step of the drive at which the car was there; None if the place does not come from a
    drive.
    """
    colour: str = VERMILLION

    @property
    def sign(self) -> str:
        """The marker for matplotlib: a cross for a failure or finding, a diamond for a drive that passed."""
        return "X" if self.colour == VERMILLION else "d"

    @property
    def letters(self) -> str:
        """Colour of the label on a light background."""
        return DARKER.get(self.colour, self.colour)


def places_of(run: Run) -> list[MarkedPlace]:
    """Returns the places to mark.

    For a failed drive, this is the place of the failure. For a drive that passed, it is the place where the
    largest share of the car was outside its lane; if the car stayed inside, there is no such place. For an
    invalid road, these are the places of the findings, at most three.
    """
    verdict = run.verdict
    if verdict is not None and verdict.cause is not None and verdict.at_xy is not None:
        side = f"\nto the {verdict.side}" if verdict.side else ""
        text = f"{WORDS.get(verdict.cause, verdict.cause)}{side}"
        return [MarkedPlace(*verdict.at_xy, verdict.at_s or 0.0, text, _step(run))]
    if verdict is not None and verdict.kept and verdict.max_oob and run.drive is not None:
        return [_farthest(run.drive, verdict)]
    places = []
    for finding in run.findings:
        where = _where(run, finding.s, finding.x, finding.y)
        if where is not None:
            places.append(MarkedPlace(*where, _said(finding)))
    return places[:MOST]


def _farthest(drive: Drive, verdict: Verdict) -> MarkedPlace:
    """Returns the place where the largest share of the car was outside its lane."""
    step = int(drive["outside"][: drive.lane_steps].argmax())
    x, y, s = (float(drive[name][step]) for name in ("x", "y", "s"))
    beyond = "" if verdict.beyond is None else f",\n{far_beyond(verdict.beyond)}"
    return MarkedPlace(x, y, s, f"{percent(verdict.max_oob)} outside{beyond}", step, SEVERE[verdict.severity])


def _said(finding: Finding) -> str:
    """Returns the rule in a few words; for an unmet requirement the sentence of the finding."""
    if finding.rule == "promises":
        return textwrap.fill(plain(finding.sentence), LONGEST)
    return RULES.get(finding.rule, finding.rule.replace("_", " "))


def name_places(axes: Axes, places: Sequence[MarkedPlace], length: float, at_top: bool = False) -> None:
    """Labels places on axes whose x is the distance along the road, each label next to the station of its
    place.

    Args:
        axes: the axes.
        places: the places of a road; each next label is written farther from the border of the axes.
        length: the length of the road in metres.
        at_top: whether to write the labels at the top of the axes instead of the bottom.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    shape = axes.get_position()
    wide, high = figure.get_size_inches() * (shape.width, shape.height)
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


def _step(run: Run) -> int | None:
    """Returns the index of the step of the drive at which it failed."""
    assert run.verdict is not None
    if run.drive is None or run.verdict.at_time is None:
        return None
    return int(np.abs(run.drive["time"] - run.verdict.at_time).argmin())


def _where(run: Run, s: float | None, x: float | None, y: float | None) -> tuple[float, float, float] | None:
    if run.road is None or (s is None and x is None):
        return None
    if s is None:
        s = float(run.road.locate(x or 0.0, y or 0.0)[0])
    if x is None or y is None:
        x, y = (float(v) for v in run.road.at(s)[:2])
    return x, y, s
