"""Maps of other tools, such as OpenDRIVE files. Plug-ins read them. Main functions: ``read_map`` for whole
maps, and ``read_opendrive`` for one road of a file."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from roadgpt import plugins
from roadgpt.network.network import Leg, Network
from roadgpt.road import Road
from roadgpt.road.profile import LaneStrip
from roadgpt.road.world import FRICTIONS, SPEEDS

OPENDRIVE = "xodr"  # the plug-in that gets XML of other names


@dataclass(frozen=True, eq=False)
class ImportedMap:
    """A network that was read from a map of another tool."""

    network: Network
    roads: Mapping[str, tuple[int, ...]]
    """The ids of the roads in the network, by the id of the road of the file that they are parts of."""
    remarks: tuple[str, ...]  # sentences about contents of the file that were changed, replaced or left out

    def world_values(self, legs: Sequence[Leg] = ()) -> tuple[dict[str, float], tuple[str, ...]]:
        """Returns the speed limit in m/s and the friction that hold for the longest part of a route, or of
        all lanes, as the fields of a World; and a sentence about each that differs on another part, or is
        limited. What the file does not state is left out; where some lane has no speed limit,
        ``limit_stated`` is False."""
        roads = {each.id: each for each in self.network.roads}
        ids = {number: each.profile.along_ids + each.profile.against_ids for number, each in roads.items()}
        legs = legs or [Leg(number, lane) for number, own in ids.items() for lane in own]
        lanes = ((roads[leg.road], leg.lane) for leg in legs)
        found, told = world_values([(each.road.length, each.profile.lanes[lane]) for each, lane in lanes])
        every = (roads[number].profile.lanes[lane] for number, own in ids.items() for lane in own)
        found |= {} if all(lane.speed_limit for lane in every) else {"limit_stated": False}
        return found, told


@dataclass(frozen=True)
class ImportedRoad:
    """A road that was read from a map of another tool, with its lane width, speed limit and friction."""

    road: Road
    """The road, or a Route where traffic drives on the left. Its ``profile`` is None if the file describes a
    cross-section like the default one of a World: one lane in each direction, both of the same constant
    width, with shoulders of equal constant width and the default markings, for traffic on the right."""
    id: str
    name: str
    lane_width: float  # width of the driven lane in metres; the median if it varies
    shoulder: float  # width in metres of the shoulder on the right; the median if it varies
    speed_limit: float | None
    """Speed limit in m/s, limited to 5 to 300 km/h; None if the file gives no speed limit."""
    friction: float | None  # friction coefficient of the driven lane, up to 2; None if the file gives none
    remarks: tuple[str, ...]  # sentences about contents of the file that were changed, replaced or left out

    @property
    def world_values(self) -> dict[str, float]:
        """The fields of a World that the file states, by name: no lane width and shoulder if ``road.profile``
        is not None, which defines them."""
        told = {"speed_limit": self.speed_limit, "friction": self.friction}
        told |= {"limit_stated": False if self.speed_limit is None else None}
        if self.road.profile is None:
            told |= {"lane_width": self.lane_width, "shoulder": self.shoulder}
        return {name: value for name, value in told.items() if value is not None}


def is_map_file(path: Path) -> bool:
    """Returns whether a file has the ending of maps that a plug-in reads."""
    return path.name.lower().endswith(tuple(f".{name}" for name in plugins.names("maps")))


def reader_of(path: Path) -> Any:
    """Returns the plug-in that reads maps with the ending of a file; that for OpenDRIVE if none does."""
    fits = [name for name in plugins.names("maps") if path.name.lower().endswith(f".{name}")]
    return plugins.find("maps", max(fits, key=len, default=OPENDRIVE))


def read_map(path: Path | str) -> ImportedMap:
    """Returns all roads of a map that cars may use, and the junctions that join them.

    Roads and junctions keep their ids where these are numbers. A road whose lanes change on its way becomes
    several roads, of which the first one keeps the id; see ``ImportedMap.roads``.

    Raises UsageError if the file cannot be read or is too large, is of another format, or has no road that
    can be read; a road that cannot be read is left out, and the remarks say why."""
    found: ImportedMap = reader_of(Path(path)).read_map(Path(path))
    return found


def read_opendrive(path: Path | str, road: str | None = None) -> ImportedRoad:
    """Returns one road of a map, such as an OpenDRIVE file. Its centre line is the reference line there.

    Args:
        path: The file.
        road: Id of the road. None selects the longest road that has a driving lane and is not part of a
            junction. If there is no such road, None selects the longest road with a driving lane. If no road
            has a driving lane, None selects the longest road outside junctions or, if there is none, the
            longest road.

    Raises:
        UsageError: The file cannot be read or is too large, there is no such road, or an element is unknown
            or invalid; the message names the element."""
    found: ImportedRoad = reader_of(Path(path)).read_road(Path(path), road)
    return found


def world_values(lanes: Sequence[tuple[float, LaneStrip]]) -> tuple[dict[str, float], tuple[str, ...]]:
    """Returns the speed limit in m/s and the friction that hold on most metres of lanes, each given with its
    length, as the fields of a World; see ``ImportedMap.world_values``."""
    found, remarks = dict[str, float](), list[str]()
    for name, limits in (("speed_limit", SPEEDS), ("friction", FRICTIONS)):
        what, metres = name.replace("_", " "), Counter[float]()
        for length, lane in lanes:
            if (value := getattr(lane, name)) is not None:
                metres[value] += length  # type: ignore[assignment]
        if not metres:
            continue
        most = max(metres, key=lambda value: (metres[value], value))
        found[name] = min(max(most, limits[0]), limits[1])
        least, largest, used = (said_of(what, value) for value in (min(metres), max(metres), found[name]))
        if len(metres) > 1:
            both = f"{least.removesuffix(' km/h')} to {largest}"
            remarks.append(f"its {what} is {both}; {used} is used everywhere")
        elif found[name] != most:
            remarks.append(f"its {what} of {least} is taken as {used}")
    return found, tuple(remarks)


def said_of(what: str, value: float | None) -> str:
    """Returns a speed limit in m/s, or a friction, in words."""
    if value is None:
        return "none"
    return f"{value * 3.6:.4g} km/h" if what == "speed limit" else f"{value:.4g}"
