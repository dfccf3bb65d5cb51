"""States what is wrong with a design in sentences that name its segments, so that a model can correct it.

Examples of such sentences:

    segment 3: grade 17 % > 15 %
    turn count is 4, asked for 3
    segment 5: leaves the map at (214, 35); x and y run from 0 to 200 m
"""

import re
from collections.abc import Iterable
from math import radians

from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.check import Finding
from roadgpt.errors import UsageError
from roadgpt.road import Design, World, build

MOST = 12  # sentences; a model that gets more corrects nothing
PLACE = re.compile(r"^(?:at s = [^:]*|near \([^:]*\)): ")
COUNT = re.compile(r"asked for (.+?) (left |right )?turns?, has (\d+)")
OF_DEFAULT_ARC = 1.36  # ratio of the length of a turn with default transitions to that of its tightest arc


def objections(design: Design, brief: Brief | None, world: World, partly: bool = False) -> tuple[str, ...]:
    """Returns sentences that say what is wrong with a design; none if it is valid and meets its Brief.

    Args:
        design: the design to check.
        brief: the requirements; None to check only the rules.
        world: size of the map, and limits that the rules check, such as the steepest grade.
        partly: True if segments will be added, so that the road may still be too short.
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
    said = [*steep]
    for finding in found:
        if (finding.rule == "too_steep" and steep) or (finding.rule == "too_short" and partly):
            continue
        said.append(_said(finding, design, world))
    return the_first(said)


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
    number = _segment_at(design, finding.s)
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


def _segment_at(design: Design, s: float) -> int:
    """Returns the number of the segment at station ``s``, from 1."""
    at = 0.0
    for number, segment in enumerate(design.segments, 1):
        at += segment.distance
        if s < at:
            return number
    return len(design.segments)
