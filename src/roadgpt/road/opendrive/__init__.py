"""Roads out of ASAM OpenDRIVE files, 1.1 to 1.8, of whatever tool. Verb: ``read_opendrive``.

tree       the XML, bounded and without entities; one road of the file
stretch    lines, arcs, spirals, poly3, paramPoly3
lanes      which lane is driven, and where its inner edge runs: the centre line of our Road
line       the plan: as it is where it can be, else clothoids through poses a metre apart
heights    elevation, as it is
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.road.opendrive.heights import carried_over, elevation, jumps, plain
from roadgpt.road.opendrive.lanes import Lanes, friction, read_lanes, speed_limit
from roadgpt.road.opendrive.line import KINK, Line, exact, fitted, lies_on_the_line, walk
from roadgpt.road.opendrive.numbers import number
from roadgpt.road.opendrive.stretch import Stretch, stretches
from roadgpt.road.opendrive.tree import Choice, Node, read_tree
from roadgpt.road.opendrive.turning import turned_round
from roadgpt.road.road import Road
from roadgpt.road.world import World

__all__ = ["Imported", "read_opendrive"]

VARIES = 0.05  # m; lanes that vary by more are remarked on
WIDTHS = (2.0, 10.0)  # m, of lanes that a World may have
FRICTIONS = (0.05, 2.0)
SPEEDS = (5 / 3.6, 300 / 3.6)  # m/s
TURNS_BACK = math.pi / 2  # rad; a line that jumps round by more goes back on itself
NODES = 5.0  # m between the nodes of a spline that rounds off kinks
CLOSEST = 0.5  # m between such nodes
PLACES = 1_000  # at which the spline is held against the line


@dataclass(frozen=True)
class Imported:
    """A road of somebody else's file, and what that file says of its lanes."""

    road: Road
    id: str
    name: str
    lane_width: float
    """Metres, of the lane that is driven."""
    verge: float
    """Metres of shoulder beside it."""
    speed_limit: float | None
    """m/s; None where the file does not say."""
    friction: float | None
    remarks: tuple[str, ...]
    """Sentences about everything that had to be settled."""

    def world(self, base: World) -> World:
        """A World with these lanes; what the file does not say is as in ``base``."""
        told = {"speed_limit": self.speed_limit, "friction": self.friction}
        known = {name: value for name, value in told.items() if value is not None}
        return base.model_copy(update={"lane_width": self.lane_width, "verge": self.verge, **known})


def read_opendrive(path: Path | str, road: str | None = None) -> Imported:
    """A road of an OpenDRIVE file; its centre line is the inner edge of the lane that is driven.

    Args:
        path: the file.
        road: the road's id; None takes the longest that is not part of a junction.

    Raises:
        UsageError: the file cannot be read or is too large, there is no such road, or it has an element that
            is not known or makes no sense; the sentence says which.
    """
    try:
        choice = read_tree(Path(path), road)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    number_ = choice.road.attributes.get("id", "?")[:40]
    try:
        return _imported(choice, number_, road is None)
    except UsageError as error:
        raise UsageError(f"{path}: road {number_}: {error}") from error


def _imported(choice: Choice, id_: str, is_our_choice: bool) -> Imported:
    node, remarks = choice.road, []
    if is_our_choice and len(choice.others) > 1:
        remarks.append(f"road {id_} is taken, the longest of {len(choice.others)}; say --road ID for another")
    line = stretches(node)
    lanes = read_lanes(node, line[-1].s + line[-1].length)
    grown, said = _grown(node, line, lanes)
    remarks += said
    if lanes.side == 1:
        grown = turned_round(grown)
        remarks.append(
            "no lane is driven to the right of its line; it is taken in the direction of its left lanes"
        )
    remarks += _unused(node)
    widths, told = lanes.widths(), speed_limit(node, lanes)
    width = float(np.clip(np.median(widths), *WIDTHS))
    if np.ptp(widths) > VARIES or abs(width - float(np.median(widths))) > VARIES:
        span = f"{widths.min():.2f} to {widths.max():.2f} m"
        remarks.append(f"its lane is {span} wide, and is taken as {width:.2f} m all along")
    rubbed = friction(lanes)
    return Imported(
        grown,
        id_,
        node.attributes.get("name", "")[:80],
        round(width, 4),
        round(float(np.median(lanes.verges())), 4) + 0.0,
        None if told is None or told <= 0 else float(np.clip(told, *SPEEDS)),
        None if rubbed is None else float(np.clip(rubbed, *FRICTIONS)),
        tuple(remarks),
    )


def _grown(node: Node, line: list[Stretch], lanes: Lanes) -> tuple[Road, list[str]]:
    """The road, and what had to be settled on the way."""
    heights, length = elevation(node), line[-1].s + line[-1].length
    step = jumps(heights, length)
    remarks = [step] if step else []
    is_edge = lies_on_the_line(lanes, length)
    plan = exact(line) if is_edge else None
    if plan is not None:
        return Road(plan, plain(heights, plan.length)), remarks
    try:
        found = walk(line, None if is_edge else lanes, heights.stations)
    except UsageError as error:
        if is_edge:
            raise
        found = walk(line, None, heights.stations)
        remarks.append(f"{error}; the reference line is taken instead")
    fit = fitted(found) if np.abs(found.kinks).max() <= KINK else None
    if fit is None:
        road, sentence = _rounded(found, heights.height(found.s))
        return road, [*remarks, sentence]
    plan, stations = fit
    profile = carried_over(heights, found.s, stations)
    return Road(plan, plain(profile, plan.length)), remarks


def _rounded(found: Line, heights: Array) -> tuple[Road, str]:
    """A spline through a line that has kinks, and a sentence about how far it is from it."""
    worst = int(np.abs(found.kinks).argmax())
    degrees = math.degrees(abs(found.kinks[worst]))
    if abs(found.kinks[worst]) > TURNS_BACK:
        raise UsageError(
            f"its line turns back by {degrees:.0f} degrees at s = {found.s[worst]:.1f}; mend the file"
        )
    kept = [0]
    for i in range(1, len(found.s) - 1):
        since = found.s[i] - found.s[kept[-1]]
        is_corner = abs(found.kinks[i]) > KINK / 10
        if (since >= NODES or (is_corner and since > CLOSEST)) and found.s[-1] - found.s[i] > CLOSEST:
            kept.append(i)
    points = np.column_stack([found.poses[:, :2], heights])[[*kept, len(found.s) - 1]]
    road = Road.through(points)
    some = found.poses[:: max(1, len(found.s) // PLACES)]
    _, away = road.locate(some[:, 0], some[:, 1])
    count = int((np.abs(found.kinks) > KINK).sum())
    what = {0: "bends that are too tight are", 1: f"1 kink of {degrees:.1f} degrees is"}.get(
        count, f"{count} kinks of up to {degrees:.1f} degrees are"
    )
    return road, f"{what} rounded off by a spline, at most {np.abs(away).max():.2f} m away"


def _unused(node: Node) -> list[str]:
    """What of the road our geometry has no place for."""
    remarks = []
    banked = [each for each in node.all("lateralProfile", "superelevation") if number(each, "a", 0.0)]
    if banked or node.all("lateralProfile", "shape"):
        remarks.append("its banking is left out: roads here are level across")
    if node.attributes.get("rule") == "LHT":
        remarks.append("it is made for left-hand traffic, and is driven on the right here")
    return remarks
