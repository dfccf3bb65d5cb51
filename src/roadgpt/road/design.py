"""Defines the Design of a road, a route or a map, and reads and writes it in RoadGPT's JSON format.

A single road has the format of the RoadGPT thesis:

    {"starting_point": [x, y, z], "theta": degrees,
     "road_segment1": {"distance", "direction", "incline", "turn_degrees"}, "road_segment2": ...}

``theta`` is the heading at the start, counter-clockwise from +x, as in the code of the thesis (the prompt in
the thesis states +y). ``distance`` is the length along the plan curve. A segment may also contain ``radius``,
``transition`` and ``vertical_radius``, which are not part of the format in the thesis.

A route through junctions has more fields:

    "lanes": {"forward": 2, "backward": 0, "width": 3.5, "centre": "solid", "edge": "broken"}
    "junction1": {"after": 2, "kind": "crossroads", "take": "left", "control": "yield", "kerb": 10,
                  "arms": [{"angle": -90}, {"angle": 0, "length": 40}, {"angle": 90}]}
    "junction2": {"after": 3, "kind": "merge", "take": "ramp", "length": 150,
                  "lanes": {"forward": 2, "backward": 0}}
    "junction3": {"after": 4, "kind": "lane_drop", "length": 60}

``after`` is the number of segments before the junction; merges, exits and places where lanes change are
numbered together with the junctions, in driving order. ``arms`` are the roads at the junction other than the
road of arrival; ``angle`` is the direction out of the junction on this arm, in degrees from the direction in
which the route arrives, positive to the left; an arm that is not straight and level has segments of its own,
``"road_segment1": {"distance": 40, "direction": "left", "incline": 3, "turn_degrees": 30}``. ``take`` names
the arm on which the route goes on: "left", "right", "straight", or the number of the exit, counted
counter-clockwise from the road of arrival. ``lanes`` of a junction are those of the road on which the route
goes on. With ``"left_hand": true``, traffic drives on the left: exits are counted clockwise, and ramps lie on
the left.

A map is a graph: the nodes are junctions, bends and ends of roads, and roads join the nodes.

    "lanes": {"width": 3.5},
    "node1": {"at": [20, 80, 0], "kind": "end"},
    "node2": {"at": [80, 80, 0], "kind": "t_junction", "control": "stop", "kerb": 8},
    "node3": {"at": [150, 80, 1], "kind": "bend", "radius": 20}, ...
    "roads": [[1, 2], [2, 3], ...],
    "route": [1, 2, 4]

``at`` is x, y and the height in metres. Each pair in ``roads`` is a straight between two nodes; at a bend, a
curve leads from one straight to the next, so that several straights and bends may join two junctions.
``route`` lists the nodes that the tested car passes, in driving order; it may be left out."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal, NamedTuple, Self, TypeVar

from pydantic import BaseModel, ConfigDict, Field, StrictBool, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from roadgpt.brief.junctions import LANE_KINDS, RAMPS, RINGS, side_of
from roadgpt.brief.words import MOST_LANES
from roadgpt.errors import UsageError
from roadgpt.language.names import Control, LaneKind, PlainKind, Side
from roadgpt.plural import plural
from roadgpt.road.profile import Marking
from roadgpt.road.road import FARTHEST

CREST_RADIUS = 250.0  # m, radius of a parabola where the design gives none
MOST_OF_SEGMENT = 0.9  # share of a segment that its two parabolas may take, where no radius is given
MOST_OF_SLOPE = 0.98  # share of a slope, over all its segments, that parabolas with a given radius may take
MAX_INCLINE = 15.0  # percent, RoadGPT's system prompt
MAX_TURN = 70.0  # degrees in one segment, RoadGPT's system prompt
MAX_SEGMENTS = 2000
REQUIRED = ("distance", "direction", "incline", "turn_degrees")  # fields of each segment in a file
FITS = 0.99  # a remark is made if less than this share of a given vertical radius can be built
SEGMENT_KEY = re.compile(r"road_segment(\d{1,6})")
Direction = Literal["left", "right", "straight"]
ANGLES = ("turn_degrees", "angle")  # fields that are positive to the left
OTHER_DIRECTION: dict[Direction, Direction] = {"left": "right", "right": "left", "straight": "straight"}
Finite = Annotated[float, Field(allow_inf_nan=False)]
Length = Annotated[float, Field(ge=0.001, le=100_000, allow_inf_nan=False)]


ACCELERATION = 130.0  # m, length of an acceleration or deceleration lane without its taper
RAMP_TAPER = 60.0  # m, length of the taper of such a lane: RAA 2008, entries and exits
MEDIAN = 2.0  # m, width of a median
TAPER = 60.0  # m, length of the taper of a lane that ends or begins
LEAST_WIDTH = 1.5  # m; where a lane is narrower than this, no car can drive in it

USUAL = {"ring_lanes": 1, "taper": RAMP_TAPER, "turn_lanes": (), "turn_length": 25.0}
USUAL |= {"crosswalk": False, "island": False}
"""Fields of a junction or a ramp that are written only if they differ from these values."""
RARE = {"divided": False, "edge": "solid"}
"""Fields of a LanesDesign that are written only if they differ from these values."""
After = Annotated[int, Field(ge=1, le=MAX_SEGMENTS)]
LaneLength = Annotated[float, Field(ge=10, le=2000, allow_inf_nan=False)]
STUB = 25.0  # m, length of an arm whose length is not given
JUNCTION_KEY = re.compile(r"junction(\d{1,4})")
OF_A_ROAD = "forward, backward and width"
KERB = 10.0  # m, CD 123 Geometric design of at-grade priority junctions: corner radius of rural junctions
ISLAND = 16.0  # m, usual radius of the central island
ASTERN = 25.0  # degrees, least angle between two neighbouring arms, the road of arrival among them
MOST_JUNCTIONS = 100
MOST_ARMS = 7
USUAL_ARMS: dict[PlainKind, tuple[float, ...]] = {
    "t_junction": (-90.0, 90.0),
    "y_junction": (-60.0, 60.0),
    "crossroads": (-90.0, 0.0, 90.0),
    "star": (-108.0, -36.0, 36.0, 108.0),
    "roundabout": (-90.0, 0.0, 90.0),
    "turning_circle": (),
}
"""The angles in degrees of the arms of a junction whose design gives no arms."""
COUNTS: dict[PlainKind, tuple[int, int]] = {
    "t_junction": (2, 2),
    "y_junction": (2, 2),
    "crossroads": (3, 3),
    "star": (4, MOST_ARMS),
    "roundabout": (2, 5),
    "turning_circle": (0, 0),
}
"""The smallest and the largest number of arms, without the road of arrival."""
Take = Literal["left", "right", "straight"] | Annotated[int, Field(ge=1)]
Part = TypeVar("Part", bound=BaseModel)
DIGITS = 9  # decimals to which y is rounded when mirrored about a line other than y = 0, against float noise
NODE_KEY = re.compile(r"node([1-9][0-9]{0,5})")
MOST_NODES = 400
MOST_ROADS = 800
MOST_PASSED = 1000
"""The largest number of nodes that a route through a map may pass."""
BEND = 20.0  # m, radius of a bend whose design gives none
NEAREST = 1.0  # m, least distance between two nodes that a road joins
STEEPEST_BEND = 150.0  # degrees, largest angle by which a road may turn at a bend
ROADS: dict[str, tuple[int, int]] = {
    "end": (1, 1),
    "bend": (2, 2),
    **{kind: (least + 1, most + 1) for kind, (least, most) in COUNTS.items()},
}
"""The smallest and the largest number of roads at a node of each kind."""
NodeKind = Literal[PlainKind, "bend", "end"]


class VerticalCurve(NamedTuple):
    """The parabola that joins the grades of two segments. Its middle is where the two segments meet."""

    number: int  # index of the second of the two segments, from 0
    s: float  # station in metres of the middle of the parabola
    half: float  # half of the length of the parabola in metres
    change: float  # change of grade as a ratio, positive in a dip

    @property
    def radius(self) -> float:
        """The vertical radius of the parabola in metres."""
        return 2 * self.half / abs(self.change)


def vertical_curves(
    distances: Sequence[float], grades: Sequence[float], radii: Sequence[float | None]
) -> list[VerticalCurve]:
    """Returns the vertical curves where grades change, in order. ``distances`` are the lengths of segments in
    metres, and ``grades`` their grades as ratios. ``radii`` are the radii in metres of the curves at the
    starts of the segments; None for a default radius.

    A curve whose radius is given has the length that this radius requires. It is shortened where it would
    overlap its neighbour or extend beyond the road."""
    joints: list[tuple[int, float, float]] = []
    wants: list[float] = []
    at = 0.0
    for i in range(1, len(grades)):
        at += distances[i - 1]
        change, radius = grades[i] - grades[i - 1], radii[i]
        shorter = min(distances[i - 1], distances[i])
        usual = min(CREST_RADIUS * abs(change) / 2, MOST_OF_SEGMENT * shorter / 2)
        half = usual if radius is None else radius * abs(change) / 2
        if half > 1e-6:
            joints.append((i, at, change))
            wants.append(half)
    stations = [0.0, *(s for _, s, _ in joints), at + distances[-1]]
    rooms = [MOST_OF_SLOPE * (b - a) for a, b in pairwise(stations)]
    own = [radii[i] is not None for i, _, _ in joints]
    out = []
    for n, (i, s, change) in enumerate(joints):
        half = wants[n]
        if own[n]:
            before, after = n - 1, n + 1
            half = min(half, _share(wants, own, rooms[n], n, before if n else None))
            half = min(half, _share(wants, own, rooms[n + 1], n, after if after < len(joints) else None))
        if half > 1e-6:
            out.append(VerticalCurve(i, s, half, change))
    return out


def _share(wants: Sequence[float], own: Sequence[bool], room: float, n: int, other: int | None) -> float:
    """Returns the length in metres that half of curve ``n`` may take up of the slope at one of its ends."""
    if other is None:
        return room
    if not own[other]:  # a curve without a given radius keeps its length
        return room - wants[other]
    return room * wants[n] / max(wants[n] + wants[other], 1e-9)


class FrozenFields(BaseModel):
    """Base class of values whose fields cannot be changed; unknown fields are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def mirrored(self) -> Self:
        """Returns the value with left and right exchanged: sides, and the signs of angles. The number of an
        exit stays, because the mirrored exits are counted the other way round."""
        changes = dict[str, Any]()
        for name, value in self:
            if value in ("left", "right"):
                changes[name] = OTHER_DIRECTION[value]
            elif name in ANGLES:
                changes[name] = 0.0 - value
            elif name == "turn_lanes":
                changes[name] = tuple(OTHER_DIRECTION[side] for side in value)
            elif name in ("segments", "arms"):
                changes[name] = tuple(each.mirrored() for each in value)[:: -1 if name == "arms" else 1]
        return self.model_copy(update=changes)


class Segment(FrozenFields):
    """One segment of a road: its length, the side and angle of its turn, and its grade."""

    distance: Length
    """Length along the plan curve in metres."""
    direction: Direction
    incline: Annotated[float, Field(ge=-100, le=100)] = 0.0
    """Grade in percent, uphill positive."""
    turn_degrees: Annotated[float, Field(ge=-360, le=360)] = 0.0
    """Change of heading in degrees, positive to the left."""
    radius: Length | None = None
    """Radius of the arc in metres. If the turn is shorter than ``distance``, the rest is straight."""
    transition: Length | None = None
    """Length in metres of the transition curve (clothoid) at either end of a turn."""
    vertical_radius: Length | None = None
    """Radius in metres of the vertical curve at the start of the segment. This curve joins the grade of the
    previous segment to the grade of this one."""


class LanesDesign(FrozenFields):
    """The lanes of a road."""

    forward: Annotated[int, Field(ge=1, le=MOST_LANES)] = 1
    """Number of lanes in the direction of the route, one or more."""
    backward: Annotated[int, Field(ge=0, le=MOST_LANES)] = 1
    """Number of oncoming lanes; 0 for a one-way road."""
    width: Annotated[float, Field(ge=2, le=10, allow_inf_nan=False)] = 4.0
    """Width of every lane in metres."""
    centre: Marking | None = None
    """The line between the directions; None for a broken line with one lane each way, else a solid one."""
    divided: StrictBool = False
    """Whether a median separates the directions."""
    edge: Literal["solid", "broken", "none"] = "solid"
    """The line at the outer edge of the lanes of each direction."""


class RampDesign(FrozenFields):
    """A merge, where a ramp joins a road, or a diverge, where a ramp leaves a road."""

    after: After
    """Number of segments of the route before this place."""
    kind: Literal["merge", "diverge"]
    take: Literal["ramp", "main"]
    """The road from which the route comes (merge) or to which it goes (diverge)."""
    length: LaneLength = ACCELERATION
    """Length in metres of the acceleration or deceleration lane, without its taper."""
    taper: LaneLength = RAMP_TAPER
    """Length in metres of the taper in which this lane ends or begins."""
    side: Side | None = None
    """The side of the ramp; None for the side on which traffic drives."""
    lanes: LanesDesign | None = None
    """The lanes of the road behind this place, if the route takes the ramp; None for two one-way lanes behind
    a merge, and for one behind a diverge. On the main road, the lanes stay the same."""

    @property
    def is_on_left(self) -> bool:
        """Whether the ramp lies on the left of its road, where traffic drives on the right."""
        return self.side == "left"


class LanesChangeDesign(FrozenFields):
    """A place where a lane ends or begins, or where the route changes to the next lane."""

    after: After
    """Number of segments of the route before this place."""
    kind: LaneKind
    side: Side = "right"
    """Whether the leftmost or the rightmost lane ends or begins, or the side to which the route changes."""
    length: LaneLength = TAPER
    """Length in metres of the taper in which the lane ends or begins; not used for a lane change."""
    island: StrictBool = False
    """Whether a crosswalk has an island between the directions."""
    lanes: LanesDesign | None = None
    """The lanes of the road behind this place; None for the lanes of the road before it, less the lane that
    ends or plus the lane that begins."""


def narrow_part(taper: float, width: float) -> float:
    """Returns the length in metres on which a lane that ends or begins is narrower than ``LEAST_WIDTH``. The
    lane's width is a cubic that changes between 0 and ``width`` metres over ``taper`` metres and is level at
    both ends."""
    return taper * (0.5 - math.sin(math.asin(1 - 2 * LEAST_WIDTH / width) / 3))


class ArmDesign(FrozenFields):
    """A road at a junction, other than the road on which the route arrives."""

    angle: Annotated[float, Field(gt=-180, lt=180)]
    """Direction out of the junction in degrees, from the direction of arrival, positive to the left."""
    length: Length | None = None
    """Length in metres of a straight, level arm; None for ``STUB``; not for the arm that the route takes."""
    control: Control | None = None
    """The sign or the light on this arm; None for the one that follows from the junction's ``control``."""
    one_way: Literal["in", "out"] | None = None
    """One-way traffic: "in" to the junction or "out" of it; None for both ways; not for the arm taken."""
    segments: Annotated[tuple[Segment, ...], Field(max_length=MAX_SEGMENTS)] = ()
    """The segments of the arm out of the junction, also if its traffic drives in; empty for a straight, level
    arm; not with ``length`` and not for the arm that the route takes."""

    @model_validator(mode="after")
    def _check_length(self) -> "ArmDesign":
        if self.segments and self.length is not None:
            raise PydanticCustomError("two_lengths", "has length and road segments; leave one of them out")
        return self

    @property
    def stretch(self) -> tuple[Segment, ...]:
        """The segments of the road of the arm, out of the junction: those given, or a straight, level one."""
        return self.segments or (Segment(distance=self.length or STUB, direction="straight"),)


class JunctionDesign(FrozenFields):
    """A junction on the route."""

    after: Annotated[int, Field(ge=1, le=MAX_SEGMENTS)]
    """Number of segments of the route before the junction."""
    kind: PlainKind
    take: Take
    control: Control = "none"
    """What the driver of the route meets: "priority", "yield", "stop", "lights" or "none"."""
    kerb: Annotated[float, Field(ge=1, le=100, allow_inf_nan=False)] = KERB
    """Radius in metres of the kerb between two neighbouring arms; not for roundabouts."""
    radius: Annotated[float, Field(ge=1, le=200, allow_inf_nan=False)] = ISLAND
    """Radius in metres of the central island of a roundabout."""
    ring_lanes: Annotated[int, Field(ge=1, le=2)] = 1
    """Number of lanes around the central island of a roundabout."""
    crosswalk: StrictBool = False
    """Whether each arm has a crosswalk."""
    turn_lanes: Annotated[tuple[Side, ...], Field(max_length=2)] = ()
    """The sides for which the road of arrival has one more lane, which leads to this side only."""
    turn_length: LaneLength = 25.0
    """Length in metres of the turn lanes, without the taper in which they begin."""
    lanes: LanesDesign | None = None
    """The lanes of the road on which the route goes on; None for the lanes of the road of arrival."""
    arms: Annotated[tuple[ArmDesign, ...], Field(max_length=MOST_ARMS)] = ()
    """The arms without the road of arrival, in any order; empty for ``USUAL_ARMS`` of the kind."""

    @property
    def all_arms(self) -> tuple[ArmDesign, ...]:
        """The arms, given or usual, in counter-clockwise order from the road on which the route arrives."""
        arms = self.arms or tuple(ArmDesign(angle=angle) for angle in USUAL_ARMS[self.kind])
        return tuple(sorted(arms, key=lambda arm: arm.angle))

    def check_taken(self, left_hand: bool) -> None:
        """Raises UsageError if no arm, or more than one, fits ``take``, or it has a length or segments."""
        arms, taken = self.all_arms, self.taken
        if taken is None:
            return
        arm = arms[::-1][taken] if left_hand and isinstance(self.take, int) else arms[taken]
        if arm.length is not None or arm.segments:
            given = "its road segments" if arm.segments else "length"
            raise UsageError(
                f"the arm at {arm.angle:g} degrees is the one that the route takes; its road is that of the "
                f"segments behind the junction, so leave out {given}"
            )

    @property
    def taken(self) -> int | None:
        """Index in ``all_arms`` of the arm that the route takes if traffic drives on the right; None if the
        route turns back at a roundabout. Raises UsageError if no arm, or more than one, fits ``take``."""
        arms = self.all_arms
        if isinstance(self.take, int):
            most = len(arms) + (self.kind in RINGS)
            if self.take > most:
                raise UsageError(f"take {self.take} is more than the number of exits; give 1 to {most}")
            return self.take - 1 if self.take <= len(arms) else None
        return _towards(self.kind, self.take, [arm.angle for arm in arms])


def _towards(kind: PlainKind, take: str, angles: Sequence[float]) -> int:
    """Returns the index of the only arm on a side; at a Y-junction the leftmost or the rightmost arm."""
    if kind == "y_junction" and take != "straight":
        return len(angles) - 1 if take == "left" else 0
    sides = [side_of(angle) for angle in angles]
    found = [n for n, side in enumerate(sides) if side == take]
    if len(found) != 1:
        word = "no arm leads" if not found else f"{len(found)} arms lead"
        raise UsageError(f"{word} {take}; give the number of the exit as take, 1 to {len(angles)}")
    return found[0]


PlaceDesign = JunctionDesign | RampDesign | LanesChangeDesign
"""What a route passes: a junction, a ramp, or a place where lanes change."""


def ends_route(place: PlaceDesign) -> bool:
    """Returns whether the route ends at a place because the car would turn back there."""
    return isinstance(place, JunctionDesign) and place.taken is None


class MapNode(FrozenFields):
    """A junction, a bend or an end of a road."""

    at: tuple[Finite, Finite, Finite]
    """x, y and the height in metres of the point where the roads of a junction meet, where a road ends, or
    where the two straights at a bend would meet."""
    kind: NodeKind
    control: Control = "none"
    """The signs of a junction: "lights" for all its roads, "stop" or "yield" for its minor roads; see
    ``growing.signs_at``."""
    kerb: Annotated[float, Field(ge=1, le=100, allow_inf_nan=False)] = KERB
    """Radius in metres of the kerb between two neighbouring roads of a junction; not for roundabouts."""
    radius: Annotated[float, Field(ge=1, le=2000, allow_inf_nan=False)] | None = None
    """Radius in metres of the island of a roundabout (None for 16 m), or of a bend (None for 20 m)."""

    @property
    def is_junction(self) -> bool:
        """Whether the node is a junction or a roundabout."""
        return self.kind not in ("bend", "end")


def heading_between(one: MapNode, other: MapNode) -> float:
    """Returns the heading in radians from one node to another."""
    (x, y, _), (to_x, to_y, _) = one.at, other.at
    return math.atan2(to_y - y, to_x - x)


class Design(FrozenFields):
    """A road or a route: where it starts, its heading there, and its segments and junctions in driving order.
    Or a map: nodes, the roads between them, and a route along nodes, or none."""

    starting_point: tuple[Finite, Finite, Finite]
    """x, y and z in metres."""
    theta: Finite
    """Heading at the start in degrees, 0 along +x, counter-clockwise."""
    segments: Annotated[tuple[Segment, ...], Field(max_length=MAX_SEGMENTS)]
    """The segments of a road or a route; empty for a map, which uses neither ``theta`` nor the start."""
    junctions: Annotated[tuple[PlaceDesign, ...], Field(max_length=MOST_JUNCTIONS)] = ()
    """The junctions, ramps and places where lanes change; empty for a single road."""
    lanes: LanesDesign | None = None
    """The lanes of the first road, or of all roads of a map, which have one in each direction; None for one
    lane in each direction, as wide as those of the World. A single road without lanes has those of the World.
    """
    left_hand: StrictBool = False
    """Whether traffic drives on the left."""
    nodes: Annotated[tuple[MapNode, ...], Field(max_length=MOST_NODES)] = ()
    """The nodes of a map, numbered from 1; empty for a road or a route."""
    roads: Annotated[tuple[tuple[int, int], ...], Field(max_length=MOST_ROADS)] = ()
    """The two nodes that each road of a map joins."""
    route: Annotated[tuple[int, ...], Field(max_length=MOST_PASSED)] = ()
    """Two or more nodes of a map in driving order; empty for a map without a route."""

    @model_validator(mode="before")
    @classmethod
    def _of_map(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and data.get("nodes"):
            return {"starting_point": (0.0, 0.0, 0.0), "theta": 0.0, "segments": (), **data}
        return data

    @model_validator(mode="after")
    def _check_form(self) -> "Design":
        is_map = len(self.nodes) > 1 and bool(self.roads) and not (self.segments or self.junctions)
        if not (is_map or (self.segments and not (self.nodes or self.roads or self.route))):
            raise PydanticCustomError("form", "has either segments, or nodes and roads; give one of the two")
        if is_map and self.lanes and self.lanes != LanesDesign(width=self.lanes.width):
            raise PydanticCustomError("lanes", "the lanes of a map have a width only; leave out the rest")
        return self

    def __repr__(self) -> str:
        if self.is_map:
            kinds = [node.kind.replace("_", "-") for node in self.nodes if node.is_junction]
            count = {kind: kinds.count(kind) for kind in dict.fromkeys(kinds)}
            said = ", ".join(f"{number} {kind}" for kind, number in count.items())
            return f"Design(map of {len(self.roads)} roads, junctions: {said or 'none'})"
        length = sum(segment.distance for segment in self.segments)
        if self.is_plain:
            turns = sum(segment.direction != "straight" for segment in self.segments)
            about = f"{len(self.segments)} segments, {turns} of them turning, {length:.0f} m"
        else:
            passed = ", ".join(junction.kind.replace("_", "-") for junction in self.junctions)
            about = f"{length:.0f} m of road, junctions: {passed or 'none'}"
        return f"Design({about}, from {self.starting_point} at {self.theta:g} degrees)"

    @property
    def is_plain(self) -> bool:
        """Whether this is a single road in the format of the thesis: no map, without junctions, lanes of its
        own and traffic on the left."""
        return not (self.junctions or self.lanes or self.left_hand or self.nodes)

    @property
    def is_map(self) -> bool:
        """Whether this is a map of nodes and roads."""
        return bool(self.nodes)

    @property
    def stretches(self) -> tuple[tuple[Segment, ...], ...]:
        """The segments of each road before, between and after the junctions: one road more than junctions."""
        ends = [0, *(junction.after for junction in self.junctions), len(self.segments)]
        return tuple(self.segments[a:b] for a, b in pairwise(ends))

    def mirrored(self, middle: float = 0.0) -> "Design":
        """Returns the design mirrored about the line y = ``middle`` metres, with traffic on the other
        side."""
        if self.is_map:
            nodes = [node.model_copy(update={"at": mirrored_point(node.at, middle)}) for node in self.nodes]
            return self.model_copy(update={"nodes": tuple(nodes), "left_hand": not self.left_hand})
        return self.model_copy(
            update={
                "starting_point": mirrored_point(self.starting_point, middle),
                "theta": 0.0 - self.theta,
                "segments": tuple(segment.mirrored() for segment in self.segments),
                "junctions": tuple(place.mirrored() for place in self.junctions),
                "left_hand": not self.left_hand,
            }
        )

    def to_json(self) -> dict[str, Any]:
        """Returns the design as a dictionary in RoadGPT's JSON format; for a single road, that of the RoadGPT
        thesis. Whole numbers become integers, as in the answers of the language models there."""
        out: dict[str, Any] = {}
        if not self.is_map:
            out["starting_point"] = [_as_written(v) for v in self.starting_point]
            out["theta"] = _as_written(self.theta)
        if self.left_hand:
            out["left_hand"] = True
        if self.lanes is not None:
            out["lanes"] = {"width": self.lanes.width} if self.is_map else _written_lanes(self.lanes)
        out |= _written_segments(self.segments)
        for number, junction in enumerate(self.junctions, 1):
            row = _written_fields(junction, exclude={"arms", "lanes"})
            for name, usual in USUAL.items():
                if row.get(name) == usual:
                    del row[name]
            if junction.lanes is not None:
                row["lanes"] = _written_lanes(junction.lanes)
            given = junction.arms if isinstance(junction, JunctionDesign) else ()
            arms = [
                _written_fields(arm, exclude={"segments"}) | _written_segments(arm.segments) for arm in given
            ]
            out[f"junction{number}"] = {**row, "arms": arms} if arms else row
        for number, node in enumerate(self.nodes, 1):
            fields = node.model_dump(exclude_none=True, exclude_defaults=True)
            written = {key: _as_written(value) for key, value in fields.items()}
            out[f"node{number}"] = {**written, "at": [_as_written(each) for each in node.at]}
        if self.roads:
            out["roads"] = [list(pair) for pair in self.roads]
        if self.route:
            out["route"] = list(self.route)
        return out


def mirrored_point(point: tuple[float, float, float], middle: float = 0.0) -> tuple[float, float, float]:
    """Returns a point mirrored about the line y = ``middle``, in metres."""
    x, y, z = point
    return x, round(2 * middle - y, DIGITS) if middle else 0.0 - y, z


def _written_lanes(lanes: LanesDesign) -> dict[str, Any]:
    return _written_fields(
        lanes, exclude={name for name, usual in RARE.items() if getattr(lanes, name) == usual}
    )


def vertical_curves_of(segments: Sequence[Segment]) -> list[VerticalCurve]:
    """Returns the vertical curves between the segments of a Design, in order."""
    return vertical_curves(
        [segment.distance for segment in segments],
        [segment.incline / 100 for segment in segments],
        [segment.vertical_radius for segment in segments],
    )


def _as_written(value: Any) -> Any:
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _written_fields(value: BaseModel, exclude: set[str] | None = None) -> dict[str, Any]:
    data = value.model_dump(exclude_none=True, exclude=exclude)
    return {key: _as_written(each) for key, each in data.items()}


def _written_segments(segments: Sequence[Segment]) -> dict[str, Any]:
    return {f"road_segment{number}": _written_fields(each) for number, each in enumerate(segments, 1)}


def is_design(data: Any) -> bool:
    """Returns whether parsed JSON is a design: it has a start, lanes, junctions, or nodes like ``node1``."""
    if not isinstance(data, Mapping):
        return False
    own = any(data.get(name) not in (None, False) for name in ("lanes", "left_hand"))
    keys = JUNCTION_KEY, NODE_KEY
    return own or "starting_point" in data or any(key.fullmatch(str(n)) for key in keys for n in data)


def read_design(data: Mapping[str, Any]) -> tuple[Design, tuple[str, ...]]:
    """Reads a dictionary in RoadGPT's JSON format, of a road, a route or a map; returns the Design, and a
    sentence about each contradiction or unusual value in the data.

    If ``direction`` contradicts the sign of ``turn_degrees``, as in an example in the thesis, ``direction``
    is used. A turn of more than 70 degrees or an incline of more than 15 % is kept, with a remark.

    Raises UsageError if there is no segment, a field is missing, misnamed, of the wrong type, out of range or
    contradicts another, or the roads or the route of a map do not fit its nodes."""
    if not isinstance(data, Mapping):
        raise UsageError("a design is a JSON object with starting_point, theta and road_segment1, ...")
    raw_nodes, rest = _numbered(NODE_KEY, data)
    if raw_nodes:
        return _map(dict(raw_nodes), rest), ()
    numbered, rest = _numbered(SEGMENT_KEY, data)
    raw_places, rest = _numbered(JUNCTION_KEY, rest)
    for key in rest:
        if key not in ("starting_point", "theta", "lanes", "left_hand"):
            raise UsageError(
                f"the design has a field '{str(key)[:40]}' that is unknown; "
                "the fields are starting_point, theta and road_segment1, road_segment2, ..."
            )
    if not numbered:
        raise UsageError(
            "the design has no segment; add road_segment1 with distance, direction, incline, turn_degrees"
        )
    segments, remarks = _segments(numbered)
    _no_truths("the design", {name: data.get(name) for name in ("starting_point", "theta")})
    if len(raw_places) > MOST_JUNCTIONS:
        raise UsageError(f"the design has {len(raw_places)} junctions; give {MOST_JUNCTIONS} at most")
    left_hand, raw = _is_left_hand(data), data.get("lanes")
    places = sorted(
        ((*_place(n, raw, left_hand), n) for n, raw in raw_places), key=lambda each: each[0].after
    )
    junctions = tuple(place for place, _, _ in places)
    lanes = None if raw is None else _read_part(LanesDesign, "the lanes of the design", raw, OF_A_ROAD)
    _check_order(junctions, len(segments))
    values = {"segments": segments, "junctions": junctions, "lanes": lanes, "left_hand": left_hand}
    values |= {"starting_point": data.get("starting_point", ()), "theta": data.get("theta")}
    design = _validated(Design, "the design", values)
    if not design.is_plain and max(map(abs, (*design.starting_point, design.theta))) > FARTHEST:
        # the digits would not suffice
        raise UsageError(f"starting_point or theta is beyond {FARTHEST:,.0f}; give smaller numbers")
    on_arms = [remark for _, said, _ in places for remark in said]
    return design, (*remarks, *on_arms, *_misnumbered("junctions", [number for *_, number in places]))


def _numbered(key: re.Pattern[str], data: Mapping[str, Any]) -> tuple[list[tuple[int, Any]], dict[str, Any]]:
    """Returns the numbers and values of the fields whose names match ``key``, and the other fields."""
    found = {name: match for name in data if (match := key.fullmatch(str(name)))}
    rest = {name: value for name, value in data.items() if name not in found}
    return [(int(match[1]), data[name]) for name, match in found.items()], rest


def _segments(numbered: Sequence[tuple[int, Any]]) -> tuple[tuple[Segment, ...], tuple[str, ...]]:
    """Returns the segments of a road or of an arm in the order of their numbers, and remarks on them."""
    if not numbered:
        return (), ()
    ordered = sorted(numbered, key=lambda pair: pair[0])
    read = [_segment(number, raw) for number, raw in ordered]
    segments = tuple(segment for segment, _ in read)
    said = [remark for _, remarks in read for remark in remarks]
    return segments, (*_misnumbered("segments", [number for number, _ in ordered]), *said, *_unfit(segments))


def _unfit(segments: Sequence[Segment]) -> Iterator[str]:
    for parabola in vertical_curves_of(segments):
        asked = segments[parabola.number].vertical_radius
        if asked and parabola.radius < FITS * asked:
            yield (
                f"segment {parabola.number + 1}: a vertical radius of {asked:g} m does not fit between the "
                f"neighbouring changes of grade; it becomes {parabola.radius:.0f} m"
            )


def _misnumbered(what: str, numbers: Sequence[int]) -> tuple[str, ...]:
    """Returns a remark if ``what`` is not numbered 1, 2, 3, and so on, in the order in which it is taken."""
    if [*numbers] == [*range(1, len(numbers) + 1)]:
        return ()
    told = ", ".join([*map(str, numbers[:12]), *(["..."] if len(numbers) > 12 else [])])
    return (f"{what} are numbered {told} instead of 1, 2, 3, ...; they are taken in this order",)


def _is_left_hand(data: Mapping[str, Any]) -> bool:
    if not isinstance(found := data.get("left_hand", False), bool):
        raise UsageError("left_hand cannot be read: give true for traffic on the left, or leave it out")
    return found


def _read_part(model: type[Part], what: str, raw: Any, fields: str) -> Part:
    _check_object(what, raw, fields)
    return _validated(model, what, raw)


def _validated(model: type[Part], what: str, raw: Any) -> Part:
    try:
        return model.model_validate(raw)
    except ValidationError as error:
        raise UsageError(f"{what} cannot be read: {first_error(error)}") from error


def _check_object(what: str, raw: Any, fields: str) -> None:
    """Raises UsageError if parsed JSON is not an object, or has true or false in place of a number."""
    if not isinstance(raw, Mapping):
        raise UsageError(f"{what} cannot be read: give an object with {fields}")
    truths = ("divided", "crosswalk", "island")
    _no_truths(what, {name: value for name, value in raw.items() if name not in truths})


def _check_order(junctions: Sequence[PlaceDesign], segments: int) -> None:
    after = [junction.after for junction in junctions]
    for n, place in enumerate(after):
        if n and place == after[n - 1]:
            raise UsageError(f"two junctions stand after segment {place}; put a segment between them")
        if n and ends_route(junctions[n - 1]):
            raise UsageError(
                f"the roundabout after segment {after[n - 1]} leads back on the road of arrival, so no "
                f"junction can stand after segment {place}; take another exit"
            )
        if ends_route(junctions[n]) and place < segments:
            raise UsageError(
                f"the roundabout after segment {place} leads back on the road of arrival, so the segments "
                "behind it are never reached; leave them out or take another exit"
            )
        if place >= segments and not ends_route(junctions[n]):
            raise UsageError(
                f"a junction stands after segment {place}, and there are {segments}; add a segment behind it "
                "for the road on which the route goes on"
            )


OF_LANES: dict[str, type[RampDesign] | type[LanesChangeDesign]] = {
    **dict.fromkeys(RAMPS, RampDesign),
    **dict.fromkeys(LANE_KINDS, LanesChangeDesign),
}


def _place(number: int, raw: Any, left_hand: bool) -> tuple[PlaceDesign, tuple[str, ...]]:
    what, fields = f"junction {number}", "after, kind and take"
    _check_object(what, raw, fields)
    if raw.get("lanes") is not None:
        _check_object(f"the lanes of {what}", raw["lanes"], OF_A_ROAD)
    kinds = (*USUAL_ARMS, *OF_LANES)
    if "kind" in raw and raw["kind"] not in kinds:
        raise UsageError(f"{what} cannot be read: kind: is unknown; give {', '.join(map(repr, kinds))}")
    made = OF_LANES.get(raw.get("kind", ""))
    return _junction(what, raw, left_hand) if made is None else (_read_part(made, what, raw, fields), ())


def _junction(what: str, raw: Mapping[str, Any], left_hand: bool) -> tuple[JunctionDesign, tuple[str, ...]]:
    arms = raw.get("arms", ())
    if not isinstance(arms, (list, tuple)) or len(arms) > MOST_ARMS:
        raise UsageError(f"{what} cannot be read: arms: give a list of at most {MOST_ARMS} arms")
    read, remarks = [], list[str]()
    for n, arm in enumerate(arms, 1):
        _check_object(f"arm {n} of {what}", arm, "angle")
        numbered, fields = _numbered(SEGMENT_KEY, arm)
        if "segments" in fields:
            raise UsageError(
                f"arm {n} of {what} has a field 'segments' that is unknown; give road_segment1, ... instead"
            )
        try:
            segments, said = _segments(numbered)
        except UsageError as error:
            raise UsageError(f"arm {n} of {what}: {error}") from error
        read.append({**fields, "segments": segments})
        remarks += [f"arm {n} of {what}: {each}" for each in said]
    try:
        made = JunctionDesign.model_validate({**raw, "arms": read})
    except ValidationError as error:
        wrong = first_error(error)
        if error.errors()[0]["loc"][:1] == ("take",) and "take" in raw:
            wrong = "take: is unknown; give 'left', 'right', 'straight' or the number of the exit, from 1 on"
        raise UsageError(f"{what} cannot be read: {wrong}") from error
    try:
        _check_arms(made)
        made.check_taken(left_hand)
    except UsageError as error:
        raise UsageError(f"{what}: {error}") from error
    return made, tuple(remarks)


def _check_arms(made: JunctionDesign) -> None:
    angles = [arm.angle for arm in made.all_arms]
    least, most = COUNTS[made.kind]
    if not least <= len(angles) <= most:
        wanted = f"{least}" if least == most else f"{least} to {most}"
        raise UsageError(
            f"a {made.kind} has {wanted} arms besides the road of arrival, and {len(angles)} are given"
        )
    own = [side_of(angle) for angle in angles if made.kind in ("t_junction", "crossroads")]
    if not {*made.turn_lanes} <= {*own} or len({*made.turn_lanes}) < len(made.turn_lanes):
        raise UsageError("turn_lanes are sides with an arm of a T-junction or of crossroads, each named once")
    around = [-180.0, *angles, 180.0]
    for a, b in pairwise(around):
        if b - a < ASTERN:
            raise UsageError(
                f"arms at {a:g} and {b:g} degrees are less than {ASTERN:g} degrees apart (180 degrees is the "
                "road of arrival); turn them apart"
            )


def _segment(number: int, raw: Any) -> tuple[Segment, list[str]]:
    if isinstance(raw, Mapping):
        missing = [name for name in REQUIRED if name not in raw]
        if missing:
            raise UsageError(f"segment {number} cannot be read: {missing[0]}: {ADVICE['missing']}")
        _no_truths(f"segment {number}", raw)
    segment, remarks = _validated(Segment, f"segment {number}", raw), []
    turn = math.copysign(segment.turn_degrees, {"left": 1.0, "right": -1.0}.get(segment.direction, 1.0))
    if segment.direction == "straight":
        turn = 0.0
    if turn != segment.turn_degrees and segment.turn_degrees != 0:
        remarks.append(
            f"segment {number}: direction '{segment.direction}' and turn_degrees "
            f"{segment.turn_degrees:g} disagree; the direction wins: {turn:g}"
        )
    if abs(turn) > MAX_TURN:
        remarks.append(
            f"segment {number}: turns {abs(turn):g} degrees, more than {MAX_TURN:g} in one segment"
        )
    if abs(segment.incline) > MAX_INCLINE:
        remarks.append(f"segment {number}: incline {segment.incline:g} % is beyond {MAX_INCLINE:g} %")
    if segment.radius and math.radians(abs(turn)) * segment.radius > segment.distance:
        remarks.append(
            f"segment {number}: {abs(turn):g} degrees at a radius of {segment.radius:g} m do not fit into "
            f"{segment.distance:g} m; the distance is kept, and the turn is tighter"
        )
    return segment.model_copy(update={"turn_degrees": turn}), remarks


def _no_truths(what: str, data: Mapping[str, Any]) -> None:
    """Raises UsageError if a value, or an entry of a list, is a Boolean; the message names ``what``."""
    for name, value in data.items():
        values = value if isinstance(value, (list, tuple)) else (value,)
        if any(isinstance(each, bool) for each in values):
            raise UsageError(f"{what} cannot be read: {str(name)[:40]}: {ADVICE['float_type']}")


def first_error(error: ValidationError) -> str:
    """Returns the first error that pydantic found, as the text 'field: what to do'."""
    problem = error.errors()[0]
    place, advice = ".".join(str(part) for part in problem["loc"]), ADVICE.get(problem["type"])
    said = advice.format(**problem.get("ctx", {})) if advice else str(problem["msg"])
    return f"{place}: {said}" if place else said


ADVICE = {
    "missing": "is missing; add it",
    "extra_forbidden": "is not a field of a design; remove it",
    "finite_number": "is not finite; give a finite number",
    **dict.fromkeys(("float_type", "float_parsing"), "is not a number; give one"),
    "less_than": "is out of range; give less than {lt:g}",
    "greater_than": "is out of range; give more than {gt:g}",
    "greater_than_equal": "is out of range; give {ge:g} or more",
    "less_than_equal": "is out of range; give {le:g} or less",
    "literal_error": "is unknown; give {expected}",
    "int_from_float": "is not a whole number; give one",
    "model_type": "give an object with distance, direction, incline, turn_degrees",
}
"""What to do about an error, by pydantic's name for it; for others, pydantic's own message will do."""


def _map(numbered: Mapping[int, Any], data: Mapping[str, Any]) -> Design:
    """Returns the design of a map from its numbered nodes and its other fields."""
    for key in data:
        if key not in ("lanes", "left_hand", "roads", "route"):
            raise UsageError(
                f"the map has a field '{str(key)[:40]}' that is unknown; the fields are lanes, left_hand, "
                "node1, node2, ..., roads and route"
            )
    if sorted(numbered) != [*range(1, len(numbered) + 1)] or not 2 <= len(numbered) <= MOST_NODES:
        raise UsageError(f"the nodes of a map are numbered node1, node2 and so on, 2 to {MOST_NODES} of them")
    if isinstance(lanes := data.get("lanes"), Mapping) and (
        other := next((k for k in lanes if k != "width"), None)
    ):
        raise UsageError(
            f"the lanes of the map cannot be read: {other}: is not a field of a design; remove it"
        )
    nodes = [_node(number, numbered[number]) for number in sorted(numbered)]
    roads = tuple((pair[0], pair[1]) for pair in _pairs(data.get("roads")))
    route = data.get("route")
    made = Design(
        starting_point=(0.0, 0.0, 0.0),
        theta=0.0,
        segments=(),
        nodes=tuple(nodes),
        roads=roads,
        route=() if route in (None, [], ()) else tuple(_numbers(route, "the route", MOST_PASSED)),
        lanes=None if lanes is None else _read_part(LanesDesign, "the lanes of the map", lanes, "width"),
        left_hand=_is_left_hand(data),
    )
    ends = _checked_ends(made)
    for number, others in ends.items():
        _check_node(made, number, others)
    _check_connected(made, ends)
    if made.route:
        _check_route(made)
    return made


def _node(number: int, raw: Any) -> MapNode:
    what, at = f"node {number}", raw.get("at", ...) if isinstance(raw, Mapping) else ...
    if at is not ... and (not isinstance(at, (list, tuple)) or len(at) != 3):
        raise UsageError(f"{what} cannot be read: at: give x, y and the height, as in [20, 80, 0]")
    node = _read_part(MapNode, what, raw, "at and kind")
    if max(map(abs, node.at)) > FARTHEST:
        raise UsageError(f"{what} is beyond {FARTHEST:,.0f}; give smaller numbers")
    return node


def _pairs(raw: Any) -> list[Sequence[int]]:
    if not isinstance(raw, (list, tuple)) or not 1 <= len(raw) <= MOST_ROADS:
        raise UsageError(f"roads are a list of 1 to {MOST_ROADS} pairs of nodes, such as [[1, 2], [2, 3]]")
    return [_numbers(pair, f"road {number}", 2) for number, pair in enumerate(raw, 1)]


def _numbers(raw: Any, what: str, most: int) -> Sequence[int]:
    is_list = isinstance(raw, (list, tuple)) and 2 <= len(raw) <= most
    if not is_list or any(isinstance(each, bool) or not isinstance(each, int) for each in raw):
        count = "two" if most == 2 else "two or more"
        raise UsageError(f"{what} is a list of {count} numbers of nodes, such as [1, 2]")
    return list(raw)


def _checked_ends(design: Design) -> dict[int, list[int]]:
    """Returns for each node the nodes at the other ends of its roads. Raises UsageError unless every road
    joins two existing nodes that are at least ``NEAREST`` metres apart, and no two roads join the same nodes.
    """
    ends: dict[int, list[int]] = {number: [] for number in range(1, len(design.nodes) + 1)}
    for number, (one, other) in enumerate(design.roads, 1):
        for each in (one, other):
            if each not in ends:
                raise UsageError(
                    f"road {number} names node {each}, and there are nodes 1 to {len(design.nodes)}"
                )
        if one == other:
            raise UsageError(f"road {number} joins node {one} to itself; give two different nodes")
        if other in ends[one]:
            raise UsageError(
                f"two roads join nodes {one} and {other}; leave one out, or lead it over another node"
            )
        if math.dist(design.nodes[one - 1].at[:2], design.nodes[other - 1].at[:2]) < NEAREST:
            raise UsageError(
                f"nodes {one} and {other} are less than {NEAREST:g} m apart; move them apart or make them one"
            )
        ends[one].append(other)
        ends[other].append(one)
    return ends


def _check_node(design: Design, number: int, others: Sequence[int]) -> None:
    kind = design.nodes[number - 1].kind
    fewest, most = ROADS[kind]
    if not fewest <= len(others) <= most:
        wanted = plural(most, "road") if fewest == most else f"{fewest} to {most} roads"
        here = plural(len(others), "road")
        name = f"{'an' if kind == 'end' else 'a'} {kind}"
        raise UsageError(
            f"node {number} is {name}, which has {wanted}, and here it has {here}; change its kind or the "
            "roads"
        )
    if len(others) < 2:
        return
    out = sorted(
        (math.degrees(heading_between(design.nodes[number - 1], design.nodes[n - 1])), n) for n in others
    )
    least = 180 - STEEPEST_BEND if kind == "bend" else ASTERN
    for (a, one), (b, other) in pairwise([*out, (out[0][0] + 360, out[0][1])]):
        if b - a < least - 1e-9:
            raise UsageError(
                f"the roads from node {number} to nodes {one} and {other} are {b - a:.0f} degrees apart, and "
                f"{least:g} are needed; move one of these nodes"
            )


def _check_connected(design: Design, ends: Mapping[int, Sequence[int]]) -> None:
    if all(node.kind == "bend" for node in design.nodes):
        raise UsageError("all nodes are bends, so that no road begins or ends; add an end or a junction")
    seen, waiting = {1}, [1]
    while waiting:
        new = [n for n in ends[waiting.pop()] if n not in seen]
        seen.update(new)
        waiting += new
    lost = next((number for number in ends if number not in seen), None)
    if lost is not None:
        raise UsageError(f"no roads lead from node 1 to node {lost}; join them or leave node {lost} out")


def _check_route(design: Design) -> None:
    route, joined = design.route, {frozenset(pair) for pair in design.roads}
    for one, other in pairwise(route):
        if frozenset((one, other)) not in joined:
            raise UsageError(f"the route goes from node {one} to node {other}, and no road joins them")
    for number in (route[0], route[-1]):
        if design.nodes[number - 1].kind == "bend":
            raise UsageError(f"the route begins or ends at node {number}, a bend; take a junction or an end")
    for before, here, after in zip(route, route[1:], route[2:], strict=False):
        if before == after and design.nodes[here - 1].kind not in RINGS:
            raise UsageError(
                f"the route turns back at node {here}, and one can only at a roundabout or a turning "
                "circle; leave out the rest"
            )
