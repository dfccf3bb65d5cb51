"""What a repair changed, in sentences."""

from collections.abc import Iterator

from roadgpt.road import Design, Segment

ALL_LISTED = 60  # segments; of longer lists only their number is told


def changes_between(before: Design, after: Design) -> tuple[str, ...]:
    """Returns a sentence for the start, one for the heading, and one for each segment that changed."""
    out = list(_placing(before, after))
    pairs = zip(before.segments, after.segments, strict=True)
    told = [said for number, (one, other) in enumerate(pairs, 1) if (said := _segment(number, one, other))]
    if len(told) > ALL_LISTED:
        return (*out, f"{len(told)} segments changed")
    return (*out, *told)


def _placing(before: Design, after: Design) -> Iterator[str]:
    (x, y, z), (x1, y1, z1) = before.starting_point, after.starting_point
    if (x, y) != (x1, y1):
        yield f"start moved from ({x:g}, {y:g}) to ({x1:g}, {y1:g})"
    if z != z1:
        yield f"start raised from {z:g} to {z1:g} m" if z1 > z else f"start lowered from {z:g} to {z1:g} m"
    turned = (after.theta - before.theta + 180) % 360 - 180
    if abs(turned) > 1e-9:
        yield f"turned by {turned:+.4g} degrees, theta {before.theta:g} -> {after.theta:g}"


def _segment(number: int, before: Segment, after: Segment) -> str:
    said = []
    if after.distance != before.distance:
        said.append(f"distance {before.distance:g} -> {after.distance:g} m")
    if after.turn_degrees != before.turn_degrees:
        said.append(f"turn {before.turn_degrees:g} -> {after.turn_degrees:g} degrees")
    if after.incline != before.incline:
        said.append(f"grade {before.incline:g} -> {after.incline:g} %")
    for name in ("radius", "transition", "vertical_radius"):
        one, other = getattr(before, name), getattr(after, name)
        if one != other:
            said.append(f"{name.replace('_', ' ')} {_metres(one)} -> {_metres(other)}")
    return f"segment {number}: {', '.join(said)}" if said else ""


def _metres(value: float | None) -> str:
    return "open" if value is None else f"{value:g} m"
