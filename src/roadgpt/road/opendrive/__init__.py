"""Reads roads from ASAM OpenDRIVE files, versions 1.1 to 1.8. Main function: ``read_opendrive``.

tree     reads the XML within limits and without entities; selects one road; sorts its records by station
lanes    reads the lane sections; the inner edge of the driving lanes becomes the centre line of the Road
profile  joins the lanes of all sections, reads what they state along the road, and selects the driven lane
line     computes the plan curve: unchanged where possible, otherwise clothoids through poses 1 m apart
heights  reads the elevation, and converts it to the stations of the Road"""

import math
from collections import Counter
from collections.abc import Container, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, SplineCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import closed
from roadgpt.road.opendrive.line import (
    KINK,
    GeometryElement,
    SampledLine,
    corners,
    exact,
    fitted,
    lies_on_the_line,
    misses,
    reference_line,
    turns_back,
    walk,
)
from roadgpt.road.opendrive.profile import (
    NEAR,
    Carry,
    FileProfile,
    Lanes,
    carried_over,
    checked,
    edge_heights,
    elevation,
    friction,
    jumps,
    plain,
    read_lanes,
    read_profile,
    speed_limit,
)
from roadgpt.road.opendrive.tree import Choice, in_order, number, read_tree
from roadgpt.road.profile import LINE, Profile
from roadgpt.road.road import Road, check_length, reversed_cubics, reversed_road
from roadgpt.road.world import World

__all__ = ["ImportedRoad", "read_opendrive"]

MOST_SPANS = 3  # spans that a remark lists
MOST_STATIONS = 10_000  # pairs of corresponding stations in the file and on the Road, for interpolation
PLACES = 1_000  # stations at which the spline is compared with the line, and at which widths are sampled
UNREAD = ("color", "direction", "dynamicLaneDirection", "dynamicLaneType", "level", "roadWorks", "roughness",
          "singleSide", "weight")  # fmt: skip
USUAL = ("", "false", "standard", "white")  # values of these attributes that are not reported, like 0
PLAIN = ("none", "solid", "broken", "solid solid")  # types of road marks that are painted as they are
BROAD = 0.2  # m; a wider line is reported


@dataclass(frozen=True)
class ImportedRoad:
    """A road that was read from an OpenDRIVE file, with its lane width, speed limit and friction."""

    road: Road
    """The road. Its ``profile`` is None if the file describes a cross-section like the default one of a
    World: one lane in each direction, both of the same constant width, with shoulders of equal constant width
    and the default markings."""
    id: str
    name: str
    lane_width: float  # width of the driven lane in metres; the median if it varies
    shoulder: float  # width in metres of the shoulder on the right; the median if it varies
    speed_limit: float | None
    """Speed limit in m/s, limited to 5 to 300 km/h; None if the file gives no speed limit."""
    friction: float | None  # friction coefficient of the driven lane, up to 2; None if the file gives none
    remarks: tuple[str, ...]  # sentences about contents of the file that were changed, replaced or left out

    def world(self, base: World) -> World:
        """Returns ``base`` with the lane width, shoulder, speed limit and friction of this road. A speed
        limit or friction that the file does not state is taken from ``base``. If ``road.profile`` is not
        None, it defines the lanes and shoulders, and ``base`` keeps its lane width and shoulder."""
        return base.changed(**self.world_values)

    @property
    def world_values(self) -> dict[str, float]:
        """The fields of a World that the file states, by name."""
        told = {"speed_limit": self.speed_limit, "friction": self.friction}
        if self.road.profile is None:
            told |= {"lane_width": self.lane_width, "shoulder": self.shoulder}
        return {name: value for name, value in told.items() if value is not None}


def read_opendrive(path: Path | str, road: str | None = None) -> ImportedRoad:
    """Returns one road of an OpenDRIVE file. Its centre line is the inner edge of the driving lanes.

    Args:
        path: The file.
        road: Id of the road. None selects the longest road that has a driving lane and is not part of a
            junction. If there is no such road, None selects the longest road with a driving lane. If no road
            has a driving lane, None selects the longest road outside junctions or, if there is none, the
            longest road.

    Raises:
        UsageError: The file cannot be read or is too large, there is no such road, or an element is unknown
            or invalid; the message names the element."""
    try:
        choice = read_tree(Path(path), road)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    number_ = choice.road.get("id", "?")[:40]
    try:
        return _imported(choice, number_, road is None)
    except UsageError as error:
        raise UsageError(f"{path}: road {number_}: {error}") from error


def _imported(choice: Choice, id_: str, is_our_choice: bool) -> ImportedRoad:
    node, remarks = choice.road, []
    if is_our_choice and len(choice.others) > 1:
        which = f"the longest of {len(choice.others)} with a driving lane"
        remarks.append(f"road {id_} is taken, {which}; use --road ID for another")
    remarks += in_order(node)
    line = reference_line(node)
    lanes = read_lanes(node, line[-1].s + line[-1].length)
    own = read_profile(node, lanes)
    grown, carry, said = _grown(node, line, lanes)
    remarks += said
    if lanes.side == 1:
        grown = reversed_road(grown)
        remarks.append(
            "no lane to the right of its line is driven; the road follows the direction of its left lanes"
        )
    remarks += [*_driven_otherwise(node, lanes), *own.remarks]
    limit = speed_limit(node, own.parts(), lanes.length, remarks)
    rubbed = friction(own.parts(), remarks)
    sentence = left_out(choice, own)
    remarks += [sentence] if sentence else []
    profile = _carried(own, carry, grown.length, is_reversed=lanes.side == 1)
    s = np.linspace(0.0, grown.length, PLACES)
    width, shoulder = (round(float(np.median(each)), 4) for each in (profile.width(s), profile.shoulder(s)))
    is_usual = profile == Profile.of(1, 1, width, shoulder)
    made = grown if is_usual else grown.with_profile(profile)
    return ImportedRoad(
        Road.from_json(made.to_json()),  # so that no road is written that cannot be read
        id_,
        node.get("name", "")[:80],
        width,
        shoulder,
        limit,
        rubbed,
        tuple(dict.fromkeys(remarks)),
    )


def _carried(own: FileProfile, carry: Carry, length: float, is_reversed: bool) -> Profile:
    def width(cubics: CubicProfile) -> CubicProfile:
        moved = carry(cubics)
        return checked(closed((reversed_cubics(moved, length) if is_reversed else moved).rows, length))

    def angle(cubics: CubicProfile) -> CubicProfile:
        if not is_reversed:
            return width(cubics)
        rows = tuple((-a, -b, -c, -d) for a, b, c, d in cubics.coefficients)
        return width(replace(cubics, coefficients=rows))

    return own.carried(width, angle)


def _grown(node: Element, line: list[GeometryElement], lanes: Lanes) -> tuple[Road, Carry, list[str]]:
    heights, length = elevation(node), line[-1].s + line[-1].length
    step = jumps(heights, length)
    remarks = [step] if step else []
    is_edge = lies_on_the_line(lanes, length)
    plan = exact(line) if is_edge else None
    if plan is not None:
        return Road(plan, plain(heights, plan.length)), lambda cubics: cubics, remarks
    try:
        found = walk(line, None if is_edge else lanes)
        heights = edge_heights(heights, lanes)
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
        road, s = _rounded(found, heights.height(found.s))
        assert isinstance(road.plan, SplineCurve)
        stations, way = road.plan.stations, "drawn as a spline"
    else:
        plan, s, stations = fit
        check_length(plan.length)  # the edge of a lane may be much longer than the reference line
        road, way = Road(plan, plain(carried_over(heights, s, stations), plan.length)), "rounded off"
    missed = misses(found)
    if missed or fit is None:
        what = f"its line has {missed}; it is {way}" if missed else f"its line is too rough; it is {way}"
        remarks.append(f"{what}, at most {_away(found, road):.2f} m from the file's line")
    kept = np.unique(np.r_[0 : len(s) : len(s) // MOST_STATIONS + 1, len(s) - 1])
    return road, lambda cubics: carried_over(cubics, s[kept], stations[kept]), remarks


def _away(found: SampledLine, road: Road) -> float:
    beside = found.poses[np.abs(found.kinks) > KINK, :2]
    some = [each[:: max(1, len(each) // PLACES)] for each in (beside, found.ends, found.poses[:, :2])]
    return float(np.abs(road.locate(*np.concatenate(some).T)[1]).max())


def _rounded(found: SampledLine, heights: Array) -> tuple[Road, Array]:
    """Returns a spline through a line with very close joins, and the stations of its nodes in the file."""
    kept = corners(found)
    return Road.through(np.column_stack([found.poses[:, :2], heights])[kept]), found.s[kept]


def _driven_otherwise(node: Element, lanes: Lanes) -> list[str]:
    remarks = []
    spans = lanes.stretches()
    if spans[0][0] > NEAR or spans[-1][1] < lanes.length - NEAR or len(spans) > 1:
        where = " and ".join(f"{start:.0f} to {end:.0f}" for start, end in spans[:MOST_SPANS])
        more = " and so on" if len(spans) > MOST_SPANS else ""
        remarks.append(f"in its file cars drive only from s = {where}{more} m, here along the whole road")
    if node.get("rule") == "LHT":
        remarks.append("it is made for left-hand traffic, and is driven on the right here")
    return remarks


def left_out(choice: Choice, profile: FileProfile) -> str | None:
    """Returns a sentence that lists the contents of the file that are left out; None if none are."""
    parts = [*_parts(choice, profile)]
    return f"left out: {', '.join(parts)}" if parts else None


def _parts(choice: Choice, profile: FileProfile) -> Iterator[str]:
    road = choice.road
    kinds = _further_lanes(road, profile.used())
    if kinds:
        each = ", ".join(f"{count} {kind or 'without a type'}" for kind, count in sorted(kinds.items()))
        yield f"{_many(kinds.total(), 'further lane')} ({each})"
    for what, count in sorted(choice.passed.items()):
        yield _many(count, what)
    if road.get("junction", "-1") not in ("-1", ""):
        yield f"junction {road.attrib['junction'][:40]}"
    nodes = [*road.iter()]
    if any(node.find("width") is not None and node.find("border") is not None for node in nodes):
        yield "borders of lanes that have widths"
    for name in UNREAD:
        if any(node.get(name, "").strip("0.") not in USUAL for node in nodes):
            yield f"the attribute {name}"
    marks = [*road.iter("roadMark")]
    others = {mark.get("type", "none")[:20] for mark in marks} - {*PLAIN}
    if others:
        yield f"what road marks of type {', '.join(sorted(others))} look like"
    if any(number(mark, "width", LINE) > BROAD for mark in marks):
        yield "the width of broad road marks"
    if choice.header:
        yield " and ".join(f"<{tag}>" for tag in sorted(choice.header)) + " of the map"


def _further_lanes(road: Element, used: Container[int]) -> Counter[str]:
    sides = [road.findall(f"lanes/laneSection/{side}/lane") for side in ("left", "right")]
    lanes = [lane for side in sides for lane in side if id(lane) not in used]
    found = {(number(lane, "id"), lane.get("type", "")) for lane in lanes}
    return Counter(kind[:20] for _, kind in found if kind != "none")


def _many(count: int, what: str) -> str:
    return f"{count:,} {what}{'s' * (count != 1 and what[-1] != '>')}"
