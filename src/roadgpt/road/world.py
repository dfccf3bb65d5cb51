"""Defines the World, which all roads of a campaign share: a Site, a CrossSection, Limits and a Scene, and the
oracles by name: when a drive fails because the car is out of its lane.

Files keep the values of the first three in one flat table, in the order of ``FIELDS``, and then the scene as
plans have it. What people can set, also the fields of ``Parts``, are rows of ``roadgpt/options.toml``."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from statistics import mean
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    WrapValidator,
    model_serializer,
    model_validator,
)

from roadgpt.brief.amount import Amount, Frozen, exactly
from roadgpt.brief.beside import friction_of, slipperiest
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_scene, scene_plan
from roadgpt.brief.scene import LAND_KINDS, Scene, with_named
from roadgpt.brief.visibility import weather_drawn
from roadgpt.brief.words import LARGEST_MAP, SMALLEST_MAP
from roadgpt.errors import BriefError, SceneError, UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.ground.given import BESIDE, NAME, GivenGround
from roadgpt.language.names import CentreLine
from roadgpt.road.profile import Profile, superelevation
from roadgpt.road.road import SHORTEST_DRIVE, START, Road
from roadgpt.settings import ROWS, field, span

ORACLES: dict[str, dict[str, Any]] = {
    "half": {"oob_tolerance": 0.5, "lane_departure": False},
    "sbft": {"oob_tolerance": 0.85, "lane_departure": False},
    "thesis": {"oob_tolerance": 0.95, "lane_departure": False},
    "departure": {"oob_tolerance": 0.5, "lane_departure": True},
}
"""The fields of Limits that each oracle sets; ``departure`` is that of UN Regulation No. 157."""
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
KMH = 3.6
OF_RUN, OF_WORLD = ROWS["run"], ROWS["world"]
FRICTIONS = span(OF_WORLD["friction"])  # the first is not reached
SPEEDS = tuple(speed / KMH for speed in span(OF_WORLD["speed_limit"]))  # m/s, in options and files
LANE_WIDTHS = span(OF_WORLD["lane_width"])  # m, of the driven lane in options and files
Avoider = Literal["r157", "reg157", "rss", "fsm", "any"]
"""Who has to avoid a collision, or it is unavoidable: one of the drivers of ``verdict.careful``, or any."""
STEEPEST = 0.12  # ratio, largest superelevation of bends
OWN = {"lanes": "1+1", "lane_width_end": None, "centre_line": None, "bank": "none"}
"""The fields that change the usual cross-section of two equal lanes, with their defaults. Of them and of the
scene, files contain only those that differ from their default."""
OVER_LEAST_RADIUS = 1.055
"""Ratio of the smallest designed radius to ``min_radius``: a spline through control points 2 m apart is 3 %
tighter than its turn."""
FIELDS = {
    "map_size": "site",
    **dict.fromkeys(("lanes", "lane_width", "lane_width_end", "centre_line", "bank", "shoulder"), "section"),
    "friction": "site",
    **dict.fromkeys(("speed_limit", "oob_tolerance", "lane_departure", "avoidable"), "limits"),
    **dict.fromkeys(("limit_stated", "min_radius", "max_grade"), "limits"),
    "z_floor": "site",
    "min_length": "limits",
    "ground": "site",
}
"""The fields of a World in the order in which files list them, each with the part that it belongs to."""
KEYS = {"shoulder": "verge"}
"""The fields that have another name in files, each with its name in files."""
OF_FILES = {key: name for name, key in KEYS.items()}


def oracle_limits(oracle: str = "half", **given: Any) -> dict[str, Any]:
    """Returns the fields of Limits that an oracle sets: one of ORACLES; or a share of the car such as "0.7";
    or "departure:0.7", where a front tyre beyond the marking fails the test as well. Raises UsageError if
    there is no such oracle, or it contradicts a field of ``given``."""
    share = oracle.removeprefix("departure:")
    try:
        limits = ORACLES.get(oracle) or {"oob_tolerance": float(share), "lane_departure": share != oracle}
    except ValueError:
        limits = {"oob_tolerance": 0.0}
    if not 0 < limits["oob_tolerance"] <= 1:
        raise UsageError(f"there is no oracle '{oracle}'; give {', '.join(ORACLES)}, or a share from 0 to 1")
    if wrong := [f"{name} {value}".lower() for name, value in given.items() if value != limits[name]]:
        raise UsageError(f"oracle {oracle} and {wrong[0]} contradict each other; leave one of them out")
    return limits


def oracle_name(oob_tolerance: float, lane_departure: bool) -> str:
    """Returns the name of the oracle with these limits; ``oracle_limits`` returns them again."""
    limits = {"oob_tolerance": oob_tolerance, "lane_departure": lane_departure}
    other = f"{'departure:' * lane_departure}{oob_tolerance!r}"
    return next((name for name, own in ORACLES.items() if own == limits), other)


def oracle_in_words(oracle: str) -> str:
    """Returns "half: FAIL when more than half of the car is outside its lane", for the oracle "half"."""
    limits = oracle_limits(oracle)
    tyre = "a front tyre is over the marking, or " * limits["lane_departure"]
    share = share_in_words(limits["oob_tolerance"])
    return f"{oracle}: FAIL when {tyre}more than {share} is outside its lane"


def share_in_words(share: float) -> str:
    """Returns a share of the car in words: "half of the car" or "85 % of the car"."""
    return "half of the car" if share == 0.5 else f"{100 * share:g} % of the car"


def lanes_in(text: str) -> str:
    """Returns a text such as "2 + 1" (2 lanes along the road, 1 against it) with its blanks removed. Raises
    ValueError if it has another form."""
    plain = text.replace(" ", "")
    if not re.fullmatch(r"[1-4]\+[0-4]", plain):
        raise ValueError("give 1 to 4 lanes along the road, a plus and 0 to 4 against it, such as 2+1")
    return plain


def bank_in(value: str | float, most: float = STEEPEST, unit: str = "a ratio") -> str | float:
    """Returns the superelevation of bends unchanged; raises ValueError unless it is "none", "auto" or a
    number from 0 to ``most``."""
    if value in ("none", "auto") or (isinstance(value, float) and 0 <= value <= most):
        return value
    raise ValueError(f"give 'none', 'auto' or {unit} from 0 to {most:g}")


def ground_in(given: Any, check: Callable[[Any], str]) -> str:
    """Returns given land as it is; or a kind of land such as "hilly", or "hilly:3" with a seed. Raises
    ValueError if there is no such kind."""
    if isinstance(given, GivenGround) or (isinstance(given, str) and NAME.fullmatch(given)):
        return given
    kind, colon, seed = (text := check(given)).partition(":")
    if text and (kind not in LAND_KINDS or (colon and not re.fullmatch(r"\d{1,9}", seed))):
        raise ValueError(f"give {', '.join(LAND_KINDS)}, with a seed as in hilly:3")
    return text


Lanes = Annotated[str, AfterValidator(lanes_in)]
Geometry = Literal["arcs", "spline"]
WHOLE = ConfigDict(frozen=True, extra="forbid")


class Parts(Frozen):
    """The plug-ins that make and drive roads, by name, and how they work."""

    reader: str = field(OF_RUN["reader"])
    designer: str = field(OF_RUN["designer"])
    rules: Literal["strict", "sbft"] = field(OF_RUN["rules"])
    driver: str = field(OF_RUN["driver"])
    simulator: str = field(OF_RUN["simulator"])
    geometry: Geometry = field(OF_RUN["geometry"])
    keep_driving: bool = field(OF_RUN["keep_driving"])
    scenario: str = field(OF_RUN["scenario"])
    tracks: str = field(OF_RUN["tracks"])


class Site(BaseModel):
    """The map on which roads are built: its size, its ground, and the friction of its asphalt."""

    model_config = WHOLE

    map_size: float = field(OF_WORLD["map_size"])
    """Side length of the square map in metres. One corner of the map is at (0, 0)."""
    friction: float = field(OF_WORLD["friction"])
    """Friction coefficient: 1.0 for dry asphalt, about 0.6 wet, 0.35 on snow, 0.1 on ice. If no value is
    given here, a description that names a surface, such as "wet", sets the friction: see
    ``World.on_surface_of``."""
    z_floor: float = -28.0
    """Height in metres of the flat ground of the simulator's map."""
    ground: Annotated[str, WrapValidator(ground_in)] = field(OF_WORLD["ground"])

    @model_validator(mode="before")
    @classmethod
    def _as_large_as_given_land(cls, data: Any) -> Any:
        given = data.get("ground") if isinstance(data, Mapping) else None
        if not isinstance(given, GivenGround) or "map_size" in data:
            return data
        if (wide := max(given.relief.size)) < SMALLEST_MAP:
            raise UsageError(
                f"the land '{given}' is {wide:.3g} m wide; give land of {SMALLEST_MAP:g} m or more"
            )
        return {**data, "map_size": min(wide, LARGEST_MAP)}

    @property
    def made_ground(self) -> tuple[Any, int] | None:
        """The kind and the seed of the land; None if none is asked for, or it is given."""
        kind, _, seed = self.ground.partition(":")
        return (kind, int(seed or 0)) if kind in LAND_KINDS else None


class CrossSection(BaseModel):
    """The lanes, shoulders and banked bends of roads that have no Profile of their own. A CrossSection is the
    same for roads of all lengths; ``profile`` makes the Profile of one road from it."""

    model_config = WHOLE

    lanes: Lanes = field(OF_WORLD["lanes"])
    """Number of lanes along the road, and number of oncoming lanes, such as "2+1". The tested car keeps to
    the rightmost lane."""
    lane_width: Positive = field(OF_WORLD["lane_width"])
    lane_width_end: float | None = field(OF_WORLD["lane_width_end"], allow_inf_nan=False)
    """Width of every lane in metres at the end of the road, reached smoothly from ``lane_width`` at the
    start; None for a constant width."""
    centre_line: CentreLine | None = None
    """The line between the directions; None for a broken line on a road with one lane in each direction, and
    for a solid one on any other road."""
    bank: Annotated[str | float, AfterValidator(bank_in)] = field(OF_WORLD["bank"])
    """Superelevation of bends: "none", "auto" for the values of the design guide CD 109, or one ratio for all
    bends."""
    shoulder: NotNegative = field(OF_WORLD["shoulder"])
    """Width in metres of the firm shoulder beside the carriageway. With 0 the road floats above the ground,
    as in the RoadGPT thesis."""

    def profile(self, length: float) -> Profile:
        """Returns the Profile of a road that is ``length`` metres long, without superelevation."""
        forward, backward = map(int, self.lanes.split("+"))
        made = Profile.of(forward, backward, self._width(length), self.shoulder)
        return made if self.centre_line is None else replace(made, centre_marking=self.centre_line)

    def _width(self, length: float) -> float | CubicProfile:
        first, last = self.lane_width, self.lane_width_end
        if last is None or last == first:
            return first
        return CubicProfile.smooth([(0.0, first), (length, last)])

    @property
    def bank_ratio(self) -> float | None:
        """The superelevation of all bends as a ratio; None if ``bank`` gives no number."""
        return self.bank if isinstance(self.bank, float) else None

    @property
    def road_width(self) -> float:
        """Twice the largest distance in metres between the centre line and an edge of the carriageway."""
        count = max(int(each) for each in self.lanes.split("+"))
        return 2 * count * max(self.lane_width, self.lane_width_end or 0.0)


class Limits(BaseModel):
    """Defines what the validity rules allow, and when a test fails. Most defaults are those of the RoadGPT
    thesis."""

    model_config = WHOLE

    speed_limit: Positive = field(OF_WORLD["speed_limit"])
    """Speed limit in m/s. The default is the competition's 70 km/h."""
    limit_stated: bool = True
    """Whether exported lanes without a limit of their own have this one; False where a file has none."""
    oob_tolerance: float = field(OF_WORLD["oob_tolerance"])
    """Fraction of the car's area, 0 to 1, that may be outside its lane before the test fails."""
    lane_departure: bool = field(OF_WORLD["lane_departure"])
    """Whether the test also fails as soon as a front tyre crosses the outer edge of a lane marking. Source:
    UN Regulation No. 157, 5.2.1."""
    avoidable: Avoider | None = field(OF_WORLD["avoidable"])
    """None: the careful driver of UN R157 where somebody cuts in, cuts out or brakes hard ahead, as that
    regulation defines it, and else any (``verdict.avoidable``)."""
    min_radius: Positive = 14.326
    """Minimum radius of a turn in metres. The default is 47 ft, the tightest turn of the SBFT rules."""
    max_grade: Annotated[float, Field(gt=0, le=1)] = 0.15
    """Steepest grade, uphill or downhill, that the validity rules allow, as a ratio."""
    min_length: NotNegative = 20.0
    """Minimum length of a road in metres."""

    @property
    def oracle(self) -> str:
        """Name of the test oracle, such as "half", or the share of the car that may be outside its lane."""
        return oracle_name(self.oob_tolerance, self.lane_departure)

    @property
    def design_radius(self) -> float:
        """The smallest radius in metres that a designed turn may have, a little above ``min_radius``."""
        return self.min_radius * OVER_LEAST_RADIUS


def _in_parts(values: Mapping[str, Any]) -> dict[str, Any]:
    """Groups the values of a flat table by the part of a World that they belong to. ``oracle`` stands for two
    of the Limits. Unknown values stay at the top level, as does a value that is given twice, or whose part is
    given as a whole as well; pydantic refuses them there."""
    if "oracle" in values:
        oracle, values = values["oracle"], {name: values[name] for name in values if name != "oracle"}
        given = {name: values[name] for name in oracle_limits() if name in values}
        values |= oracle_limits(str(oracle), **given)
    out = {name: value for name, value in values.items() if name in ("site", "section", "limits")}
    flat: dict[str, Any] = {}
    for key, value in values.items():
        name = OF_FILES.get(key, key)
        part = FIELDS.get(name)
        if part is None or part in out or name in flat.get(part, {}):
            flat.setdefault(key, value)
        else:
            flat.setdefault(part, {})[name] = value
    return out | flat


def _scene_in(given: Any) -> Any:
    try:
        return read_scene(given) if isinstance(given, str) else given
    except BriefError as error:
        raise ValueError(str(error)) from error


def _middle(amount: Amount) -> float:
    return mean(bound for bound in (amount.lo, amount.hi) if bound is not None)


class World(BaseModel):
    """Everything that the roads of a run or a campaign share: a Site, a CrossSection, Limits and a Scene.
    Files have the fields of the first three in one flat table, with the text of the scene if there is one,
    and ``World.model_validate`` reads such a table."""

    model_config = WHOLE

    site: Site = Site()
    section: CrossSection = CrossSection()
    """The cross-section of roads whose own ``profile`` is None."""
    limits: Limits = Limits()
    scene: Annotated[Scene, BeforeValidator(_scene_in)] = field(OF_WORLD["scene"], default=Scene())
    """A text is read as in ``brief.plan.read_scene``."""

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, data: Any) -> Any:
        return _in_parts(data) if isinstance(data, Mapping) else data

    @model_serializer
    def _to_file(self) -> dict[str, Any]:
        usual = OWN | {"scene": "", "ground": "", "avoidable": None, "limit_stated": True}
        told = self.section.model_fields_set & {"lanes", "centre_line"}  # then words do not change them
        values = self.values().items()
        kept = [(name, value) for name, value in values if name in told or usual.get(name, self) != value]
        return {KEYS.get(name, name): value for name, value in kept}

    def values(self) -> dict[str, Any]:
        """Returns a dictionary of the fields of all three parts, in the order of ``FIELDS``, and the text of
        the scene."""
        fields = {name: getattr(getattr(self, part), name) for name, part in FIELDS.items()}
        return fields | {"scene": scene_plan(self.scene)}

    def changed(self, **values: Any) -> "World":
        """Returns a World with other values for some fields of its parts, such as ``friction=0.6``. Raises
        pydantic.ValidationError if there is no such field, or its value is invalid."""
        named = {OF_FILES.get(name, name) for name in values}
        named |= {*oracle_limits()} if "oracle" in named else set()
        kept = {
            name: value
            for name, value in self.values().items()
            if name not in named
            and name in (self if name == "scene" else getattr(self, FIELDS[name])).model_fields_set
        }
        return World.model_validate(kept | values)

    def in_scene_of(self, brief: Brief | None) -> "World":
        """Returns the World with the scene of a Brief, with land and weather that its words name, and with
        mountains around a mountain road. Where a scene was given to this World, what it says is kept, and
        what it leaves open is that of the Brief; an empty one takes all of that away."""
        is_given = "scene" in self.model_fields_set
        if brief is None or self._is_emptied:
            return self
        scene = with_named(brief.scene, brief.beside)
        if brief.surroundings == "mountain" and scene.land is None:
            scene = scene.model_copy(update={"land": "mountain"})
        if scene.surface or is_given:
            surface = slipperiest((*brief.beside, scene.surface or ""))
            scene = scene.model_copy(update={"surface": surface})
        for air in self.scene.weather:
            scene = scene.with_weather(air.kind, air.amount)
        kept = self.scene.model_fields_set - {"weather"} if is_given else set[str]()
        if scene.stands and scene.station is None and (room := scene.room_behind):
            scene = scene.model_copy(update={"station": exactly(room)})
        said = {name: getattr(scene, name) for name in scene.model_dump(exclude_defaults=True)}
        said = {name: each for name, each in said.items() if name not in kept}
        return self.changed(scene=self.scene.model_copy(update=said)) if said else self

    @property
    def _is_emptied(self) -> bool:
        return "scene" in self.model_fields_set and self.scene == Scene()

    def in_weather_of(self, seed: int) -> "World":
        """Returns the World with the fog and rain that a drive with this seed draws from their ranges."""
        scene = weather_drawn(self.scene, seed)
        return self if scene is self.scene else self.changed(scene=scene)

    def on_surface_of(self, brief: Brief | None) -> "World":
        """Returns the World with the friction of the surface that its scene or a Brief names, such as a wet
        road. A friction that was given to this World is kept, even if it equals the default."""
        of_words = brief.beside if brief and not (self.scene.surface or self._is_emptied) else ()
        friction = friction_of((*of_words, *self.scene.surfaces))
        if friction is None or "friction" in self.site.model_fields_set:
            return self
        return self.changed(friction=friction)

    def with_lanes_of(self, brief: Brief | None) -> "World":
        """Returns the World with the ``lanes`` and ``centre_line`` that a Brief of a single road requires.
        Those that were given to this World are kept, even if they equal the defaults."""
        if brief is None or brief.is_of_network:
            return self
        return self._open(lanes=brief.lanes_text, centre_line=brief.centre)

    def with_numbers_of(self, brief: Brief | None) -> "World":
        """Returns the World with the width of lanes and the speed limit of a Brief, where none was given."""
        limit = brief and brief.limit and brief.limit / KMH
        return self._open(lane_width=brief.lane_width, speed_limit=limit) if brief else self

    def _open(self, **wanted: object) -> "World":
        """Returns the World with those of some values that are asked for and were not given."""
        given = self.section.model_fields_set | self.limits.model_fields_set
        changes = {name: value for name, value in wanted.items() if value is not None and name not in given}
        return self.changed(**changes) if changes else self

    @property
    def given_map(self) -> float | None:
        """The side of the map in metres, if one was given; None if it is the usual one."""
        return self.site.map_size if "map_size" in self.site.model_fields_set else None

    def with_heights_in(self, *folders: Path) -> "World":
        """Returns the World with the heights of its given land, if one of the folders holds them."""
        name = self.site.ground
        if isinstance(name, GivenGround) or not NAME.fullmatch(name):
            return self
        from roadgpt.ground.files import attached

        found = next((folder for folder in folders if (folder / BESIDE).is_file()), None)
        return self if found is None else self.changed(ground=attached(name, found))

    @property
    def has_ground(self) -> bool:
        """Whether a car that leaves the road drives on over land: where land was asked for."""
        return bool(self.site.ground or self.scene.land or self.scene.landscape)

    @property
    def first_speed(self) -> float:
        """The speed in m/s at which the tested car starts to roll among others: that of the scene, or the
        middle of its range, else the speed limit."""
        if self.scene.speed is None:
            return 0.0 if self.scene.parks else self.limits.speed_limit
        return _middle(self.scene.speed) / KMH

    def start_on(self, road: Road) -> float:
        """Returns the station in metres of the tested car's centre of gravity at the start. Raises SceneError
        if the scene says a place that the road does not have."""
        if self.scene.station is None:
            return min(START, road.length / 2)
        at = max(_middle(self.scene.station), START)
        if at > road.length - SHORTEST_DRIVE:
            raise SceneError(f"the tested car starts at {at:.0f} m, and the road ends at {road.length:.0f} m")
        return at

    @property
    def driven_speed(self) -> float:
        """The greatest speed in m/s at which the tested car wants to drive: that of the scene, where it
        starts with one, else the speed limit."""
        return min(self.first_speed or math.inf, self.limits.speed_limit)

    def friction_at(self, s: float) -> float:
        """Returns the friction at a station of the tested car's road: that of a slippery place, or the usual
        one."""
        for patch in self.scene.slippery:
            if 0 <= s - _middle(patch.station) < _middle(patch.length):
                return _middle(patch.friction)
        return self.site.friction

    def profile_of(self, road: Road) -> Profile:
        """Returns the Profile of a road: ``road.profile`` or, if that is None, one made from ``section``.
        Raises UsageError if bends are banked here, and the road was not passed through ``lay``."""
        if road.profile is not None:
            return road.profile
        if self.section.bank != "none":
            raise UsageError("the road has no superelevation yet; use the road that world.lay(road) returns")
        return self._profile(road.length)

    def _profile(self, length: float) -> Profile:
        profile = self.section.profile(length)
        lane = self.scene.lane_driven(profile.left_hand)
        if lane is None:
            return profile
        driven = profile.driven + 1 - lane if lane > 0 else -1 - lane
        return replace(profile, driven=min(max(driven, 0), profile.driven))

    def lay(self, road: Road) -> Road:
        """Returns the road with the lanes and banked bends of this World's ``section``. A road that has a
        Profile of its own keeps it. If ``section`` has two lanes of constant width with the default centre
        line and no banked bends, the road is returned unchanged."""
        section = self.section
        if road.profile is not None or all(getattr(section, name) == usual for name, usual in OWN.items()):
            return road
        profile = self._profile(road.length)
        if section.bank != "none":
            angle = superelevation(
                road.plan, profile.paved_reach, self.limits.speed_limit, section.bank_ratio
            )
            profile = replace(profile, superelevation_angle=angle)
        return road.with_profile(profile)
