"""Writes the requirements of a junction as plain English."""

from collections.abc import Mapping

from roadgpt.brief.amount import Amount
from roadgpt.brief.junctions import LANE_KINDS, Control, JunctionClause, Take, Way

TAKES: Mapping[Take, str] = {
    "left": "turn left",
    "right": "turn right",
    "straight": "go straight on",
    "back": "turn back the way it came",
    "sharp_left": "take the sharpest left",
    "sharp_right": "take the sharpest right",
    "slight_left": "bear slightly left",
    "slight_right": "bear slightly right",
    "ramp": "use the ramp",
    "main": "stay on the main road",
}
CONTROLS: Mapping[Control, str] = {
    "priority": "where the route has priority",
    "yield": "where the route has to give way",
    "stop": "with a stop sign for the route",
    "lights": "with traffic lights",
    "none": "without signs",
}
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")
TO: Mapping[Way, str] = {"left": "to the left", "right": "to the right", "straight": "straight on"}
FROM: Mapping[Way, str] = {
    "left": "from the left",
    "right": "from the right",
    "straight": "from straight ahead",
}


def junction_text(junction: JunctionClause) -> str:
    """Returns a junction and what the route does there, such as 'at a crossroads with traffic lights turn
    left'.
    """
    parts = [
        "at a",
        junction.size,
        "skew" if junction.skew else "",
        junction.name,
        f"with {junction.arms} arms" if junction.arms else "",
        f"whose island has a radius of {junction.radius} metres" if junction.radius else "",
        f"{junction.outer} metres across" if junction.outer else "",
        f"with ways on {_listed(junction.ways, TO)}" if junction.ways else "",
        _one_way(junction.only_in, "come", FROM),
        _one_way(junction.only_out, "lead", TO),
        f"whose closest roads are {junction.angle} degrees apart" if junction.angle else "",
        f"with {junction.lanes} lanes around it" if junction.lanes else "",
        f"on the {junction.side}" if junction.side else "",
        f"{junction.length} metres long" if junction.length else "",
        f"with a taper of {junction.taper} metres" if junction.taper else "",
        CONTROLS[junction.control] if junction.control else "",
        "at every arm" if junction.all_way else "",
        "with stop signs for the others" if junction.others_stop else "",
        "with a crosswalk" if junction.crosswalk else "",
        _way_on(junction),
    ]
    return " ".join(filter(None, parts))


def _way_on(junction: JunctionClause) -> str:
    if junction.kind in LANE_KINDS:
        return f"to the {junction.take}" if junction.take else ""
    if junction.exit is not None:
        way = "straight on" if junction.take == "straight" else (junction.take or "").replace("_", " ")
        return f"take {exit_text(junction.exit)}" + (f", which leads {way}" if way else "")
    otherwise = "go on somewhere" if junction.degrees is None else "turn"
    way = TAKES[junction.take] if junction.take is not None else otherwise
    return way if junction.degrees is None else f"{way} by {junction.degrees} degrees"


def exit_text(number: Amount) -> str:
    """Returns the number of an exit as text, such as 'the third exit'."""
    if number.exact and number.lo is not None and number.lo.is_integer() and 1 <= number.lo <= len(ORDINALS):
        return f"the {ORDINALS[int(number.lo) - 1]} exit"
    return f"exit {number}"


def _listed(ways: tuple[Way, ...], texts: Mapping[Way, str]) -> str:
    return " and ".join(texts[way] for way in ways)


def _one_way(ways: tuple[Way, ...], verb: str, texts: Mapping[Way, str]) -> str:
    roads = f"a one-way road that {verb}s" if len(ways) == 1 else f"one-way roads that {verb}"
    return f"with {roads} {_listed(ways, texts)}" if ways else ""
