"""Defines the Design of a road, and reads and writes it in the JSON format of the RoadGPT thesis:

    {"starting_point": [x, y, z], "theta": degrees,
     "road_segment1": {"distance", "direction", "incline", "turn_degrees"}, "road_segment2": ...}

``theta`` is the heading at the start, counter-clockwise from +x, as in the code of the thesis (the prompt in
the thesis states +y). ``distance`` is the length along the plan curve. A segment may also contain ``radius``,
``transition`` and ``vertical_radius``, which are not part of the format in the thesis."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from roadgpt.errors import UsageError
from roadgpt.road.profile import ONLY_NETWORKS

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
OTHER_DIRECTION: dict[Direction, Direction] = {"left": "right", "right": "left", "straight": "straight"}
Finite = Annotated[float, Field(allow_inf_nan=False)]
Length = Annotated[float, Field(ge=0.001, le=100_000, allow_inf_nan=False)]


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

    def mirrored(self) -> "Segment":
        """Returns the segment with left and right exchanged."""
        turn = {"direction": OTHER_DIRECTION[self.direction], "turn_degrees": 0.0 - self.turn_degrees}
        return self.model_copy(update=turn)


class Design(FrozenFields):
    """Where a road starts, its heading there, and its segments in driving order."""

    starting_point: tuple[Finite, Finite, Finite]
    """x, y and z in metres."""
    theta: Finite
    """Heading at the start in degrees, 0 along +x, counter-clockwise."""
    segments: Annotated[tuple[Segment, ...], Field(min_length=1, max_length=MAX_SEGMENTS)]

    def __repr__(self) -> str:
        length = sum(segment.distance for segment in self.segments)
        turns = sum(segment.direction != "straight" for segment in self.segments)
        about = f"{len(self.segments)} segments, {turns} of them turning, {length:.0f} m"
        return f"Design({about}, from {self.starting_point} at {self.theta:g} degrees)"

    def to_json(self) -> dict[str, Any]:
        """Returns the design in the JSON format of the RoadGPT thesis. Whole numbers become integers, as in
        the answers of the language models there."""
        return {
            "starting_point": [as_written(v) for v in self.starting_point],
            "theta": as_written(self.theta),
            **written_segments(self.segments),
        }


def vertical_curves_of(segments: Sequence[Segment]) -> list[VerticalCurve]:
    """Returns the vertical curves between the segments of a Design, in order."""
    return vertical_curves(
        [segment.distance for segment in segments],
        [segment.incline / 100 for segment in segments],
        [segment.vertical_radius for segment in segments],
    )


def as_written(value: Any) -> Any:
    """Returns a float that is a whole number as an integer, and any other value unchanged."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def written_fields(value: BaseModel, exclude: set[str] | None = None) -> dict[str, Any]:
    """Returns the fields that have a value, as in RoadGPT's JSON format."""
    data = value.model_dump(exclude_none=True, exclude=exclude)
    return {key: as_written(each) for key, each in data.items()}


def written_segments(segments: Sequence[Segment]) -> dict[str, Any]:
    """Returns segments as in RoadGPT's JSON format, numbered from 1."""
    return {f"road_segment{number}": written_fields(each) for number, each in enumerate(segments, 1)}


def read_design(data: Mapping[str, Any]) -> tuple[Design, tuple[str, ...]]:
    """Reads a dictionary in the format of the RoadGPT thesis; returns the Design, and a sentence about each
    contradiction or unusual value in the data.

    If ``direction`` contradicts the sign of ``turn_degrees``, as in an example in the thesis, ``direction``
    is used. A turn of more than 70 degrees or an incline of more than 15 % is kept, with a remark.

    Raises UsageError if there is no segment, or a field is missing, misnamed, of the wrong type or out of
    range."""
    if not isinstance(data, Mapping):
        raise UsageError("a design is a JSON object with starting_point, theta and road_segment1, ...")
    if data.get("left_hand", False) is not False:
        raise UsageError(f"{ONLY_NETWORKS}; leave left_hand out")
    segments, remarks = [], list[str]()
    numbered = _numbered(data)
    remarks += misnumbered("segments", [number for number, _ in numbered])
    for number, raw in numbered:
        segment, said = _segment(number, raw)
        segments.append(segment)
        remarks += said
    no_truths("the design", {name: data.get(name) for name in ("starting_point", "theta")})
    try:
        design = Design(
            starting_point=data.get("starting_point", ()), theta=data.get("theta"), segments=tuple(segments)
        )
    except ValidationError as error:
        raise UsageError(f"the design cannot be read: {first_error(error)}") from error
    return design, (*remarks, *_unfit(design.segments))


def _unfit(segments: Sequence[Segment]) -> Iterator[str]:
    for parabola in vertical_curves_of(segments):
        asked = segments[parabola.number].vertical_radius
        if asked and parabola.radius < FITS * asked:
            yield (
                f"segment {parabola.number + 1}: a vertical radius of {asked:g} m does not fit between the "
                f"neighbouring changes of grade; it becomes {parabola.radius:.0f} m"
            )


def _numbered(data: Mapping[str, Any]) -> list[tuple[int, Any]]:
    found = []
    for key, raw in data.items():
        match = SEGMENT_KEY.fullmatch(str(key))
        if match:
            found.append((int(match[1]), raw))
        elif key not in ("starting_point", "theta"):
            raise UsageError(
                f"the design has a field '{str(key)[:40]}' that is unknown; "
                "the fields are starting_point, theta and road_segment1, road_segment2, ..."
            )
    found.sort(key=lambda pair: pair[0])
    if not found:
        raise UsageError(
            "the design has no segment; add road_segment1 with distance, direction, incline, turn_degrees"
        )
    return found


def misnumbered(what: str, numbers: Sequence[int]) -> tuple[str, ...]:
    """Returns a remark if ``what`` is not numbered 1, 2, 3, and so on, in the order in which it is taken."""
    if [*numbers] == [*range(1, len(numbers) + 1)]:
        return ()
    told = ", ".join([*map(str, numbers[:12]), *(["..."] if len(numbers) > 12 else [])])
    return (f"{what} are numbered {told} instead of 1, 2, 3, ...; they are taken in this order",)


def _segment(number: int, raw: Any) -> tuple[Segment, list[str]]:
    if isinstance(raw, Mapping):
        missing = [name for name in REQUIRED if name not in raw]
        if missing:
            raise UsageError(f"segment {number} cannot be read: {missing[0]}: {_advice('missing', {})}")
        no_truths(f"segment {number}", raw)
    try:
        segment = Segment.model_validate(raw)
    except ValidationError as error:
        raise UsageError(f"segment {number} cannot be read: {first_error(error)}") from error
    remarks = []
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


def no_truths(what: str, data: Mapping[str, Any]) -> None:
    """Raises UsageError if a value, or an entry of a list, is a Boolean; the message names ``what``."""
    for name, value in data.items():
        values = value if isinstance(value, (list, tuple)) else (value,)
        if any(isinstance(each, bool) for each in values):
            raise UsageError(f"{what} cannot be read: {str(name)[:40]}: {_advice('float_type', {})}")


def first_error(error: ValidationError) -> str:
    """Returns the first error that pydantic found, as the text 'field: what to do'."""
    problem = error.errors()[0]
    place = ".".join(str(part) for part in problem["loc"])
    said = _advice(problem["type"], problem.get("ctx", {})) or str(problem["msg"])
    return f"{place}: {said}" if place else said


def _advice(kind: str, bounds: Mapping[str, Any]) -> str | None:
    """Returns what to do about an error that pydantic found; None if pydantic's own message will do."""
    known = {
        "missing": "is missing; add it",
        "extra_forbidden": "is not a field of a design; remove it",
        "finite_number": "is not finite; give a finite number",
        "float_type": "is not a number; give one",
        "float_parsing": "is not a number; give one",
        "less_than": f"is out of range; give less than {bounds.get('lt', 0):g}",
        "greater_than": f"is out of range; give more than {bounds.get('gt', 0):g}",
        "int_from_float": "is not a whole number; give one",
        "model_type": "give an object with distance, direction, incline, turn_degrees",
    }
    limits = {"greater_than_equal": ("ge", "or more"), "less_than_equal": ("le", "or less")}
    if kind in limits:
        name, which = limits[kind]
        return f"is out of range; give {bounds[name]:g} {which}"
    if kind == "literal_error":
        return f"is unknown; give {bounds['expected']}"
    return known.get(kind)
