"""Lists, in one sentence, the contents of an OpenDRIVE road that a Road cannot represent."""

from collections import Counter
from collections.abc import Container, Iterator
from xml.etree.ElementTree import Element

from roadgpt.road.opendrive.lanes import BESIDE
from roadgpt.road.opendrive.numbers import number
from roadgpt.road.opendrive.profile import FileProfile
from roadgpt.road.opendrive.tree import Choice

UNUSED = ("none", *BESIDE)  # types of lanes that are not listed


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
    for tag, what in (("crossfall", "crossfall"), ("shape", "lateral shape")):
        if any(number(each, "a", 0.0) for each in road.findall(f"lateralProfile/{tag}")):
            yield what
    lanes = [lane for side in ("left", "right") for lane in road.findall(f"lanes/laneSection/{side}/lane")]
    if any(lane.findall("height") for lane in lanes):
        yield "heights of single lanes"
    if profile.angle is not None and any(lane.get("level") == "true" for lane in lanes):
        yield "lanes that stay level"
    if choice.header:
        yield " and ".join(f"<{tag}>" for tag in sorted(choice.header)) + " of the map"


def _further_lanes(road: Element, used: Container[int]) -> Counter[str]:
    """Counts, by type, the lanes that are not in the profile; a lane in several sections counts once."""
    found = {
        (name, place, node.get("type", ""))
        for section in road.findall("lanes/laneSection")
        for name in ("right", "left")
        for place, node in enumerate(
            sorted(section.findall(f"{name}/lane"), key=lambda lane: abs(number(lane, "id")))
        )
        if id(node) not in used
    }
    return Counter(kind[:20] for _, _, kind in found if kind not in UNUSED)


def _many(count: int, what: str) -> str:
    return f"{count:,} {what}{'s' * (count != 1)}"
