"""Lists, in one sentence, the contents of an OpenDRIVE road that a Road cannot represent."""

from collections import Counter
from collections.abc import Container, Iterator
from xml.etree.ElementTree import Element

from roadgpt.road.opendrive.numbers import number
from roadgpt.road.opendrive.profile import FileProfile
from roadgpt.road.opendrive.tree import Choice
from roadgpt.road.profile import LINE

UNREAD = ("color", "direction", "dynamicLaneDirection", "dynamicLaneType", "level", "roadWorks", "roughness",
          "singleSide", "weight")  # fmt: skip
USUAL = ("", "false", "standard", "white")  # values of these attributes that are not reported, like 0
PLAIN = ("none", "solid", "broken", "solid solid")  # types of road marks that are painted as they are
BROAD = 0.2  # m; a wider line is reported


def left_out(choice: Choice, profile: FileProfile) -> str | None:
    """Returns a sentence that lists the contents of the file that are left out; None if none are."""
    parts = [*_parts(choice, profile)]
    return f"left out: {', '.join(parts)}" if parts else None


def _parts(choice: Choice, profile: FileProfile) -> Iterator[str]:
    road = choice.road
    kinds = _further_lanes(road, profile.used())
    if kinds:
        each = ", ".join(f"{count} {kind or 'without a type'}" for kind, count in sorted(kinds.items()))
        yield f"{_many(kinds.total(), 'further lane')} ({each})"
    for what, count in sorted(choice.passed.items()):
        yield _many(count, what)
    if road.get("junction", "-1") not in ("-1", ""):
        yield f"junction {road.attrib['junction'][:40]}"
    nodes = [*road.iter()]
    if any(node.find("width") is not None and node.find("border") is not None for node in nodes):
        yield "borders of lanes that have widths"
    for name in UNREAD:
        if any(node.get(name, "").strip("0.") not in USUAL for node in nodes):
            yield f"the attribute {name}"
    marks = [*road.iter("roadMark")]
    others = {mark.get("type", "none")[:20] for mark in marks} - {*PLAIN}
    if others:
        yield f"what road marks of type {', '.join(sorted(others))} look like"
    if any(number(mark, "width", LINE) > BROAD for mark in marks):
        yield "the width of broad road marks"
    if choice.header:
        yield " and ".join(f"<{tag}>" for tag in sorted(choice.header)) + " of the map"


def _further_lanes(road: Element, used: Container[int]) -> Counter[str]:
    """Counts the lanes that are not in the profile; a lane in several sections counts once."""
    sides = [road.findall(f"lanes/laneSection/{side}/lane") for side in ("left", "right")]
    lanes = [lane for side in sides for lane in side if id(lane) not in used]
    found = {(number(lane, "id"), lane.get("type", "")) for lane in lanes}
    return Counter(kind[:20] for _, kind in found if kind != "none")


def _many(count: int, what: str) -> str:
    return f"{count:,} {what}{'s' * (count != 1 and what[-1] != '>')}"
