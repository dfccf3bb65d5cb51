"""Lists things that descriptions mention but no requirement of a Brief can express, such as a roundabout.

A reader that recognises one of them writes its name into ``Brief.beside``. RoadGPT then tells the user that
it is not built, needs a number or is set by an option, so that nothing is ignored silently.
"""

NOT_BUILT = {
    # networks
    "junction": "a junction",
    "crossroads": "a crossroads",
    "roundabout": "a roundabout",
    "merge": "a merge",
    "exit": "an exit or a slip road",
    "lane_change": "a lane change",
    "loop": "a road that crosses itself",
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
"""Names of what RoadGPT does not build, with the words of the remark."""
NEEDS_NUMBERS = {
    "size": "a long or a short road is not a number; ask for its length, such as 'a 300 m road'",
    "place": "what kind of road it is, such as a country lane, changes nothing by itself; say how it bends",
    "compared": "how one part compares with another is not built yet; give each its own number",
    "alike": "equal or evenly spaced parts are not built yet; give each its own number",
}
"""Names of wishes that are understood and that only numbers can express yet, with the remark."""
OPTIONS = {
    "wet": "a wet surface is set with --friction 0.6",
    "snow": "snow on the road is set with --friction 0.35",
    "ice": "ice on the road is set with --friction 0.1",
    "lanes": "the number of lanes is set with --lanes, such as --lanes 2+1",
    "lane_width": "the width of lanes is set with --lane-width, such as --lane-width 3",
    "bank": "superelevation is set with --bank, such as --bank auto",
    "speed": "the speed limit is set with --speed-limit, such as --speed-limit 50",
}
"""Names of what an option sets and words do not, with the remark."""
SAID_OTHERWISE = NEEDS_NUMBERS | OPTIONS
BESIDE = frozenset({*NOT_BUILT, *SAID_OTHERWISE})


def remark(name: str) -> str:
    """Returns what the user should know about a thing of this name, as a sentence without a full stop."""
    if name in NOT_BUILT:
        return f"{NOT_BUILT[name]} is not built yet; the road is made without it"
    return SAID_OTHERWISE[name]
