"""Defines the NetworkDesign: the design of a route with the junctions that it passes.

The design is written in RoadGPT's JSON format, with additional fields:

    "lanes": {"forward": 1, "backward": 1, "width": 3.5}
    "junction1": {"after": 2, "kind": "crossroads", "take": "left", "control": "yield", "kerb": 10,
                  "arms": [{"angle": -90}, {"angle": 0, "length": 40}, {"angle": 90}]}

``after`` is the number of segments before the junction. ``arms`` are the roads at the junction other than the
road of arrival; ``angle`` is the direction out of the junction on this arm, in degrees from the direction in
which the route arrives, positive to the left; ``network.arm_design`` describes arms that are not straight and
level. ``take`` names the arm on which the route goes on: "left", "right", "straight", or the number of the
exit, counted counter-clockwise from the road of arrival. ``lanes`` of a junction are those of the road on
which the route goes on. ``network.lane_design`` describes merges, exits and places where lanes change. With
``"left_hand": true``, traffic drives on the left: exits are counted clockwise, and ramps lie on the left.
"""

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, Field, StrictBool, ValidationError

from roadgpt.brief.junction_ranges import side_of
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, Control, PlainKind
from roadgpt.errors import UsageError
from roadgpt.network.arm_design import ArmDesign, read_segments
from roadgpt.network.lane_design import RAMP_TAPER, RARE, LanesChangeDesign, LanesDesign, RampDesign
from roadgpt.network.pose import mirrored_point
from roadgpt.road import Segment, read_design
from roadgpt.road.design import (
    MAX_SEGMENTS,
    OTHER_DIRECTION,
    Finite,
    FrozenFields,
    as_written,
    first_error,
    misnumbered,
    no_truths,
    written_fields,
    written_segments,
)
from roadgpt.road.road import FARTHEST

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
        """Returns the junction with left and right exchanged. The number of an exit stays: the mirrored
        exits are counted the other way round.
        """
        take = self.take if isinstance(self.take, int) else OTHER_DIRECTION[self.take]
        return self.model_copy(
            update={"take": take, "arms": tuple(arm.mirrored() for arm in reversed(self.arms))}
        )

    def arm_taken(self, left_hand: bool) -> ArmDesign | None:
        """Returns the arm that the route takes; None if the route turns back at a roundabout.

        Raises:
            UsageError: No arm, or more than one, fits ``take``, or the arm has a length or segments.
        """
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
        route turns back at a roundabout.

        Raises:
            UsageError: No arm, or more than one, fits ``take``.
        """
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
    """Returns whether the route ends at a place because the car would turn back there, onto the road on which
    the car came.
    """
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
        """Returns the design with left and right exchanged, and traffic on the other side.

        Args:
            middle: The y in metres of the mirror line, which is parallel to the x axis.
        """
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
    """Reads a dictionary in RoadGPT's JSON format as a network; returns the design and remarks.

    Each remark is a sentence about a contradiction in the data or an unusual value.

    Raises:
        UsageError: A field is missing, misnamed, of the wrong type, out of range or contradicts another.
    """
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
    """Returns a part of a design, such as a junction, from parsed JSON. Raises UsageError if the part cannot
    be read. The message names the part, ``what``, and, if ``raw`` is not an object, the ``fields``.
    """
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
    """Returns a place from parsed JSON, and remarks on it."""
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
