"""Writes the prompt for a language model: rules of the map, requirements, and earlier roads to avoid."""

from collections.abc import Iterable, Iterator, Sequence
from importlib.resources import files
from math import radians

import numpy as np

from roadgpt.brief.junction_sentence import junction_text
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.sentence import sentence
from roadgpt.brief.words import COUNTS, ROAD, WHOLE_SLOPES
from roadgpt.design.objections import OF_DEFAULT_ARC
from roadgpt.road import Design, World

EDGE = 2.0  # m between road and border, as the prompt requires
EARLIER = 6  # earlier roads that the prompt lists, the last ones
MOST_WORDS = 2000  # characters of a description
SHOWN = 12  # segments that the prompt lists of an earlier road
USUAL_HEIGHT = 0.0  # m, height of a drawn start


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

    Args:
        brief: the requirements, and the description that they were read from.
        world: size of the map, and limits that the rules check, such as the steepest grade.
        notes: objections to an earlier attempt.
        earlier: designs of the campaign so far; the last six are listed.
        seed: determines the start that is suggested.
    """
    size = world.site.map_size
    demanded = [*route_demands(brief, size)] if brief.is_of_network else demands(outline(brief, size))
    parts = [
        f"Description: {words_of(brief)}",
        f"Understood as: {sentence(brief)}",
        "It must show:\n" + _listed(demanded) if demanded else "",
        "Roads of this campaign so far, of which yours must be none:\n"
        + _listed(map(_told, earlier[-EARLIER:]))
        if earlier
        else "",
        "Objections to an earlier attempt:\n" + _listed(notes) if notes else "",
        f"To begin with, think of {start_for(world, seed)}; choose another start where the road needs one.",
    ]
    return "\n\n".join(part for part in parts if part)


def start_for(world: World, seed: int) -> str:
    """Returns a phrase that suggests a random start to the model, so that different seeds give different
    roads.
    """
    x, y, theta = drawn_start(world, seed)
    return f"a start near ({x:g}, {y:g}) with theta {theta:g}"


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
    """Yields one line for each road and each junction of a route in driving order, and for the whole route.

    Args:
        brief: the requirements for the route.
        map_size: the side of the map in metres.
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
    shown = [_piece(s.direction, s.turn_degrees, s.distance) for s in design.segments[:SHOWN]]
    more = ", ..." if len(design.segments) > SHOWN else ""
    return f"start ({x:.0f}, {y:.0f}), theta {design.theta:.0f}: {', '.join(shown)}{more}"


def _piece(direction: str, turn: float, distance: float) -> str:
    return f"{distance:.0f} m straight" if direction == "straight" else f"{direction} {abs(turn):.0f}"


def _listed(lines: Iterable[str]) -> str:
    return "\n".join(f"- {line}" for line in lines)
