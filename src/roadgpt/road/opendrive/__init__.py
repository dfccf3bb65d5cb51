"""Reads roads from ASAM OpenDRIVE files, 1.1 to 1.8, of any tool. Main function: ``read_opendrive``.

tree        reads the XML with limits on its size and without entities; selects one road of the file
geometries  evaluates lines, arcs, spirals, poly3 and paramPoly3
lanes       selects the driven lane; its inner edge becomes the centre line of the Road
line        computes the plan: unchanged where possible, otherwise clothoids through poses one metre apart
joins       finds places where elements do not meet exactly, and bridges them
heights     reads the elevation without changing it
left_out    lists the contents of the file that a Road cannot represent
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.road.opendrive.geometries import GeometryElement, reference_line
from roadgpt.road.opendrive.heights import carried_over, elevation, jumps, plain
from roadgpt.road.opendrive.joins import KINK, SampledLine, misses, turns_back
from roadgpt.road.opendrive.lanes import NEAR, Lanes, friction, read_lanes, speed_limit, speed_limits
from roadgpt.road.opendrive.left_out import is_one_way, left_out
from roadgpt.road.opendrive.line import exact, fitted, lies_on_the_line, walk
from roadgpt.road.opendrive.reversal import reversed_road
from roadgpt.road.opendrive.tree import Choice, Node, read_tree
from roadgpt.road.road import Road, check_length
from roadgpt.road.world import World

__all__ = ["ImportedRoad", "read_opendrive"]

VARIES = 0.05  # m; a remark is made where the lane width varies by more
WIDTHS = (2.0, 10.0)  # m, of lanes that a World may have
SHOULDERS = (0.0, 100.0)  # m
FRICTIONS = (0.05, 2.0)
SPEEDS = (5 / 3.6, 300 / 3.6)  # m/s
NODES = 5.0  # m between the nodes of a spline that rounds off kinks
CLOSEST = 0.5  # m between such nodes
SAME_SPEED = 0.1  # m/s
MOST_SPANS = 3  # that are listed in a remark
PLACES = 1_000  # at which the spline is compared with the line


@dataclass(frozen=True)
class ImportedRoad:
    """A road that was read from an OpenDRIVE file, with the properties of its lanes in the file."""

    road: Road
    id: str
    name: str
    lane_width: float
    """Width of the driven lane in metres."""
    shoulder: float
    """Width in metres of the shoulder beside the driven lane."""
    speed_limit: float | None
    """Speed limit in m/s; None where the file gives none."""
    friction: float | None
    remarks: tuple[str, ...]
    """Sentences about contents of the file that were changed, replaced or left out."""

    def world(self, base: World) -> World:
        """Returns ``base`` with the lane width, shoulder, speed limit and friction of this road.

        A speed limit or friction that the file does not state is kept from ``base``.
        """
        told = {"speed_limit": self.speed_limit, "friction": self.friction}
        known = {name: value for name, value in told.items() if value is not None}
        return base.model_copy(update={"lane_width": self.lane_width, "verge": self.shoulder, **known})


def read_opendrive(path: Path | str, road: str | None = None) -> ImportedRoad:
    """Returns one road of an OpenDRIVE file. Its centre line is the inner edge of the driven lane.

    Args:
        path: The file.
        road: Id of the road. None selects the longest road with a driving lane that is not part of a
            junction.

    Raises:
        UsageError: The file cannot be read or is too large, there is no such road, or an element is unknown
            or invalid; the message names the element.
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


def _imported(choice: Choice, id_: str, is_our_choice: bool) -> ImportedRoad:
    node, remarks = choice.road, []
    if is_our_choice and len(choice.others) > 1:
        which = f"the longest of {len(choice.others)} with a driving lane"
        remarks.append(f"road {id_} is taken, {which}; use --road ID for another")
    line = reference_line(node)
    lanes = read_lanes(node, line[-1].s + line[-1].length)
    grown, said = _grown(node, line, lanes)
    remarks += said
    if lanes.side == 1:
        grown = reversed_road(grown)
        remarks.append(
            "no lane to the right of its line is driven; the road follows the direction of its left lanes"
        )
    remarks += _driven_otherwise(node, lanes)
    widths, limit = lanes.lane_widths(), speed_limit(node, lanes)
    width = float(np.clip(np.median(widths), *WIDTHS))
    if np.ptp(widths) > VARIES or abs(width - float(np.median(widths))) > VARIES:
        span = f"{widths.min():.2f} to {widths.max():.2f} m"
        remarks.append(f"its lane is {span} wide, and is taken as {width:.2f} m everywhere")
    limits = speed_limits(node, lanes)
    if limits and max(limits) - min(limits) > SAME_SPEED:
        span = f"{min(limits) * 3.6:.0f} to {max(limits) * 3.6:.0f} km/h"
        remarks.append(f"its speed limit is {span}, and is taken as {limits[0] * 3.6:.0f} km/h everywhere")
    sentence = left_out(choice, lanes)
    remarks += [sentence] if sentence else []
    rubbed = friction(lanes)
    return ImportedRoad(
        grown,
        id_,
        node.attributes.get("name", "")[:80],
        round(width, 4),
        round(float(np.clip(np.median(lanes.shoulder_widths()), *SHOULDERS)), 4) + 0.0,
        None if limit is None or limit <= 0 else float(np.clip(limit, *SPEEDS)),
        None if rubbed is None else float(np.clip(rubbed, *FRICTIONS)),
        tuple(remarks),
    )


def _grown(node: Node, line: list[GeometryElement], lanes: Lanes) -> tuple[Road, list[str]]:
    """Returns the road, and a sentence for each thing that had to be settled."""
    heights, length = elevation(node), line[-1].s + line[-1].length
    step = jumps(heights, length)
    remarks = [step] if step else []
    is_edge = lies_on_the_line(lanes, length)
    plan = exact(line) if is_edge else None
    if plan is not None:
        return Road(plan, plain(heights, plan.length)), remarks
    try:
        found = walk(line, None if is_edge else lanes)
    except UsageError as error:
        if is_edge:
            raise
        found = walk(line, None)
        remarks.append(f"{error}; the reference line is taken instead")
    back = turns_back(found)
    if back is not None:
        turned = f"{math.degrees(back[1]):.0f} degrees at s = {back[0]:.1f}"
        raise UsageError(f"its line turns back by {turned}; correct the file")
    fit = fitted(found)
    if fit is None:
        road, way = _rounded(found, heights.height(found.s)), "drawn as a spline"
    else:
        plan, s, stations = fit
        check_length(plan.length)  # the edge of a lane may be much longer than the reference line
        road, way = Road(plan, plain(carried_over(heights, s, stations), plan.length)), "rounded off"
    missed = misses(found)
    if missed or fit is None:
        what = f"its line has {missed}; it is {way}" if missed else f"its line is too rough; it is {way}"
        remarks.append(f"{what}, at most {_away(found, road):.2f} m from the file's line")
    return road, remarks


def _away(found: SampledLine, road: Road) -> float:
    """Returns the largest distance in metres between sampled places of the file's line and the road."""
    beside = found.poses[np.abs(found.kinks) > KINK, :2]
    some = [each[:: max(1, len(each) // PLACES)] for each in (beside, found.ends, found.poses[:, :2])]
    return float(np.abs(road.locate(*np.concatenate(some).T)[1]).max())


def _rounded(found: SampledLine, heights: Array) -> Road:
    """Returns a spline through a line whose joins are too close to each other for any other method."""
    kept = [0]
    for i in range(1, len(found.s) - 1):
        since = found.s[i] - found.s[kept[-1]]
        is_corner = abs(found.kinks[i]) > KINK / 10
        if (since >= NODES or (is_corner and since > CLOSEST)) and found.s[-1] - found.s[i] > CLOSEST:
            kept.append(i)
    return Road.through(np.column_stack([found.poses[:, :2], heights])[[*kept, len(found.s) - 1]])


def _driven_otherwise(node: Node, lanes: Lanes) -> list[str]:
    """Returns a sentence for each way in which traffic in the file differs from ours."""
    remarks = []
    spans = lanes.spans()
    if spans[0][0] > NEAR or spans[-1][1] < lanes.length - NEAR or len(spans) > 1:
        where = " and ".join(f"{start:.0f} to {end:.0f}" for start, end in spans[:MOST_SPANS])
        more = " and so on" if len(spans) > MOST_SPANS else ""
        remarks.append(f"in its file cars drive only from s = {where}{more} m, here along the whole road")
    if is_one_way(node, lanes):
        remarks.append("it is one-way in its file; a second lane, for oncoming cars, is added here")
    if node.attributes.get("rule") == "LHT":
        remarks.append("it is made for left-hand traffic, and is driven on the right here")
    return remarks
