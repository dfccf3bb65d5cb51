"""Lists the contents of an OpenDRIVE road that a Road cannot represent, as one sentence."""

import math
from collections import Counter
from collections.abc import Iterator

import numpy as np

from roadgpt.road.opendrive.lanes import BESIDE, Lanes
from roadgpt.road.opendrive.numbers import cubics, number
from roadgpt.road.opendrive.tree import Choice, Node, is_driven

UNUSED = ("none", *BESIDE)  # lanes that become the shoulder, or nothing
PLACES = 200  # at which the superelevation is sampled
LEVEL = 1e-4  # rad, of superelevation


def left_out(choice: Choice, lanes: Lanes) -> str | None:
    """Returns a sentence that lists the contents of the file that are left out; None without any."""
    parts = [*_parts(choice, lanes)]
    return f"left out: {', '.join(parts)}" if parts else None


def is_one_way(road: Node, lanes: Lanes) -> bool:
    """Returns whether the road has no lane for oncoming cars."""
    other = "left" if lanes.side == -1 else "right"
    return not any(map(is_driven, road.all("lanes", "laneSection", other, "lane")))


def _parts(choice: Choice, lanes: Lanes) -> Iterator[str]:
    road = choice.road
    kinds = _further_lanes(road, lanes)
    if kinds:
        each = ", ".join(f"{count} {kind or 'without a type'}" for kind, count in sorted(kinds.items()))
        yield f"{_many(kinds.total(), 'further lane')} ({each})"
    for what, count in sorted(choice.passed.items()):
        yield _many(count, what)
    if road.attributes.get("junction", "-1") not in ("-1", ""):
        yield f"junction {road.attributes['junction'][:40]}"
    banking = cubics(road.all("lateralProfile", "superelevation"), "s")
    if banking is not None:
        most = float(np.abs(banking.height(np.linspace(0.0, lanes.length, PLACES))).max())
        if most > LEVEL:
            yield f"superelevation of up to {math.degrees(most):.1f} degrees"
    for tag, what in (("crossfall", "crossfall"), ("shape", "lateral shape")):
        if any(number(each, "a", 0.0) for each in road.all("lateralProfile", tag)):
            yield what
    if road.all("lanes", "laneSection", "left", "lane", "height") + road.all(
        "lanes", "laneSection", "right", "lane", "height"
    ):
        yield "heights of single lanes"
    if choice.header:
        yield " and ".join(f"<{tag}>" for tag in sorted(choice.header)) + " of the map"


def _further_lanes(road: Node, lanes: Lanes) -> Counter[str]:
    """Counts the lanes by type, except one driving lane in each direction and the shoulders."""
    kinds: dict[int, str] = {}
    taken: set[int] = set()
    for section in road.all("lanes", "laneSection"):
        for side, name in ((-1, "right"), (1, "left")):
            nodes = sorted(section.all(name, "lane"), key=lambda lane: abs(number(lane, "id")))
            ids = [side * (place + 1) for place in range(len(nodes))]
            kinds |= {id_: node.attributes.get("type", "") for id_, node in zip(ids, nodes, strict=True)}
            driven = [id_ for id_, node in zip(ids, nodes, strict=True) if is_driven(node)]
            taken |= set(driven[:1])
    return Counter(kind[:20] for id_, kind in kinds.items() if id_ not in taken and kind not in UNUSED)


def _many(count: int, what: str) -> str:
    return f"{count:,} {what}{'s' * (count != 1)}"
