"""Lists things that descriptions mention but no requirement of a Brief can express, such as a bridge.

A reader that recognises such a thing adds the name of the thing to ``Brief.beside``. RoadGPT then tells the
user that the thing is not built, must be given as a number, is set by an option or sets the friction, so that
nothing is ignored silently.
"""

from collections.abc import Iterable, Iterator, Sequence

from roadgpt.brief.words import SURFACES

NOT_BUILT = {
    # networks
    "junction": "a junction",
    "crossroads": "a crossroads",
    "roundabout": "a roundabout",
    "merge": "a merge",
    "exit": "an exit or a slip road",
    "lane_change": "a lane change",
    "loop": "a closed loop, or a road that crosses itself",
    # structures and furniture
    "bridge": "a bridge",
    "tunnel": "a tunnel",
    "railway_crossing": "a level crossing",
    "zebra_crossing": "a pedestrian crossing",
    "parking": "a parking place",
    "bus_stop": "a bus stop",
    "roadworks": "a construction site",
    "traffic_light": "a traffic light",
    "sign": "a road sign",
    "speed_bump": "a speed bump",
    "pothole": "a pothole",
    "kerb": "a kerb",
    "guardrail": "a guard rail",
    "obstacle": "an obstacle",
    # road users
    "traffic": "other traffic",
    "pedestrian": "a pedestrian",
    "cyclist": "a cyclist",
    "animal": "an animal",
    # weather, light and landscape
    "rain": "rain",
    "fog": "fog",
    "snowfall": "falling snow",
    "wind": "wind",
    "night": "darkness",
    "sun": "a low sun",
    "trees": "a forest",
    "buildings": "buildings",
    "water": "a river, a lake or a coast",
    "landscape": "a landscape",
    # surfaces
    "gravel": "a gravel or dirt surface",
    "cobbles": "a cobbled surface",
}
"""The things that RoadGPT does not build, by name, with their wording in the remark."""
ON_ROUTES = {
    "junction": "a T-junction, turn left",
    "crossroads": "a crossroads, straight on",
    "roundabout": "a roundabout, second exit",
    "merge": "from the ramp onto the motorway",
    "exit": "take the exit on the right",
    "lane_change": "change to the left lane",
}
"""The things that are built as parts of a route, by name, with words that ask for them. In ``Brief.beside``,
these names come only from plans and from readers that do not know routes."""
NETWORKS = (*ON_ROUTES, "loop")
"""Names of the things that are not a single road. If a reader other than ``plan`` puts one of them into
``Brief.beside``, ``brief.read`` raises NotBuiltError, which proposes the road without this thing."""
SAID_OTHERWISE = {
    # wishes that cannot be built without a number
    "size": "a long or a short road is not a number; ask for its length, such as 'a 300 m road'",
    "place": "what kind of road it is, such as a country lane, changes nothing by itself; say how it bends",
    "compared": "how one part compares with another is not built yet; give each its own number",
    "alike": "only parts that are alike in everything are built by words; give each its own number",
    # properties that are set by an option
    "lanes": "the number of lanes is set with --lanes, such as --lanes 2+1",
    "lane_width": "the width of lanes is set with --lane-width, such as --lane-width 3",
    "bank": "superelevation is set with --bank, such as --bank auto",
    "speed": "the speed limit is set with --speed-limit, such as --speed-limit 50",
}
"""Wishes that RoadGPT understands but does not build from these words, by name, with the remark for each."""
BESIDE = frozenset({*NOT_BUILT, *SAID_OTHERWISE, *SURFACES})


def remarks(names: Sequence[str], friction: float | None = None) -> Iterator[str]:
    """Yields what the user should know about the named things, as sentences without full stops.

    Args:
        names: names from ``Brief.beside``.
        friction: friction coefficient that the user has set; with None, a surface in ``names`` sets it.
    """
    for name in names:
        if name in ON_ROUTES:
            yield (
                f"{NOT_BUILT[name]} is built as a part of a route, such as '{ON_ROUTES[name]}'; the road is"
                " made without it"
            )
        elif name in NOT_BUILT:
            yield f"{NOT_BUILT[name]} is not built yet; the road is made without it"
        elif name not in SURFACES:
            yield SAID_OTHERWISE[name]
    if said := surface_remark(names, friction):
        yield said


def networks_in(names: Iterable[str]) -> str:
    """Returns a sentence, without a full stop, that says why things in ``NETWORKS`` are not built; empty if
    none of them is named.
    """
    named = [name for name in names if name in NETWORKS]
    if not named:
        return ""
    said = " and ".join(NOT_BUILT[name] for name in named)
    example = next((ON_ROUTES[name] for name in named if name in ON_ROUTES), "")
    if not example:
        return f"{said} cannot be built yet"
    return f"it is not clear where {said} should be; say it in driving order, such as '{example}'"


def friction_of(names: Iterable[str]) -> float | None:
    """Returns the friction coefficient of the slipperiest surface among the names; None if there is none."""
    return min((SURFACES[name].friction for name in names if name in SURFACES), default=None)


def surface_remark(names: Sequence[str], friction: float | None = None) -> str:
    """Returns a sentence on whether the named surface, such as ice, sets the friction; empty if no surface is
    named. The arguments are those of ``remarks``.
    """
    own = friction_of(names)
    if own is None:
        return ""
    *others, last = (f"'{name}'" for name in SURFACES if name in names)
    said = f"{', '.join(others)} and {last}" if others else last
    if friction not in (None, own):
        return f"the words say {said}, but friction {friction:g} is set; the surface in the words is not used"
    which = "the lowest friction counts, " if others else "friction is "
    return f"the words say {said}: {which}{own:g}; --friction gives another"
