"""Writes what a language model is told: rules of the map, requirements, earlier roads to avoid, and what is
wrong with its road, in sentences that name the segments, so that it can correct them:

    segment 3: grade 17 % > 15 %
    turn count is 4, asked for 3
    segment 5: leaves the map at (214, 35); x and y run from 0 to 200 m
"""

import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from importlib.resources import files
from itertools import accumulate
from math import radians

import numpy as np

from roadgpt import check
from roadgpt.brief.junction_sentence import junction_text
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.sentence import sentence
from roadgpt.brief.words import COUNTS, ROAD, WHOLE_SLOPES
from roadgpt.check import Finding
from roadgpt.errors import UsageError
from roadgpt.road import Design, World, build

EDGE = 2.0  # m between road and border, as the prompt requires
EARLIER = 6  # earlier roads that the prompt lists, the last ones
MOST_WORDS = 2000  # characters of a description
SHOWN = 12  # segments that the prompt lists of an earlier road
USUAL_HEIGHT = 0.0  # m, height of a drawn start
MOST = 12  # sentences; a model that gets more corrects nothing
PLACE = re.compile(r"^(?:at s = [^:]*|near \([^:]*\)): ")
COUNT = re.compile(r"asked for (.+?) (left |right )?turns?, has (\d+)")
OF_DEFAULT_ARC = 1.36  # ratio of the length of a turn with default transitions to that of its tightest arc


def rules(name: str, world: World) -> str:
    """Returns the text of a prompt file of the package, with the limits of ``world`` filled in as numbers."""
    text = files("roadgpt.design.designers").joinpath(name).read_text(encoding="utf-8")
    half = world.section.road_width / 2
    numbers = {
        "map_size": f"{world.site.map_size:g}",
        "bound": f"{0.8 * world.site.map_size:g}",
        "road_width": f"{world.section.road_width:g}",
        "low": f"{half + EDGE:g}",
        "high": f"{world.site.map_size - half - EDGE:g}",
        "floor": f"{world.site.z_floor:g}",
        "grade": f"{100 * world.limits.max_grade:g}",
        "radius": f"{world.limits.min_radius:.1f}",
        "length": f"{world.limits.min_length:g}",
    }
    for degrees in (70, 45, 30):
        numbers[f"for_{degrees}"] = f"{OF_DEFAULT_ARC * world.limits.min_radius * radians(degrees) + 1:.0f}"
    return text.format_map(numbers)


def words_of(brief: Brief) -> str:
    """Returns the first 2000 characters of the description; if there is none, the Brief's requirements in a
    sentence.
    """
    return brief.words.strip()[:MOST_WORDS] or sentence(brief)


def request(brief: Brief, world: World, notes: Sequence[str], earlier: Sequence[Design], seed: int) -> str:
    """Returns the prompt that asks a language model for a road.

    It lists ``notes``, which are objections to an earlier attempt, and the last six of the earlier designs of
    the campaign. The seed determines the start that is suggested, so that different seeds give different
    roads.
    """
    x, y, theta = drawn_start(world, seed)
    size = world.site.map_size
    demanded = [*route_demands(brief, size)] if brief.is_of_network else demands(outline(brief, size))
    parts = [
        f"Description: {words_of(brief)}",
        f"Understood as: {sentence(brief)}",
        "It must show:\n" + listed(demanded) if demanded else "",
        "Roads of this campaign so far, of which yours must be none:\n"
        + listed(map(_told, earlier[-EARLIER:]))
        if earlier
        else "",
        "Objections to an earlier attempt:\n" + listed(notes) if notes else "",
        f"To begin with, think of a start near ({x:g}, {y:g}) with theta {theta:g}; "
        "choose another start where the road needs one.",
    ]
    return "\n\n".join(part for part in parts if part)


def drawn_start(world: World, seed: int) -> tuple[float, float, float]:
    """Returns a random x and y in metres, and a heading in degrees roughly towards the map's centre."""
    rng = np.random.default_rng(seed)
    x, y = (round(float(v)) for v in world.site.map_size * (0.12 + 0.76 * rng.random(2)))
    to_middle = np.degrees(np.arctan2(world.site.map_size / 2 - y, world.site.map_size / 2 - x))
    theta = round(float(to_middle + 100 * (rng.random() - 0.5)) % 360 / 5) * 5 % 360
    return float(x), float(y), float(theta)


def demands(asked: Outline) -> list[str]:
    """Returns the requirements of a road in driving order, one line each."""
    out = [f"in this order: {group}" for group in asked.groups]
    names_turns = any(group.feature.kind == "turn" for group in asked.groups)
    counts = {name: getattr(asked, name) for name in COUNTS if name != "turns" or not names_turns}
    out += [f"{span} {COUNTS[name]}s" for name, span in counts.items() if span != Range()]
    out.append("turns alternate between left and right" if asked.alternating else "")
    out.append("turns of one kind equal and evenly spaced, straights equally long" if asked.alike else "")
    each = asked.each_turn.limits()
    out.append(f"every turn{each}" if each else "")
    mean = f" (mean slope {asked.grade_range} %)" if asked.grade_range else ""
    out.append(f"the whole road {WHOLE_SLOPES[asked.grade]}{mean}" if asked.grade else "")
    out += [row.asked.format(span) for name, row in ROAD.items() if (span := getattr(asked, name))]
    for end, feature in (("starts", asked.starts), ("ends", asked.ends)):
        out.append(f"it {end} with a {feature.name}{feature.limits()}" if feature else "")
    return [line for line in out if line]


def route_demands(brief: Brief, map_size: float) -> Iterator[str]:
    """Yields one line for each road and each junction of a route in driving order, and for the whole route;
    ``map_size`` is the side of the map in metres.
    """
    for number, road in enumerate(brief.roads, 1):
        if not road.is_open:
            numbers = "; ".join(demands(outline(road.as_stretch, map_size)))
            yield f"road {number}: {sentence(road).removesuffix('.')}{numbers and f' ({numbers})'}"
        if number <= len(brief.junctions):
            yield f"junction {number}: {junction_text(brief.junctions[number - 1])}"
    if brief.junctions and brief.length is not None:
        yield f"{brief.length} m of route in all, with its ways through junctions"
    if brief.left_hand:
        yield "traffic drives on the left: exits are counted clockwise, beginning on the left"


def _told(design: Design) -> str:
    """Returns one line about an earlier road."""
    x, y, _ = design.starting_point
    shown = [
        f"{s.distance:.0f} m straight"
        if s.direction == "straight"
        else f"{s.direction} {abs(s.turn_degrees):.0f}"
        for s in design.segments[:SHOWN]
    ]
    more = ", ..." if len(design.segments) > SHOWN else ""
    return f"start ({x:.0f}, {y:.0f}), theta {design.theta:.0f}: {', '.join(shown)}{more}"


def listed(lines: Iterable[str]) -> str:
    """Returns the lines as a list, each behind a dash."""
    return "\n".join(f"- {line}" for line in lines)


def objections(design: Design, brief: Brief | None, world: World, partly: bool = False) -> tuple[str, ...]:
    """Returns sentences that say what is wrong with a design; none if it is valid and meets its Brief.

    If segments will be added (``partly``), the road may still be too short.
    """
    try:
        found = check.inspect(build(design), brief, world)
    except UsageError as error:
        return (str(error),)
    limit = 100 * world.limits.max_grade
    steep = [
        f"segment {number}: grade {segment.incline:g} % {'> ' if segment.incline > 0 else '< -'}{limit:g} %"
        for number, segment in enumerate(design.segments, 1)
        if abs(segment.incline) > limit + 1e-4
    ]
    known = {"too_steep"} if steep else set[str]()
    known |= {"too_short"} if partly else set()
    others = (_said(finding, design, world) for finding in found if finding.rule not in known)
    return the_first([*steep, *others])


def the_first(said: Iterable[str]) -> tuple[str, ...]:
    """Returns the first 12 different sentences, and how many more there are."""
    kept = list(dict.fromkeys(said))
    return (*kept[:MOST], *([f"and {len(kept) - MOST} more"] if len(kept) > MOST else []))


def _said(finding: Finding, design: Design, world: World) -> str:
    sentence = PLACE.sub("", finding.sentence)
    count = COUNT.fullmatch(sentence)
    if count:
        return f"{count[2] or ''}turn count is {count[3]}, asked for {count[1]}"
    if finding.s is None:
        return sentence
    ends = accumulate(segment.distance for segment in design.segments[:-1])
    number = 1 + bisect_right([*ends], finding.s)
    if finding.rule == "inside_map" and finding.x is not None and finding.y is not None:
        verb = "leaves the map at" if finding.s > 0 else "starts outside the map at"
        place = f"({finding.x:.0f}, {finding.y:.0f}); x and y run from 0 to {world.site.map_size:g} m"
        return f"segment {number}: {verb} {place}"
    if finding.rule == "too_tight":
        turn = abs(radians(design.segments[number - 1].turn_degrees))
        needed = OF_DEFAULT_ARC * world.limits.min_radius * turn
        if needed > design.segments[number - 1].distance:
            sentence += f"; give it a distance of {needed:.0f} m or turn it less"
    return f"segment {number}: {sentence}"
