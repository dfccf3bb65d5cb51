"""Defines the NetworkDesign: the design of a route with the junctions that it passes.

The design is written in RoadGPT's JSON format, with additional fields:

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
the left."""

import math
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, Field, StrictBool, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from roadgpt.brief.junctions import LANE_KINDS, RAMPS, Control, LaneKind, PlainKind, Side, side_of
from roadgpt.brief.words import MOST_LANES
from roadgpt.errors import UsageError
from roadgpt.network.pose import mirrored_point
from roadgpt.road import Segment, read_design
from roadgpt.road.design import (
    MAX_SEGMENTS,
    OTHER_DIRECTION,
    SEGMENT_KEY,
    Finite,
    FrozenFields,
    Length,
    as_written,
    first_error,
    misnumbered,
    no_truths,
    written_fields,
    written_segments,
)
from roadgpt.road.profile import Marking
from roadgpt.road.road import FARTHEST

ACCELERATION = 130.0  # m, length of an acceleration or deceleration lane without its taper
RAMP_TAPER = 60.0  # m, length of the taper of such a lane: RAA 2008, entries and exits
MEDIAN = 2.0  # m, width of a median
TAPER = 60.0  # m, length of the taper of a lane that ends or begins
LEAST_WIDTH = 1.5  # m; where a lane is narrower than this, no car can drive in it

RARE = {"divided": False, "edge": "solid"}
"""Fields of a LanesDesign that are written only if they differ from these values."""
After = Annotated[int, Field(ge=1, le=MAX_SEGMENTS)]
LaneLength = Annotated[float, Field(ge=10, le=2000, allow_inf_nan=False)]
STUB = 25.0  # m, length of an arm whose length is not given
KEY = re.compile(r"junction(\d{1,4})")
OWN = ("lanes", "left_hand")
"""The fields, besides the junctions, that a NetworkDesign has and the Design of a single road has not."""
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
}
"""The angles in degrees of the arms of a junction whose design gives no arms."""
COUNTS: dict[PlainKind, tuple[int, int]] = {
    "t_junction": (2, 2),
    "y_junction": (2, 2),
    "crossroads": (3, 3),
    "star": (4, MOST_ARMS),
    "roundabout": (2, 5),
}
"""The smallest and the largest number of arms, without the road of arrival."""
Take = Literal["left", "right", "straight"] | Annotated[int, Field(ge=1)]
Part = TypeVar("Part", bound=BaseModel)


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

    def mirrored(self) -> "RampDesign":
        """Returns the ramp with left and right exchanged."""
        side = None if self.side is None else OTHER_DIRECTION[self.side]
        return self.model_copy(update={"side": side})


class LanesChangeDesign(FrozenFields):
    """A place where a lane ends or begins, or where the route changes to the next lane."""

    after: After
    """Number of segments of the route before this place."""
    kind: LaneKind
    side: Side = "right"
    """Whether the leftmost or the rightmost lane ends or begins, or the side to which the route changes."""
    length: LaneLength = TAPER
    """Length in metres of the taper in which the lane ends or begins; not used for a lane change."""
    lanes: LanesDesign | None = None
    """The lanes of the road behind this place; None for the lanes of the road before it, less the lane that
    ends or plus the lane that begins."""

    def mirrored(self) -> "LanesChangeDesign":
        """Returns the place with left and right exchanged."""
        return self.model_copy(update={"side": OTHER_DIRECTION[self.side]})


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

    def mirrored(self) -> "ArmDesign":
        """Returns the arm with left and right exchanged."""
        segments = tuple(segment.mirrored() for segment in self.segments)
        return self.model_copy(update={"angle": 0.0 - self.angle, "segments": segments})


def read_segments(what: str, raw: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Reads the segments of an arm, as those of a road, for an ArmDesign; other fields are returned
    unchanged. ``what`` names the arm in remarks and errors. Raises UsageError if a segment cannot be read."""
    own = {key: each for key, each in raw.items() if SEGMENT_KEY.fullmatch(str(key))}
    fields = {key: each for key, each in raw.items() if key not in own}
    if "segments" in fields:
        raise UsageError(f"{what} has a field 'segments' that is unknown; give road_segment1, ... instead")
    if not own:
        return fields, ()
    try:
        design, remarks = read_design({"starting_point": (0.0, 0.0, 0.0), "theta": 0.0, **own})
    except UsageError as error:
        raise UsageError(f"{what}: {error}") from error
    return {**fields, "segments": design.segments}, tuple(f"{what}: {each}" for each in remarks)


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
    lanes: LanesDesign | None = None
    """The lanes of the road on which the route goes on; None for the lanes of the road of arrival."""
    arms: Annotated[tuple[ArmDesign, ...], Field(max_length=MOST_ARMS)] = ()
    """The arms without the road of arrival, in any order; empty for ``USUAL_ARMS`` of the kind."""

    @property
    def all_arms(self) -> tuple[ArmDesign, ...]:
        """The arms, given or usual, in counter-clockwise order from the road on which the route arrives."""
        arms = self.arms or tuple(ArmDesign(angle=angle) for angle in USUAL_ARMS[self.kind])
        return tuple(sorted(arms, key=lambda arm: arm.angle))

    def mirrored(self) -> "JunctionDesign":
        """Returns the junction with left and right exchanged. The number of an exit stays, because the
        mirrored exits are counted the other way round."""
        take = self.take if isinstance(self.take, int) else OTHER_DIRECTION[self.take]
        return self.model_copy(
            update={"take": take, "arms": tuple(arm.mirrored() for arm in reversed(self.arms))}
        )

    def arm_taken(self, left_hand: bool) -> ArmDesign | None:
        """Returns the arm that the route takes; None if the route turns back at a roundabout. Raises
        UsageError if no arm, or more than one, fits ``take``, or the arm has a length or segments."""
        arms, taken = self.all_arms, self.taken
        if taken is None:
            return None
        arm = arms[::-1][taken] if left_hand and isinstance(self.take, int) else arms[taken]
        if arm.length is not None or arm.segments:
            given = "its road segments" if arm.segments else "length"
            raise UsageError(
                f"the arm at {arm.angle:g} degrees is the one that the route takes; its road is that of the "
                f"segments behind the junction, so leave out {given}"
            )
        return arm

    @property
    def taken(self) -> int | None:
        """Index in ``all_arms`` of the arm that the route takes if traffic drives on the right; None if the
        route turns back at a roundabout. Raises UsageError if no arm, or more than one, fits ``take``."""
        arms = self.all_arms
        if isinstance(self.take, int):
            most = len(arms) + (self.kind == "roundabout")
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


class NetworkDesign(FrozenFields):
    """The start of a route, the heading there, and the segments and junctions in driving order."""

    starting_point: tuple[Finite, Finite, Finite]
    theta: Finite
    """Heading at the start in degrees, 0 along +x, counter-clockwise."""
    segments: Annotated[tuple[Segment, ...], Field(min_length=1)]
    junctions: Annotated[tuple[PlaceDesign, ...], Field(max_length=MOST_JUNCTIONS)]
    """The junctions, ramps and places where lanes change; empty for a single road."""
    lanes: LanesDesign | None = None
    """The lanes of the first road; None for one lane in each direction, as wide as those of the World."""
    left_hand: StrictBool = False
    """Whether traffic drives on the left."""

    def __repr__(self) -> str:
        kinds = ", ".join(junction.kind.replace("_", "-") for junction in self.junctions) or "none"
        length = sum(segment.distance for segment in self.segments)
        return f"NetworkDesign({length:.0f} m of road, junctions: {kinds})"

    @property
    def stretches(self) -> tuple[tuple[Segment, ...], ...]:
        """The segments of each road before, between and after the junctions: one road more than junctions."""
        ends = [0, *(junction.after for junction in self.junctions), len(self.segments)]
        return tuple(self.segments[a:b] for a, b in pairwise(ends))

    def mirrored(self, middle: float = 0.0) -> "NetworkDesign":
        """Returns the design mirrored about the line y = ``middle`` metres, with traffic on the other
        side."""
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
        """Returns the design as a dictionary in RoadGPT's JSON format."""
        out: dict[str, Any] = {
            "starting_point": [as_written(v) for v in self.starting_point],
            "theta": as_written(self.theta),
        }
        if self.left_hand:
            out["left_hand"] = True
        if self.lanes is not None:
            out["lanes"] = _written_lanes(self.lanes)
        out |= written_segments(self.segments)
        for number, junction in enumerate(self.junctions, 1):
            row = written_fields(junction, exclude={"arms", "lanes"})
            for name, usual in (("ring_lanes", 1), ("crosswalk", False), ("taper", RAMP_TAPER)):
                if row.get(name) == usual:
                    del row[name]
            if junction.lanes is not None:
                row["lanes"] = _written_lanes(junction.lanes)
            given = junction.arms if isinstance(junction, JunctionDesign) else ()
            arms = [
                written_fields(arm, exclude={"segments"}) | written_segments(arm.segments) for arm in given
            ]
            out[f"junction{number}"] = {**row, "arms": arms} if arms else row
        return out


def _written_lanes(lanes: LanesDesign) -> dict[str, Any]:
    return written_fields(
        lanes, exclude={name for name, usual in RARE.items() if getattr(lanes, name) == usual}
    )


def is_network_design(data: Any) -> bool:
    """Returns whether parsed JSON is a NetworkDesign: it has junctions, lanes, or traffic on the left."""
    if not isinstance(data, Mapping):
        return False
    return any((key in OWN and data[key] not in (None, False)) or KEY.fullmatch(str(key)) for key in data)


def read_network_design(data: Mapping[str, Any]) -> tuple[NetworkDesign, tuple[str, ...]]:
    """Reads a dictionary in RoadGPT's JSON format as a network; returns the design, and a sentence about each
    contradiction or unusual value in the data. Raises UsageError if a field is missing, misnamed, of the
    wrong type, out of range or contradicts another."""
    rest = {key: each for key, each in data.items() if key not in OWN and not KEY.fullmatch(str(key))}
    design, remarks = read_design(rest)
    found = [(int(match[1]), raw) for key, raw in data.items() if (match := KEY.fullmatch(str(key)))]
    if len(found) > MOST_JUNCTIONS:
        raise UsageError(f"the design has {len(found)} junctions; give {MOST_JUNCTIONS} at most")
    left_hand = is_left_hand(data)
    places = [(*_place(n, raw, left_hand), n) for n, raw in found]
    places.sort(key=lambda each: each[0].after)
    junctions = [place for place, _, _ in places]
    raw = data.get("lanes")
    lanes = None if raw is None else read_part(LanesDesign, "the lanes of the design", raw, OF_A_ROAD)
    _check_order(junctions, len(design.segments))
    if max(map(abs, (*design.starting_point, design.theta))) > FARTHEST:  # the digits would not suffice
        raise UsageError(f"starting_point or theta is beyond {FARTHEST:,.0f}; give smaller numbers")
    made = NetworkDesign(**dict(design), junctions=tuple(junctions), lanes=lanes, left_hand=left_hand)
    on_arms = [remark for _, said, _ in places for remark in said]
    return made, (*remarks, *on_arms, *misnumbered("junctions", [number for *_, number in places]))


def is_left_hand(data: Mapping[str, Any]) -> bool:
    """Returns whether traffic drives on the left. Raises UsageError unless the field is true or false."""
    if not isinstance(found := data.get("left_hand", False), bool):
        raise UsageError("left_hand cannot be read: give true for traffic on the left, or leave it out")
    return found


def read_part(model: type[Part], what: str, raw: Any, fields: str) -> Part:
    """Returns a part of a design from parsed JSON. Raises UsageError if the part, named ``what``, cannot be
    read; the message names the ``fields`` if ``raw`` is not an object."""
    _check_object(what, raw, fields)
    try:
        return model.model_validate(raw)
    except ValidationError as error:
        raise UsageError(f"{what} cannot be read: {first_error(error)}") from error


def _check_object(what: str, raw: Any, fields: str) -> None:
    """Raises UsageError if parsed JSON is not an object, or has true or false in place of a number."""
    if not isinstance(raw, Mapping):
        raise UsageError(f"{what} cannot be read: give an object with {fields}")
    no_truths(what, {name: value for name, value in raw.items() if name not in ("divided", "crosswalk")})


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
    return _junction(what, raw, left_hand) if made is None else (read_part(made, what, raw, fields), ())


def _junction(what: str, raw: Mapping[str, Any], left_hand: bool) -> tuple[JunctionDesign, tuple[str, ...]]:
    arms = raw.get("arms", ())
    if not isinstance(arms, (list, tuple)) or len(arms) > MOST_ARMS:
        raise UsageError(f"{what} cannot be read: arms: give a list of at most {MOST_ARMS} arms")
    read, remarks = [], list[str]()
    for n, arm in enumerate(arms, 1):
        _check_object(f"arm {n} of {what}", arm, "angle")
        fields, said = read_segments(f"arm {n} of {what}", arm)
        read.append(fields)
        remarks += said
    try:
        made = JunctionDesign.model_validate({**raw, "arms": read})
    except ValidationError as error:
        wrong = first_error(error)
        if error.errors()[0]["loc"][:1] == ("take",) and "take" in raw:
            wrong = "take: is unknown; give 'left', 'right', 'straight' or the number of the exit, from 1 on"
        raise UsageError(f"{what} cannot be read: {wrong}") from error
    try:
        _check_arms(made)
        made.arm_taken(left_hand)
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
    around = [-180.0, *angles, 180.0]
    for a, b in pairwise(around):
        if b - a < ASTERN:
            raise UsageError(
                f"arms at {a:g} and {b:g} degrees are less than {ASTERN:g} degrees apart (180 degrees is the "
                "road of arrival); turn them apart"
            )
