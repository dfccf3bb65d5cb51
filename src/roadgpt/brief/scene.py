"""Defines the Scene: who else is on the road, what they do, and under which conditions.

It is told in the terms of OpenSCENARIO: somebody is somewhere at first, and then does one thing after
another, each begun by a condition. A number may be a range, from which each drive draws."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, inf
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import AfterValidator, StringConstraints, model_validator

from roadgpt.brief.amount import Amount, Frozen, exactly, span
from roadgpt.brief.words import MOST_LANES, LandKind
from roadgpt.language.names import (
    ActorKind,
    Face,
    Flow,
    Landform,
    Light,
    Shown,
    Side,
    Surface,
    WeatherKind,
    What,
    Where,
    Works,
)
from roadgpt.language.table import (
    CUES,
    FLOWS,
    LANDFORMS,
    LIGHTS,
    MANEUVERS,
    MOVING,
    NUMBERS,
    OF_ITSELF,
    PLACES,
    ROADWORKS,
    SCENES,
    SIZES,
    SURFACES,
    WEATHER,
    one_of,
    several_of,
)

Clock = Annotated[str, StringConstraints(pattern=r"^([01][0-9]|2[0-3]):[0-5][0-9]$")]
Person = Literal["robot", "test_robot"]
Lie = Literal["along", "across", "through"]
LAND_KINDS: tuple[LandKind, ...] = get_args(LandKind)
LEAVES = ("cut_out", "change_lane")
ACCELERATES = {"decel", "accel", "lateral"}  # numbers with which a scene prescribes an acceleration
HEAD_ON: tuple[What, ...] = ("drift", "wrong_way", "overtake")
"""What leads who comes towards the tested car into its lane."""
ON_ITS_WAY: tuple[What, ...] = ("merge", "turn_in", "turn_across", "cross", "run_light", "run_sign")
"""What somebody does on a way of its own, on which it is from the begin on."""
AROUND: tuple[What, ...] = ("overtake", "pass")
"""What leads the tested car around somebody."""
FROM_BEHIND = 30.0  # m, who comes from behind a tested car that stands, where nothing is said
MOST_BEHIND = 200.0  # m of road for more of them
SPARE = 10.0  # m of road behind whoever is last
MOST_MORE = 3
"""How many more of a kind there are at most where a scene says "2 or more"."""
CAR, SIGNALS = "tested car", "lights"
"""Whose events are not those of an actor."""
NEVER, LATE, ENDED = "it never happened that", "the tested car had passed before", "the drive ended before"
LANES_AWAY = {"lane": 1, "far": 2}
LEADS_BACK = 15.24  # m, on which the cones of roadworks lead back: 50 ft at least (MUTCD, table 6C-3)
NARROW = 1.2  # m, the width of what has no doors
MIRROR = "mirror"
STRUCK: tuple[str, ...] = (*get_args(Face), MIRROR)
"""What of the tested car can be hit."""
ONE_OF = (
    ("gap", "headway", "lead", "station"),
    ("headway", "lead", "station", "at"),
    ("speed", "faster"),
    ("overlap", "impact", "offset"),
    CUES,  # of actions only
)


class Mark(Frozen):
    """A part of the route, as in "after turn 1", or what somebody else does: its end, as in "after truck 1
    brake" or "after ego stop", or its begin, as in "with truck 1 brake"."""

    word: Literal["after", "before", "in", "with"]
    of: Literal["turn", "junction", "crosswalk", "ego"] | ActorKind
    number: int
    """Counted apart, from 1; -1 is the last turn, junction or crosswalk."""
    what: What | None = None

    def __str__(self) -> str:
        number = "" if self.of == "ego" else str(self.number)
        return " ".join(filter(None, [self.word, self.of, number, self.what]))

    @property
    def said(self) -> str:
        """The condition in words."""
        if self.what is None:
            return f"{self.word} the last {self.of}" if self.number < 0 else str(self)
        who = "the tested car" if self.of == "ego" else f"{self.of.replace('_', ' ')} {self.number}"
        said = f"{who} {MANEUVERS[self.what].said}"
        return f"{'when' if self.word == 'with' else self.word} {said}"


class Action(Frozen):
    """Something that somebody does. Without one of the CUES, it begins when the one before it has ended."""

    what: What
    whom: Annotated[str, StringConstraints(pattern=r"^[a-z_]+ [1-9][0-9]?$")] | None = None
    """Whom the tested car overtakes or passes, such as "car 1"; actors of each kind are counted apart."""
    side: Side | None = None
    decel: Amount | None = None
    to: Amount | None = None
    lateral: Amount | None = None
    shift: Amount | None = None
    accel: Amount | None = None
    duration: Amount | None = None
    time: Amount | None = None
    distance: Amount | None = None
    ttc: Amount | None = None
    headway: Amount | None = None
    gap: Amount | None = None
    station: Amount | None = None
    at: Mark | None = None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        doing = MANEUVERS[self.what]
        for field in _given(self, self.what):
            if field in NUMBERS and field not in (*doing.numbers, *CUES):
                raise ValueError(f"'{self.what}' has no {NUMBERS[field].key}=; leave it out")
        if self.side and not doing.side:
            raise ValueError(f"'{self.what}' has no side; leave '{self.side}' out")
        return self

    @property
    def marks(self) -> tuple[Mark, ...]:
        """The part of the route, or what somebody else does, that says when it begins, if one does."""
        return (self.at,) if self.at else ()

    def __str__(self) -> str:
        side = [f"{'on' if self.what == 'pass' else 'to'} the {self.side}"] if self.side else []
        whom = [self.whom.replace("_", " ")] if self.whom else []
        return " ".join([MANEUVERS[self.what].said, *whom, *side, *_said(self)])


class Role(Frozen):
    """Somebody or something on the road besides the tested car, or several alike."""

    kind: ActorKind
    count: Amount = exactly(1)
    where: Where
    """Where it is at first, seen from the tested car."""
    side: Side | Literal["opposite"] | None = None
    gap: Amount | None = None
    """The distance along the lanes, bumper to bumper; of who is beside a part of the route, or crosses there,
    that from its end to the box, or to the path across."""
    headway: Amount | None = None
    lead: Amount | None = None
    """The distance along the lanes from the middle of the tested car to its middle."""
    station: Amount | None = None
    speed: Amount | None = None
    faster: Amount | None = None
    overlap: Amount | None = None
    """The share of the tested car's width that its box covers, seen along the lane."""
    impact: Amount | None = None
    """Where on the tested car's width its middle arrives if nobody reacts, counted from the side that it
    comes from, or else from the kerb. Beyond 0 to 100, one touches the side of the other, or passes."""
    offset: Amount | None = None
    away: Amount | None = None
    angle: Amount | None = None
    """Between the lane and a parking bay from which it turns in, or reverses."""
    hits: str | None = None
    """Which face of the tested car it hits, or its "mirror", if that does not react: ``impact`` percent along
    the face; or whom else it hits, such as "van 1". Where it is and when it acts are found for that."""
    at: Mark | None = None
    actions: tuple[Action, ...] = ()

    @model_validator(mode="after")
    def _fits(self) -> Self:
        one, spot = one_of(self.kind), PLACES[self.where]
        first = self.actions[0] if self.actions else Action(what="keep")
        if self.kind not in spot.who:
            raise ValueError(f"{one} cannot be {spot.said}; give another place")
        if self.side and (not spot.side or (self.side == "opposite" and self.where != "junction")):
            raise ValueError(f"'{self.where}' has no side '{self.side}'; leave it out")
        if not {self.count.lo, self.count.hi} <= {None, *range(1, 51)}:
            raise ValueError(f"1 to 50 of a kind can be in one place, not {self.count}")
        for field in _given(self, one):
            is_on_face = field == "impact" and self.hits
            if field in NUMBERS and self.where not in NUMBERS[field].where and not is_on_face:
                raise ValueError(f"who is {spot.said} has no {NUMBERS[field].key}=; leave it out")
        if self.gap and self.at and (self.where not in ("crossing", "beside") or self.at.word == "in"):
            raise ValueError(f"{one} has 'gap' and '{self.at}'; give one of them")
        if self.angle and {"turn_in", "reverse"}.isdisjoint(each.what for each in self.actions):
            raise ValueError(f"{one} in a bay with an angle= pulls out of it: turn_in, or reverse")
        if self.gap and self.where == "crossing" and not self.at:
            raise ValueError("who is crossing has no gap= but to a place; write before or after junction 1")
        if self.at and self.at.what:
            raise ValueError(
                f"'{self.at}' is no place where {one} can be at first; write for example after turn 1"
            )
        is_still = self.kind not in MOVING or self.where == "parked"
        if is_still and (self.speed or self.faster) not in (None, exactly(0)):
            raise ValueError(f"{one} {'parked ' * (self.kind in MOVING)}stands; leave its speed out")
        for action in self.actions:
            if self.kind not in MANEUVERS[action.what].who:
                raise ValueError(f"{one} has no '{action.what}'; leave it out")
            if action.whom:
                raise ValueError(f"only the tested car can {action.what} '{action.whom}'; leave that out")
            what, starts = action.what, MANEUVERS[action.what].starts
            if self.where not in starts and (action is first or what in ON_ITS_WAY):
                raise ValueError(f"who is {spot.said} cannot {what}; that begins from: {', '.join(starts)}")
        if first.what == "brake" and span(first.to).lo > span(self.speed).hi:
            raise ValueError(f"{one} cannot brake from {self.speed} to {first.to} km/h")
        return self

    @model_validator(mode="after")
    def _hits_one(self) -> Self:
        if any(each.what == "open_door" for each in self.actions) and SIZES[self.kind].width < NARROW:
            raise ValueError(f"{one_of(self.kind)} has no door to open; leave it out")
        if self.hits and self.count != exactly(1):
            raise ValueError(f"one hits the {self.hits}, not {self.count}; write an actor for each")
        if self.hits and self.impact:
            ends = span(self.impact)
            if self.hits not in get_args(Face) or ends.lo < 0 or ends.hi > 100:
                raise ValueError(f"impact={self.impact} is no share of the {self.hits}; leave it out")
        return self

    @property
    def marks(self) -> tuple[Mark, ...]:
        """The parts of the route, and what others do, that say where it is and when it acts."""
        own = (self.at,) if self.at else ()
        return (*own, *(mark for each in self.actions for mark in each.marks))

    @property
    def goes(self) -> What:
        """How it goes through a junction: as its turn says, else straight on, across it."""
        whats = [each.what for each in self.actions]
        if self.where == "oncoming" and "turn_off" in whats:
            return "turn_across"
        return next((each for each in ("turn_across", "turn_in", "merge") if each in whats), "cross")

    def __str__(self) -> str:
        spot = PLACES[self.where]
        side = f" {spot.side} {self.side}{' side' * (self.side == 'opposite')}" if self.side else ""
        is_one = self.count == exactly(1)
        some = one_of(self.kind) if is_one else f"{self.count} {several_of(self.kind)}"
        of = "the tested car's " if self.hits in STRUCK else ""
        hit = [f"to hit {of}{(self.hits or '').replace('_', ' ')}"] if self.hits else []
        said = ", ".join([f"{some} {spot.said}{side}", *_said(self), *hit])
        who = "that" if is_one else "each of which"
        return f"{said}, {who} {', then '.join(map(str, self.actions))}" if self.actions else said


class Signal(Frozen):
    """What the first traffic lights on the way of the tested car show to it."""

    shows: Shown
    time: Amount | None = None
    """From when on; None: for some seconds when the car comes there at its first speed, red and green since
    before, yellow from then on."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _given(self, "lights")
        return self

    def __str__(self) -> str:
        if self.time is None:
            return f"the traffic lights are {self.shows} when the tested car comes"
        return " ".join([f"the traffic lights turn {self.shows}", *_said(self)])


class SlipperyPlace(Frozen):
    """A stretch of the tested car's road with a friction of its own."""

    friction: Amount = exactly(0.3)
    station: Amount
    length: Amount = exactly(10)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _given(self, "slippery")
        return self

    def __str__(self) -> str:
        return " ".join(["a slippery place", *_said(self)])


class Roadworks(Frozen):
    """Roadworks in or beside a lane of the road, with cones. ``shift`` is how many metres they take."""

    kind: Works = "narrowed"
    side: Side | None = None
    station: Amount | None = None
    """Where the cones begin, of which ``length`` metres are no taper; None: 4 s from the tested car."""
    length: Amount = exactly(50)
    shift: Amount | None = None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _given(self, "roadworks")
        return self

    def __str__(self) -> str:
        side = [f"on the {self.side}"] if self.side else []
        return " ".join([ROADWORKS[self.kind].said, *side, *_said(self)])

    def stations(self, first: float, length: float, aside: float, limit: float) -> list[float]:
        """Returns where the cones that lead so far aside begin, have done so, lead back, and end, in metres;
        ``limit`` is in m/s."""
        kmh = limit * 3.6  # 40 mph is 64.4
        taper = ROADWORKS[self.kind].taper * aside * (kmh**2 / 155 if kmh < 65.0 else kmh / 1.609)
        return [first, first + taper, first + taper + length, first + taper + length + LEADS_BACK]


class Land(Frozen):
    """Something of the landscape that the road lies in, or several alike."""

    kind: Landform
    lie: Lie | None = None
    """How the road leads: along it, across it or through it."""
    side: Side | None = None
    count: Amount = exactly(1)
    length: Amount | None = None
    away: Amount | None = None
    """Metres from the road to the shore, or to the crest of a ridge beside it."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _given(self, self.kind)
        is_beside = LANDFORMS[self.kind].away and self.lie not in ("across", "through") and not self.is_crest
        if self.away and not is_beside:
            raise ValueError(f"'{self.kind}' has no away= here; leave it out")
        if not span(self.count).lo >= 1:
            raise ValueError(f"a landscape has one {self.kind} or more, not {self.count}; leave it out")
        if LANDFORMS[self.kind].structure and (self.lie or self.side):
            raise ValueError(f"'{self.kind}' has no {self.lie or self.side}; leave it out")
        return self

    @property
    def is_crest(self) -> bool:
        """Whether the road leads along the crest of a ridge, not beside it."""
        return self.kind == "ridge" and self.lie == "along" and self.side is None

    def __str__(self) -> str:
        row = LANDFORMS[self.kind]
        if row.said:
            return row.said
        some = f"{row.article} {self.kind}" if self.count == exactly(1) else f"{self.count} {self.kind}s"
        if self.is_crest:
            return f"along the crest of {some}"
        lie = {"along": "along the road", "across": "to cross", "through": "to go through"}.get(
            self.lie or ""
        )
        side = f"on the {self.side}" if self.side else ""
        long = f"{self.length} metres long" if self.length else ""
        away = f"{self.away} metres away" if self.away else ""
        return " ".join(filter(None, [some, lie, side, long, away]))


class Air(Frozen):
    """What falls or floats, such as rain."""

    kind: WeatherKind
    amount: Amount
    """The visual range in metres, or how much falls in mm/h."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        row = WEATHER[self.kind]
        _check_ends(self.kind, self.amount, row.least, row.most, "a scene")
        return self

    def __str__(self) -> str:
        return WEATHER[self.kind].said.format(self.amount)


class Scene(Frozen):
    """The others on the road, the conditions of a drive, and the landscape."""

    speed: Amount | None = None
    """The speed of the tested car at its start in km/h, which it keeps where nothing slows it down."""
    lane: int | None = None
    """The lane in which the tested car starts, of those of its direction: 1 is the one at the kerb, -1 the
    innermost one."""
    offset: Amount | None = None
    """Where the tested car starts, in metres to the left of the middle of that lane, and keeps to until it
    pulls out."""
    station: Amount | None = None
    """Where the tested car starts, in metres from the start of the road; None: at its first metres, or, if it
    stands, so far that who comes from behind is on the road."""
    parks: Side | None = None
    """The side of the road on which the tested car is parked at first, beside the lanes."""
    turn: Literal["left", "right", "straight"] | None = None
    """The way that the tested car takes at the first junction; None: that of the route."""
    person: Person | None = None
    """Who is at the wheel where a driver hands over; None: whom the driver chooses. In a test of the
    ``test_robot``, as in the catalogue, it drives until the event begins, and the drive ends behind that."""
    signal: Signal | None = None
    actions: tuple[Action, ...] = ()
    """What the tested car is made to do (``roadgpt.drive.script_hand``). Its gaps are those to who is
    ahead in its lane."""
    actors: tuple[Role, ...] = ()
    flow: Flow | None = None
    """How many vehicles drive in the lanes of the map: 5, 12 or 25 for each km and lane; None: nobody."""
    oncoming: Flow | Literal["none"] | None = None
    """The same for the oncoming lanes; None: as ``flow``."""
    parked: Annotated[tuple[Side, ...], AfterValidator(lambda sides: tuple(sorted({*sides})))] = ()
    """The sides on which cars are parked in a row."""
    angle: Amount | None = None
    """Between the lane and the cars of these rows; None: along the lane."""
    weather: tuple[Air, ...] = ()
    """What falls or floats, each kind once, in the order of the table."""
    clock: Clock | None = None
    """The local time as HH:MM. It says nothing about the light."""
    light: Light | None = None
    """Night, or a sun that is low ahead of the tested car at its start; None: day."""
    surface: Surface | None = None
    slippery: tuple[SlipperyPlace, ...] = ()
    roadworks: tuple[Roadworks, ...] = ()
    land: LandKind | None = None
    """How high the hills of the land are; None: as ``hills`` says."""
    landscape: tuple[Land, ...] = ()

    @model_validator(mode="before")
    @classmethod
    def _of_older_records(cls, data: Any) -> Any:
        """Reads scenes with a field for each kind of weather, as ``told`` has it and older records do."""
        if not isinstance(data, dict) or not any(data.get(kind) for kind in WEATHER):
            return data
        air = [{"kind": kind, "amount": data[kind]} for kind in WEATHER if data.get(kind)]
        return {name: value for name, value in data.items() if name not in WEATHER} | {"weather": air}

    @model_validator(mode="after")
    def _fits(self) -> Self:
        _given(self, "a scene")
        kinds = [each.kind for each in self.weather]
        if kinds != [kind for kind in WEATHER if kind in kinds]:
            raise ValueError("a scene has each kind of weather once, in the order of the table")
        if self.lane is not None and not 1 <= abs(self.lane) <= MOST_LANES:
            raise ValueError(
                f"lanes count from 1 to {MOST_LANES} from the kerb, or from -1 from the innermost one, and"
                f" there is no lane {self.lane}; write for example lane=1"
            )
        self._check_actions()
        for who, actions in ((None, self.actions), *((role, role.actions) for role in self.actors)):
            for event in (action.at for action in actions if action.at and action.at.what):
                if event.of == "ego":
                    if who is None or event.what not in [each.what for each in self.actions]:
                        raise ValueError(f"'{event}' needs a tested car that is told to '{event.what}'")
                    continue
                same = [each for each in self.actors if each.kind == event.of][event.number - 1 :][:1]
                if not same or same[0] is who or event.what not in [each.what for each in same[0].actions]:
                    raise ValueError(f"'{event}' needs another {event.of} that does '{event.what}'; name one")
        return self

    def _check_actions(self) -> None:
        """Raises ValueError if the tested car cannot do what it is told, one thing after another."""
        if self.parks and (self.offset or not self.actions or span(self.speed or exactly(0)).hi > 0):
            asks = "leave its t= and its speed out" if self.actions else "say how long: wait 30, or pull_out"
            raise ValueError(f"the tested car is parked; {asks}")
        first = next((each.what for each in self.actions if each.what != "wait"), "pull_out")
        if self.parks and first not in ("pull_out", "release"):
            raise ValueError(f"the tested car is parked; it waits, and pulls out before it can {first}")
        for action in self.actions[:1] if self.stands else ():
            if action.station or action.distance or (action.at and not action.at.what):
                raise ValueError(
                    f"the tested car stands until it {action}, and so never comes there; give time=, or what "
                    "somebody else does"
                )
        if self.runs_light and self.signal and self.signal.shows == "green" and self.signal.time is None:
            raise ValueError("the tested car runs a red light, and lights are green; leave one of them out")
        for one, two in pairwise(self.actions):
            for name in ("station", "distance", "time"):
                first, then = getattr(one, name), getattr(two, name)
                if first and then and span(then).hi < span(first).lo:
                    raise ValueError(f"the tested car {two}, and before that it {one}; change their order")
        slows = self.actions[0] if self.actions and self.actions[0].what == "brake" else None
        if slows and slows.to and self.speed and span(slows.to).lo >= span(self.speed).hi > 0:
            raise ValueError(f"the tested car {slows}, and is no faster than that; write speed {slows.to}")
        for action in self.actions:
            if action.what not in OF_ITSELF:
                can = ", ".join(OF_ITSELF)
                raise ValueError(f"the tested car cannot be told to '{action.what}'; it can {can}")
            there = [f"{each.kind} {number}" for number, each in _counted(self.actors)]
            if action.whom and (action.whom not in there or action.what not in AROUND):
                raise ValueError(f"there is no '{action.whom}' to {action.what}; name one of the scene")
            follows = self.actions[self.actions.index(action) + 1 :][:1]
            is_open = bool(follows) and not {*CUES} & follows[0].model_fields_set
            if action.what in ("wait", "pull_over") and action.duration is None and is_open:
                raise ValueError(
                    f"the tested car {MANEUVERS[action.what].said} without end; write {action.what} 5, or "
                    "when what comes next begins"
                )
            if action.what == "u_turn" and follows:
                raise ValueError(
                    f"the drive ends when the tested car has turned round; leave {follows[0].what} out"
                )
            before = [each.what for each in self.actions[: self.actions.index(action)]]
            is_aside = self.offset or self.parks or "pull_over" in before
            if action.what == "pull_out" and not is_aside:
                raise ValueError("the tested car pulls out, and is in its lane; write ego parked right")

    @model_validator(mode="after")
    def _has_whom_it_names(self) -> Self:
        for role in self.actors:
            others = [f"{each.kind} {number}" for number, each in _counted(self.actors) if each is not role]
            if role.hits and role.hits not in (*STRUCK, *others):
                faces = ", ".join(STRUCK)
                raise ValueError(f"'{role}': name another one of the scene, or of the tested car {faces}")
        return self

    @property
    def marks(self) -> tuple[Mark, ...]:
        """The parts of the route, and what others do, that say where somebody is and when one acts."""
        own = (mark for each in self.actions for mark in each.marks)
        return (*own, *(mark for each in self.actors for mark in each.marks))

    @property
    def hills(self) -> LandKind:
        """How high the hills are: as said, or higher where there are valleys and ridges."""
        is_high = any(each.kind in ("valley", "ridge") for each in self.landscape)
        return self.land or ("hilly" if is_high else "rolling")

    @property
    def on_the_road(self) -> Self:
        """The same without the land beside the road."""
        return self.model_copy(update={"land": None, "landscape": ()})

    @property
    def has_flow(self) -> bool:
        """Whether vehicles drive in the lanes of the map."""
        return self.flow is not None or self.oncoming not in (None, "none")

    @property
    def has_script(self) -> bool:
        """Whether it tells the tested car what to do, where to keep to, or when its test begins."""
        return bool(self.actions) or self.offset is not None or self.is_test

    @property
    def is_test(self) -> bool:
        """Whether the test robot drives until the event begins, and the drive ends when that is over."""
        return self.person == "test_robot"

    @property
    def room_behind(self) -> float:
        """How many metres along the road a tested car starts that stands, so that those who come from behind
        are on the road, too; 0 if nobody does."""
        found = [0.0]
        for each in self.actors:
            comes = each.where == "behind"
            gap = span(each.gap or each.lead or exactly(FROM_BEHIND * comes))
            away = abs(gap.hi) if comes else -gap.lo
            if each.where in ("behind", "lane", "far", "parked") and 0.0 < away < inf:
                more = (span(each.count).hi - 1) * FROM_BEHIND
                found.append(away + SIZES[each.kind].length + min(more, MOST_BEHIND) + SPARE)
        return ceil(max(found) / 10.0) * 10.0

    @property
    def stands(self) -> bool:
        """Whether the tested car stands at first."""
        return bool(self.parks) or (self.speed is not None and span(self.speed).hi == 0)

    @property
    def stays(self) -> bool:
        """Whether the tested car stands at last, until all has happened."""
        return any(each.what in ("wait", "pull_over") and not each.duration for each in self.actions[-1:])

    @property
    def lights(self) -> Signal | None:
        """What the first traffic lights show: as told, or red where the tested car is to run a red light."""
        return self.signal or (Signal(shows="red") if self.runs_light else None)

    @property
    def runs_light(self) -> bool:
        """Whether the tested car is to run a red light."""
        return any(each.what == "run_light" for each in self.actions)

    @property
    def has_others(self) -> bool:
        """Whether somebody or something else is on the road, or lights run there."""
        return self.has_flow or bool(self.actors or self.parked or self.roadworks or self.lights)

    @property
    def lanes_beside(self) -> dict[str, int]:
        """How many lanes of its direction it needs to the left and to the right of the tested car's."""
        found, place = {"left": 0, "right": 0}, 0
        for action in self.actions:
            if action.what == "change_lane":
                place += -1 if action.side == "right" else 1
                found = {"left": max(found["left"], place), "right": max(found["right"], -place)}
        for role in self.actors:
            away = LANES_AWAY.get(role.where, 0)
            leave = [each.side for each in role.actions if each.what in LEAVES]
            needs = [(away, role.side)]
            if role.where in ("ahead", "behind"):
                needs += [(1, side) for side in leave]
            elif away and role.side in leave and all(each.what != "cut_in" for each in role.actions):
                needs += [(away + 1, role.side)]
            for count, side in needs:
                side = "right" if side == "right" else "left"
                found[side] = max(found[side], count)
        return found

    def lanes_in_and_out(self, left_hand: bool) -> tuple[int, int]:
        """Returns how many lanes of its direction it needs inside and outside of the tested car's."""
        left, right = self.lanes_beside.values()
        return (right, left) if left_hand else (left, right)

    def lanes_needed(self, left_hand: bool) -> int:
        """Returns how many lanes the scene needs in the direction of the tested car."""
        inner, outer = self.lanes_in_and_out(left_hand)
        if self.lane is None:
            return 1 + inner + outer
        return max(2, self.lane + inner if self.lane > 0 else outer - self.lane)

    def lane_driven(self, left_hand: bool) -> int | None:
        """Returns the lane in which the tested car starts, counted as ``lane``, where the scene says or needs
        one; None if it does not matter."""
        inner, outer = self.lanes_in_and_out(left_hand)
        return self.lane or (1 + outer if inner or outer else None)

    @property
    def surfaces(self) -> tuple[str, ...]:
        """What sets the friction: the surface that is named, or else what falls."""
        falls = tuple(each.kind for each in self.weather if WEATHER[each.kind].surface)
        return (self.surface,) if self.surface else falls

    @property
    def told(self) -> dict[str, Any]:
        """What it says, as data, with each kind of weather by itself; ``model_validate`` reads it back."""
        data = self.model_dump(exclude_defaults=True)
        airs = data.pop("weather", ())
        return data | {air["kind"]: air["amount"] for air in airs}

    def amount_of(self, kind: WeatherKind) -> Amount | None:
        """Returns how much there is of a kind of weather; None for none."""
        return next((each.amount for each in self.weather if each.kind == kind), None)

    def with_weather(self, kind: WeatherKind, amount: Amount | None) -> Self:
        """Returns the scene with so much of a kind of weather; None for none."""
        amounts = {each.kind: each.amount for each in self.weather} | {kind: amount}
        air = tuple(Air(kind=each, amount=found) for each in WEATHER if (found := amounts.get(each)))
        return self.model_copy(update={"weather": air})


@dataclass(frozen=True)
class Event:
    """Something that a scene prescribes, or that happened to the tested car."""

    who: str
    """Whose it is: the name of an actor, CAR or SIGNALS."""
    what: str
    """In words, such as "brakes with 6 m/s2 at a gap of 20 metres", with the numbers that were drawn."""
    time: float | None = None
    """When it began, in seconds since the start of the drive; None if it never happened."""
    s: float | None = None
    """The station along the tested car's road in metres where whoever did it was then; None if it was not
    there yet, and for lights."""
    until: float | None = None
    """When it had ended, in seconds; None if that was not seen."""
    why: str = ""
    """Why it never happened, or what ended it before its time."""


def _counted(roles: Sequence[Role]) -> Iterator[tuple[int, Role]]:
    """Yields roles with their numbers, from 1 for each kind."""
    count = Counter[str]()
    for role in roles:
        count[role.kind] += 1
        yield count[role.kind], role


def usual_weather(kind: WeatherKind) -> Air:
    """Returns a kind of weather without a number."""
    lo, hi = WEATHER[kind].usual
    return Air(kind=kind, amount=Amount(lo=lo, hi=hi))


def _given(thing: Frozen, name: str) -> list[str]:
    """Returns the names of the numbers and conditions that a thing has; raises ValueError if a number is out
    of bounds, or two of them exclude each other."""
    has = vars(thing)
    given = {each: has[each] for each in (*NUMBERS, "at") if has.get(each) is not None}
    for field, amount in given.items():
        if isinstance(amount, Amount):
            number = NUMBERS[field]
            _check_ends(number.key, amount, number.least, number.most, name)
    for fields in ONE_OF[:-1] if isinstance(thing, Role) else ONE_OF:
        both = [
            NUMBERS[each].key if each in NUMBERS else str(given[each]) for each in given if each in fields
        ]
        if len(both) > 1:
            raise ValueError(f"{name} has '{both[0]}' and '{both[1]}'; give one of them")
    return [*given]


def _check_ends(key: str, amount: Amount, least: float, most: float, name: str) -> None:
    if any(end is not None and not least <= end <= most for end in (amount.lo, amount.hi)):
        raise ValueError(f"{key} of {name} is from {least:g} to {most:g}, not {amount}")


def _said(thing: Frozen) -> list[str]:
    amounts = [(number.said, getattr(thing, field, None)) for field, number in NUMBERS.items()]
    mark: Mark | None = getattr(thing, "at", None)
    return [said.format(amount) for said, amount in amounts if amount] + ([mark.said] if mark else [])


def scene_text(scene: Scene) -> str:
    """Returns a scene in words, such as 'a truck ahead; medium traffic'; empty for an empty one."""
    return "; ".join(parts_said(scene))


LANDS: Mapping[str, Land | Roadworks] = {
    "water": Land(kind="lake", lie="along"),
    "trees": Land(kind="forest", lie="through"),
    "bridge": Land(kind="bridge"),
    "tunnel": Land(kind="tunnel"),
    "roadworks": Roadworks(),
}
"""The landscape, and the roadworks, that names in ``Brief.beside`` mean."""


def with_named(scene: Scene, beside: Sequence[str]) -> Scene:
    """Returns a scene with the land, roadworks and weather that names in ``Brief.beside`` mean, if it has
    none itself."""
    for kind in WEATHER:
        if kind in beside and not scene.amount_of(kind):
            scene = scene.with_weather(kind, usual_weather(kind).amount)
    named = [LANDS[name] for name in beside if name in LANDS]
    lands = scene.landscape or tuple(each for each in named if isinstance(each, Land))
    works = scene.roadworks or tuple(each for each in named if isinstance(each, Roadworks))
    return scene.model_copy(update={"landscape": lands, "roadworks": works})


def land_remark(scene: Scene) -> str:
    """Returns a sentence on what is not built of the landscape of a scene; empty if all of it is."""
    lands = ", ".join(str(land) for land in scene.landscape if land.kind == "town")
    return f"not built: {lands}; the road is made without it" if lands else ""


def parts_said(scene: Scene) -> Iterator[str]:
    """Yields the parts of a scene in words, such as 'a truck ahead'."""
    starts = [f"at {scene.speed} km/h"] if scene.speed else []
    starts += [f"parked on the {scene.parks}"] if scene.parks else []
    starts += [NUMBERS["station"].said.format(scene.station)] if scene.station else []
    if scene.offset:
        starts.append(NUMBERS["offset"].said.format(scene.offset))
    if scene.lane:
        inner = "the innermost lane" if scene.lane == -1 else f"lane {-scene.lane} from the inside"
        starts.append(f"in {f'lane {scene.lane} from the kerb' if scene.lane > 0 else inner}")
    if starts:
        yield f"the tested car starts {' '.join(starts)}"
    if scene.actions:
        yield f"the tested car {', then '.join(map(str, scene.actions))}"
    phrases = {str(name): said for name, said in LIGHTS.items()}
    phrases |= {name: row.said for name, row in SURFACES.items()} | SCENES["persons"]
    for name, said in SCENES["said"].items():
        value = getattr(scene, name)
        if name in ("flow", "oncoming") and value:
            density = "" if value == "none" else f" ({FLOWS[value]} vehicles for each km of a lane)"
            yield said.format(value.replace("none", "no")) + density
        elif name == "parked" and value:
            slant = f" {NUMBERS['angle'].said.format(scene.angle)}" if scene.angle else ""
            yield f"cars parked on {'both sides' if len(value) > 1 else f'the {value[0]}'}{slant}"
        elif value:
            each_of = value if isinstance(value, tuple) else (phrases.get(value, value),)
            yield from map(said.format, each_of)
