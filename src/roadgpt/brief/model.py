"""The Brief: the requirements for a road that were read from a description, as data.

Numbers in a Brief are in everyday units (degrees, metres and percent), so that people can write Briefs."""

import re
from typing import Annotated, Any, Self, cast

from pydantic import AfterValidator, Field, model_validator

from roadgpt.brief.amount import Amount, Frozen, at_least, at_most, between, exactly, span
from roadgpt.brief.beside import BESIDE, friction_of
from roadgpt.brief.design_speed import FASTEST, SLOWEST, USUAL
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause, MapClause
from roadgpt.brief.ranges import Range, nearest
from roadgpt.brief.scene import Scene
from roadgpt.brief.words import LARGEST_MAP, MOST_LANES, SMALLEST_MAP
from roadgpt.language.names import Bump, CentreLine, Compass, Kind, Sharpness, Side, Size, Slope, Surroundings

__all__ = [
    "OTHER_SIDE",
    "Amount",
    "Brief",
    "Clause",
    "Frozen",
    "JunctionClause",
    "Kind",
    "Sharpness",
    "Side",
    "Size",
    "Slope",
    "at_least",
    "at_most",
    "between",
    "exactly",
    "span",
]

OTHER_SIDE: dict[Side, Side] = {"left": "right", "right": "left"}
SIDE = re.compile("left(?!_hand)|right")
OTHER_POLE = {"north": "south", "south": "north"}
UPSIDE_DOWN = re.compile("north|south")
OF_THE_WORDS = (
    "words", "beside", "unused", "confidence", "rounds", "other", "map_size", "lane_width", "limit", "scene",
)  # fmt: skip
"""The fields of a Brief that require nothing of the shape of a road."""


def _known(name: str) -> str:
    if name not in BESIDE:
        raise ValueError(f"'{name[:40]}' is none of the things beside a road: {', '.join(sorted(BESIDE))}")
    return name


Beside = Annotated[str, AfterValidator(_known)]


class Clause(Frozen):
    """One feature along the road, or several features of the same kind in a row."""

    kind: Kind
    count: Amount = Amount(lo=1, hi=1)
    """The number of features of this kind in a row. For a serpentine, zigzag, slalom, winding road or
    switchback with a number ("4 switchbacks"), ``count`` is the number of turns. An s_bend or a chicane
    counts as one feature ("two S-bends" is 2)."""
    side: Side | None = None
    """The direction of every turn; if the turns alternate, the direction of the first turn."""
    alternating: bool = False
    sharpness: Sharpness | None = None
    degrees: Amount | None = None
    """The change of heading of each turn in degrees, always positive."""
    radius: Amount | None = None
    """The radius of each turn in metres."""
    length: Amount | None = None
    """The length in metres of each straight, or of each turn along its curve."""
    size: Size | None = None
    """The size of a straight if the description gives a word instead of a number: "a long straight"."""
    slope: Slope | None = None
    bump: Bump | None = None
    """A crest or a dip inside each turn. ``incline`` is then the grade of both its slopes, ``climb`` its
    height or depth, and there is no ``slope``."""
    incline: Amount | None = None
    """The grade in percent, always positive; ``slope`` says whether it is up or down."""
    climb: Amount | None = None
    """How many metres each feature rises or falls from its start to its end, always positive; ``slope`` says
    whether it is up or down. For a crest or a dip, ``climb`` is the height or the depth."""


class Brief(Frozen):
    """A description and the requirements that were read from it.

    ``clauses`` are in driving order. If any clause is a turn, the clauses name *all* turns of the road. The
    other fields are requirements for the road as a whole, which hold in addition to the clauses."""

    words: str = ""
    clauses: tuple[Clause, ...] = ()
    turns: Amount | None = None
    left: Amount | None = None
    right: Amount | None = None
    alternating: bool = False
    sharpness: Sharpness | None = None
    """How tight every turn must be: "gentle", "sweeping" or "sharp"."""
    degrees: Amount | None = None
    """The change of heading of every turn in degrees."""
    radius: Amount | None = None
    """The radius of every turn in metres."""
    turning: Amount | None = None
    """The sum of the absolute turning angles of all turns in degrees."""
    slope: Slope | None = None
    """The slope of the whole road."""
    incline: Amount | None = None
    """The grade of the whole road in percent, always positive; ``slope`` says whether it is up or down."""
    steepest: Amount | None = None
    """The absolute value of the grade at the steepest place, in percent."""
    climb: Amount | None = None
    """The height of the end above the start in metres, negative if the road falls."""
    hills: Amount | None = None
    """The number of changes between climbing and falling."""
    length: Amount | None = None
    """The length of the whole road in metres."""
    starts: Clause | None = None
    """The first feature, if the clauses do not already name it."""
    ends: Clause | None = None
    """The last feature, if the clauses do not already name it."""
    motorway: bool = False
    """True if the description asks for a motorway; see ``brief.map_fit``."""
    alike: bool = False
    """True if turns of one kind must have the same angle and radius, and straights the same length. Turns and
    straights with different numbers of their own are excepted. If the clauses name no straights between the
    turns, all straights between the turns must have the same length."""
    hard: bool = False
    """True if the road should be difficult for a lane keeper: tight turns, fast approaches, crests."""
    beside: tuple[Beside, ...] = ()
    """Names of things that the description mentions and that no requirement expresses, such as 'roundabout';
    ``brief.beside`` says what becomes of each."""
    unused: tuple[str, ...] = ()
    """The words of the description that the reading does not depend on."""
    confidence: Annotated[float, Field(ge=0, le=1)] = 1.0
    junctions: tuple[JunctionClause, ...] = ()
    """The junctions that the route passes, in driving order. If there are any, ``stretches`` has the
    requirements for the roads; of the fields above, only ``words``, ``length``, ``beside``, ``unused`` and
    ``confidence`` are then used, for the whole route."""
    stretches: "tuple[Brief, ...]" = ()
    """The requirements for the roads before, between and after the junctions: one more than junctions."""
    lanes: Amount | None = None
    """The number of lanes in the direction of the drive."""
    against: Amount | None = None
    """The number of oncoming lanes; 0 for a one-way road."""
    divided: bool = False
    """Whether a median separates the directions."""
    centre: CentreLine | None = None
    """The line between the directions: "solid" forbids overtaking."""
    left_hand: bool = False
    """Whether traffic drives on the left."""
    map_size: Annotated[float, Field(ge=SMALLEST_MAP, le=LARGEST_MAP)] | None = None
    """The side of the square map in metres; None if the description does not give it."""
    lane_width: Annotated[float, Field(ge=2, le=10)] | None = None
    """The width of every lane in metres, of a whole route; None: that of the World."""
    limit: Annotated[float, Field(ge=5, le=300)] | None = None
    """The speed limit in km/h, of a whole route; None: that of the World."""
    map: MapClause | None = None
    """The map of roads that is required instead of one road. A plan then gives no other requirements than
    ``length``, ``left_hand``, ``map_size`` and ``beside``."""
    comes_from: Compass | None = None
    """The direction from which one comes at the start; the map has north at the top. Not for maps of roads.
    """
    surroundings: Surroundings | None = None
    """What kind of road it is, other than a motorway; it sets the usual design speed."""
    speed: Annotated[float, Field(ge=SLOWEST, le=FASTEST)] | None = None
    """The design speed in km/h: see ``brief.design_speed``. Without a number, it is the usual one of
    ``surroundings``; that of a route holds for its roads without one."""
    scene: Scene = Scene()
    """Who else is on the road, and under which conditions; of a whole route, not of its roads."""
    rounds: tuple[str, ...] = ()
    """Why a language model was asked again, and once more, for another plan."""
    other: str = ""
    """The plan of the second likeliest reading, if the reader is not sure of this Brief; otherwise empty."""

    @model_validator(mode="before")
    @classmethod
    def _with_usual_speed(cls, fields: Any) -> Any:
        usual = USUAL.get(str(fields.get("surroundings"))) if isinstance(fields, dict) else None
        return fields if usual is None or fields.get("speed") else {**fields, "speed": usual}

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.junctions and len(self.stretches) != len(self.junctions) + 1:
            count = len(self.junctions)
            given = len(self.stretches)
            raise ValueError(
                f"{count} junctions divide a route into {count + 1} roads, and {given} are given"
            )
        if any(stretch.junctions for stretch in self.stretches) or (self.stretches and not self.junctions):
            raise ValueError("only a route with junctions has stretches, which have no junctions themselves")
        if any(stretch.map is not None for stretch in self.stretches):
            raise ValueError("a map is no part of a route; ask for one of them")
        if any(stretch.left_hand for stretch in self.stretches):
            raise ValueError("traffic drives on one side on the whole route; write left_hand after ||")
        if any(stretch.map_size for stretch in self.stretches):
            raise ValueError("a route lies on one map; write map_size= after ||")
        if any(stretch.lane_width or stretch.limit for stretch in self.stretches):
            raise ValueError("the lanes of a route have one width, and one limit; write them after ||")
        if any(stretch.scene != Scene() for stretch in self.stretches):
            raise ValueError("a scene is that of the whole route, not of one of its roads")
        if any(stretch.comes_from for stretch in self.stretches):
            raise ValueError("a route comes from one direction at its start; write from= after ||")
        if self.map is not None and (self.comes_from or self.speed):
            raise ValueError("a map of roads has no from=, no speed= and no kind of road; leave them out")
        if self.motorway and self.surroundings:
            raise ValueError(f"a road is of one kind, not motorway and {self.surroundings}; leave one out")
        return self

    @property
    def is_open(self) -> bool:
        """Whether nothing is required of the road."""
        return self._requires_only(OF_THE_WORDS)

    def _requires_only(self, names: tuple[str, ...]) -> bool:
        fields = Brief.model_fields.items()
        return all(name in names or getattr(self, name) == field.default for name, field in fields)

    @property
    def lanes_text(self) -> str | None:
        """The numbers of lanes along and against the drive, such as "2+1"; None if neither is required.

        A direction without a requirement gets one lane. On a motorway, the direction against the drive then
        gets no lane, because a motorway is built as one carriageway."""
        if self.lanes is None and self.against is None:
            return None
        most = Range(1, MOST_LANES), Range(0, MOST_LANES)
        usual = 1, 0 if self.motorway else 1
        sides = [
            usual[n] if amount is None else round(nearest(usual[n], span(amount), most[n]))
            for n, amount in enumerate((self.lanes, self.against))
        ]
        return f"{sides[0]}+{sides[1]}"

    @property
    def is_of_network(self) -> bool:
        """Whether a road network is required: for junctions, a map, a median, or traffic on the left."""
        return bool(self.junctions or self.map is not None or self.divided or self.left_hand)

    @property
    def roads(self) -> "tuple[Brief, ...]":
        """The requirements for each road before, between and after the junctions.

        Without junctions, there is one road; it needs at least one turn if neither clauses nor a number of
        turns are given."""
        if self.stretches:
            own = ({"speed": road.speed or self.speed} for road in self.stretches)
            return tuple(
                road.model_copy(update=speed) for road, speed in zip(self.stretches, own, strict=True)
            )
        needs_turn = not self.clauses and self.turns is None
        return (self.model_copy(update={"turns": at_least(1)}) if needs_turn else self,)

    @property
    def both_ends(self) -> tuple[Clause, ...]:
        """``starts`` and ``ends``, without fields that are None."""
        return tuple(end for end in (self.starts, self.ends) if end is not None)

    @property
    def has_free_shape(self) -> bool:
        """Whether nothing is required of the road but lanes, markings, a speed, or its kind."""
        free = ("lanes", "against", "divided", "centre", "motorway", "surroundings", "speed")
        return self._requires_only((*OF_THE_WORDS, *free))

    @property
    def is_straight_of_any_length(self) -> bool:
        """Whether the road must have no turns, and is otherwise of free shape (see ``has_free_shape``)."""
        return self.turns == exactly(0) and self.model_copy(update={"turns": None}).has_free_shape

    @property
    def as_stretch(self) -> "Brief":
        """The requirements for a road between junctions: it needs no turn unless turns are asked for."""
        if self.clauses or self.turns is not None:
            return self
        return self.model_copy(update={"turns": at_least(0)})

    @property
    def friction(self) -> float | None:
        """The friction coefficient of the slipperiest surface in ``beside``; None if there is no surface."""
        return friction_of((*self.beside, *self.scene.surfaces))


def is_one_road(place: JunctionClause) -> bool:
    """Returns whether the roads before and behind a place are one road, whose lanes may change there."""
    return place.kind in LANE_KINDS or (place.kind in RAMPS and place.take == "main")


def motorways_continued(brief: Brief) -> list[Brief]:
    """Returns the requirements for the roads of a route. A motorway stays a motorway past its ramps and where
    only its lanes change."""
    roads = list(brief.stretches)
    one_road = [n for n, place in enumerate(brief.junctions) if is_one_road(place)]
    for n in (*one_road, *reversed(one_road)):
        if roads[n].motorway or roads[n + 1].motorway:
            roads[n : n + 2] = [road.model_copy(update={"motorway": True}) for road in roads[n : n + 2]]
    return roads


LEAST_BEFORE_CHANGE = 12.0  # m, least length of a road before or behind a place where lanes change


def rest_of_route(brief: Brief, number: int) -> float:
    """Returns how many metres of the required length of a route are left for the only road without a length,
    which is the last one and lies behind place ``number``; 0 if there is no such length, or no such road."""
    *roads, last = brief.stretches
    if brief.length is None or last.length or last.clauses or number < len(roads) - 1:
        return 0.0
    lengths = [span(road.length).lo for road in roads if road.length]
    return max(span(brief.length).lo - sum(lengths), 0.0) if len(lengths) == len(roads) else 0.0


def counts_to_change(brief: Brief, number: int) -> bool:
    """Returns whether the required length of the road before a lane change, place ``number``, counts to the
    middle of the road behind, where the car changes lanes. It does if no length is required of the road
    behind, or if that length is the distance to the next lane change; but not if the whole route is so long
    that the middle of the road behind lies farther ahead."""
    if brief.stretches[number + 1].length is None:
        before, rest = span(brief.stretches[number].length), rest_of_route(brief, number)
        return not rest or rest <= before.lo - LEAST_BEFORE_CHANGE
    following = brief.junctions[number + 1 : number + 2]
    is_next = any(place.kind == "lane_change" for place in following)
    return is_next and not brief.stretches[number + 2].clauses and counts_to_change(brief, number + 1)


def mirrored(brief: Brief) -> Brief:
    """Returns the same requirements with left and right, and north and south, exchanged, and with traffic on
    the other side. A route with traffic on the left meets a Brief exactly if its mirror image, at a line from
    west to east, meets the mirrored Brief.

    The numbers of exits stay, because exits are counted in the direction in which traffic drives around a
    roundabout. ``map`` and ``scene`` also stay as they are."""
    names = {"clauses", "starts", "ends", "left", "right", "junctions", "stretches"}
    other = {**brief.model_dump(exclude=names), **_with_other_sides(brief.model_dump(include=names))}
    start = brief.comes_from and UPSIDE_DOWN.sub(lambda way: OTHER_POLE[way[0]], brief.comes_from)
    return Brief.model_validate({**other, "left_hand": not brief.left_hand, "comes_from": start})


def mirrored_scene(scene: Scene) -> Scene:
    """Returns the scene with left and right exchanged, as it is for traffic on the other side."""
    other = Scene.model_validate(_with_other_sides(scene.model_dump()))
    actors = [
        each.model_copy(update={"offset": each.offset and each.offset.times(-1)}) for each in other.actors
    ]
    return other.model_copy(
        update={"actors": tuple(actors), "offset": other.offset and other.offset.times(-1)}
    )


def _with_other_sides(value: Any) -> Any:
    """Exchanges left and right in all keys and texts of a value."""
    if isinstance(value, dict):
        return {_with_other_sides(key): _with_other_sides(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return tuple(map(_with_other_sides, value))
    return SIDE.sub(lambda side: OTHER_SIDE[cast(Side, side[0])], value) if isinstance(value, str) else value
