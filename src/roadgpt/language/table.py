"""Reads the table of the language of scenes: who can be on the road, where, what they do, and under which
conditions. The rows are data, in ``road_users.toml`` and ``scenes.toml``; whoever needs something of a kind
of road user, a place, a maneuver or a kind of weather asks for its row here."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, cast

from roadgpt.language.names import ActorKind, Flow, Landform, Light, Surface, WeatherKind, What, Where, Works
from roadgpt.reading import read_text

Words = Mapping[str, tuple[tuple[str, str], ...]]
"""Words by language: one, and many."""


class Size(NamedTuple):
    """The box of a road user in metres."""

    length: float
    width: float
    height: float


class InFlows(NamedTuple):
    """How a kind of vehicle drives in the traffic of a map."""

    share: float
    """Of all vehicles. Close to the vehicle kilometres of German federal roads, of which heavy goods vehicles
    drive 5 to 9 % (BASt, automatic counts)."""
    headway: float
    """The median of the drivers in seconds, without the 2 m at rest; ours: see ``roadgpt.traffic.idm``."""
    acceleration: float
    braking: float
    """In m/s^2. Cars: M. Treiber, A. Hennecke, D. Helbing (2000); trucks and buses accelerate as
    in M. Treiber, A. Kesting, Traffic Flow Dynamics (2013), table 11.2."""
    fastest: float
    """In m/s; 90 and 100 km/h for trucks and buses (Directives 92/6/EEC and 2002/85/EC)."""


@dataclass(frozen=True, slots=True)
class RoadUser:
    """A kind of somebody or something on the road; ``road_users.toml`` explains the fields."""

    group: Literal["vehicle", "person", "animal", "thing"]
    size: Size
    mass: float
    category: str
    look: str
    key: str
    read_as: ActorKind | None = None
    said: str = ""
    many: str = ""
    speed: float | None = None
    pull: float | None = None
    in_flows: InFlows | None = None
    role: str = ""
    paint: str = ""
    lamps: int = 0
    blue_light: bool = False
    words: Words = field(default_factory=dict)
    also: Words = field(default_factory=dict)
    unseen: Words = field(default_factory=dict)
    none: Words = field(default_factory=dict)

    @property
    def body(self) -> str:
        """What OpenSCENARIO calls a body of this kind."""
        return {"vehicle": "Vehicle", "thing": "MiscObject"}.get(self.group, "Pedestrian")


@dataclass(frozen=True, slots=True)
class PlaceRow:
    """Where somebody can be at first."""

    said: str
    side: str = ""
    """The words before its side; empty if it has none."""
    who: tuple[ActorKind, ...] = ()


class NumberRow(NamedTuple):
    """A number of a scene: its key in plans, the least and the most that is possible, and its words."""

    key: str
    least: float
    most: float
    said: str
    unit: str
    where: tuple[Where, ...]
    """Where somebody is at first who can have it."""


@dataclass(frozen=True, slots=True)
class ManeuverRow:
    """Something that can be done."""

    said: str
    numbers: tuple[str, ...] = ()
    """Those that it can have; the first needs no key."""
    starts: tuple[Where, ...] = ()
    """Where somebody is at first who can begin with it."""
    side: bool = False
    who: tuple[ActorKind, ...] = ()
    usual: float | None = None
    """Its first number, where a plan gives none."""
    hands: Literal["", "pedals", "wheel", "both"] = ""
    """What the script takes of the tested car that does it; empty if that cannot be told to."""


class Falling(NamedTuple):
    """What falls from the sky: its kind in OpenSCENARIO, and how the page draws it."""

    category: str
    speed: float
    """In m/s."""
    length: float
    """In metres."""
    colour: str


@dataclass(frozen=True, slots=True)
class WeatherRow:
    """What falls or floats; ``scenes.toml`` explains the fields."""

    least: float
    most: float
    said: str
    usual: tuple[float, float]
    tint: tuple[float, float, float] | None = None
    surface: Surface | None = None
    falls: Falling | None = None
    read_as: WeatherKind | None = None
    words: Words = field(default_factory=dict)
    unseen: Words = field(default_factory=dict)
    none: Words = field(default_factory=dict)
    """Phrases that do not mean it, although a word in them does."""


@dataclass(frozen=True, slots=True)
class LandRow:
    """Something that the road lies in."""

    length: float | None = None
    away: float | None = None
    """Metres along the road, and from it, where words give none."""
    crossed: float | None = None
    """Metres along a road that crosses it."""
    structure: bool = False
    """Whether it has neither a side nor a lie."""
    article: str = "a"
    said: str = ""


class Part(NamedTuple):
    """What a thing can have, as plans write it; ``roads.toml`` explains the fields."""

    key: str = ""
    words: Mapping[str, Any] = MappingProxyType({})
    """Each with the value that it means."""
    usual: float | None = None
    unit: str = ""
    of: str = ""
    zero: str = ""
    double: str = ""
    unknown: str = ""
    signed: bool = False
    list: bool = False
    brackets: bool = False
    token: bool = True


class WorksRow(NamedTuple):
    """Roadworks; ``scenes.toml`` explains the fields."""

    said: str
    taper: float
    inside: Sequence[ActorKind] = ()
    covers: float | None = None


class SurfaceRow(NamedTuple):
    """A surface that descriptions can name, such as ice."""

    said: str
    """The phrase for the surface in a sentence, such as 'on an icy road'."""
    friction: float
    """The friction coefficient of roads with this surface."""


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads(read_text(Path(__file__).with_name(name)))


def _words(row: Mapping[str, str]) -> Words:
    said = {code: [each.strip().partition("/") for each in words.split(",")] for code, words in row.items()}
    return {code: tuple((one, many or one) for one, _, many in each) for code, each in said.items()}


def _row_of_user(row: dict[str, Any]) -> RoadUser:
    made: dict[str, Any] = {**row, "size": Size(*row["size"])}
    made |= {name: _words(row.get(name, {})) for name in ("words", "also", "unseen", "none")}
    return RoadUser(**made | {"in_flows": InFlows(*row["in_flows"]) if "in_flows" in row else None})


ROAD_USERS = cast(
    "Mapping[ActorKind, RoadUser]",
    MappingProxyType({name: _row_of_user(row) for name, row in _table("road_users.toml").items()}),
)
VEHICLES: tuple[ActorKind, ...] = tuple(name for name, row in ROAD_USERS.items() if row.group == "vehicle")
PERSONS: tuple[ActorKind, ...] = tuple(name for name, row in ROAD_USERS.items() if row.group == "person")
THINGS: tuple[ActorKind, ...] = tuple(name for name, row in ROAD_USERS.items() if row.group == "thing")
MOVING: tuple[ActorKind, ...] = tuple(name for name in ROAD_USERS if name not in THINGS)
WITH_TOKENS: tuple[ActorKind, ...] = tuple(name for name, row in ROAD_USERS.items() if row.read_as is None)
"""Those that the trained networks write."""
SIZES: Mapping[ActorKind, Size] = {name: row.size for name, row in ROAD_USERS.items()}
USUAL_SPEEDS: Mapping[ActorKind, float] = {name: row.speed for name, row in ROAD_USERS.items() if row.speed}
_WHO: Mapping[str, tuple[ActorKind, ...]] = {
    "all": tuple(ROAD_USERS), "moving": MOVING, "vehicles": VEHICLES, "nobody": (),
}  # fmt: skip
SCENES = _table("scenes.toml")
ROADS = _table("roads.toml")
"""What words for roads require: features, sharpness, sizes, slopes, junctions, signs."""


def named_in(part: str) -> tuple[Any, ...]:
    """Returns the names of the rows of a part of ``ROADS``."""
    return tuple(ROADS[part].get("rows", ROADS[part]))


def _part(name: str, row: Mapping[str, Any]) -> Part:
    said = row.get("words", {} if "key" in row or "brackets" in row else {name: True})
    named = dict(zip(named_in(said), named_in(said), strict=True)) if isinstance(said, str) else said
    words = {word: tuple(its) if isinstance(its, list) else its for word, its in named.items()}
    return Part(**{**row, "words": words})


PARTS: Mapping[str, Mapping[str, Part]] = {
    thing: {name: _part(name, row) for name, row in parts.items()} for thing, parts in ROADS["parts"].items()
}
"""What clauses, roads, junctions, maps and changes can have, by names of fields, in the order of plans."""
COUNTED = "x"
"""The key of how many there are, which stands without "=" before the number."""
ANYWHERE: tuple[Where, ...] = tuple(SCENES["places"])
ALONG: tuple[Where, ...] = tuple(SCENES["sets"]["along"])
ACROSS: tuple[Where, ...] = tuple(SCENES["sets"]["across"])


def _places(names: Sequence[str] = ANYWHERE) -> tuple[Where, ...]:
    sets = SCENES["sets"]
    return cast("tuple[Where, ...]", tuple(each for name in names for each in sets.get(name, [name])))


PLACES: Mapping[Where, PlaceRow] = {
    name: PlaceRow(**{**row, "who": _WHO[row["who"]]}) for name, row in SCENES["places"].items()
}
NUMBERS: Mapping[str, NumberRow] = {
    name: NumberRow(**{"key": name, **row, "where": _places(row.get("where", ANYWHERE))})
    for name, row in SCENES["numbers"].items()
}
MANEUVERS: Mapping[What, ManeuverRow] = {
    name: ManeuverRow(
        **{
            **row,
            "numbers": tuple(row.get("numbers", ())),
            "starts": _places(row.get("starts", ANYWHERE)),
            "who": _WHO[row.get("who", "vehicles")],
        }
    )
    for name, row in SCENES["actions"].items()
}
OF_OTHERS: tuple[What, ...] = tuple(name for name, row in MANEUVERS.items() if row.who)
"""What somebody besides the tested car can do."""
OF_ITSELF: tuple[What, ...] = tuple(name for name, row in MANEUVERS.items() if row.hands)
"""What the tested car can be told to do."""
CUES: tuple[str, ...] = tuple(SCENES["cues"]["rows"])
FLOWS: Mapping[Flow, int] = {name: row["per_km"] for name, row in SCENES["flows"].items()}
"""How many vehicles drive on each km of a lane."""
WEATHER: Mapping[WeatherKind, WeatherRow] = {
    name: WeatherRow(
        **{
            **row,
            **{part: _words(row.get(part, {})) for part in ("words", "unseen", "none")},
            "falls": Falling(**row["falls"]) if "falls" in row else None,
        }
    )
    for name, row in SCENES["weather"].items()
}
LIGHTS: Mapping[Light, str] = {name: row["said"] for name, row in SCENES["lights"].items()}
SURFACES: Mapping[str, SurfaceRow] = {name: SurfaceRow(**row) for name, row in SCENES["surfaces"].items()}
ROADWORKS: Mapping[Works, WorksRow] = {name: WorksRow(**row) for name, row in SCENES["roadworks"].items()}
LANDFORMS: Mapping[Landform, LandRow] = {name: LandRow(**row) for name, row in SCENES["landforms"].items()}


def one_of(kind: ActorKind) -> str:
    """Returns one of a kind in words, such as "an adult"."""
    if kind == several_of(kind) and kind in THINGS:
        return kind
    return ROAD_USERS[kind].said or f"{'an' if kind[0] in 'aeiou' else 'a'} {kind.replace('_', ' ')}"


def several_of(kind: ActorKind) -> str:
    """Returns the plural of a kind, such as "buses"."""
    return ROAD_USERS[kind].many or f"{kind.replace('_', ' ')}s"
