"""Writes the requirements of a junction as plain English."""

from collections.abc import Mapping

from roadgpt.brief.amount import Amount
from roadgpt.brief.junctions import LANE_KINDS, Control, JunctionClause, Take

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


def junction_text(junction: JunctionClause) -> str:
    """Returns a junction and what the route does there, such as 'at a crossroads with traffic lights turn
    left'.
    """
    adjectives = [junction.size or "", "skew" if junction.skew else ""]
    noun = " ".join([*filter(None, adjectives), junction.name])
    place = [f"at {_article(noun)} {noun}"]
    if junction.arms is not None:
        place.append(f"with {junction.arms} arms")
    if junction.radius is not None:
        place.append(f"whose island has a radius of {junction.radius} metres")
    if junction.outer is not None:
        place.append(f"{junction.outer} metres across")
    if junction.ways:
        place.append(f"with ways on {_listed(junction.ways)}")
    if junction.only_in:
        place.append(f"with {_one_way(junction.only_in, 'comes')} {_from(junction.only_in)}")
    if junction.only_out:
        place.append(f"with {_one_way(junction.only_out, 'leads')} {_listed(junction.only_out)}")
    if junction.angle is not None:
        place.append(f"whose closest roads are {junction.angle} degrees apart")
    if junction.lanes is not None:
        place.append(f"with {junction.lanes} lanes around it")
    if junction.side is not None:
        place.append(f"on the {junction.side}")
    if junction.length is not None:
        place.append(f"{junction.length} metres long")
    if junction.taper is not None:
        place.append(f"with a taper of {junction.taper} metres")
    if junction.control is not None:
        place.append(CONTROLS[junction.control])
    if junction.all_way:
        place.append("at every arm")
    if junction.others_stop:
        place.append("with stop signs for the others")
    if junction.crosswalk:
        place.append("with a crosswalk")
    return f"{' '.join(place)} {_way_on(junction)}".strip()


LEADS = {"straight": "straight on"}


def _way_on(junction: JunctionClause) -> str:
    if junction.kind in LANE_KINDS:
        return f"to the {junction.take}" if junction.take else ""
    if junction.exit is not None:
        leads = f", which leads {LEADS.get(junction.take, junction.take)}" if junction.take else ""
        return f"take {exit_text(junction.exit)}{leads.replace('_', ' ')}"
    otherwise = "go on somewhere" if junction.degrees is None else "turn"
    way = TAKES[junction.take] if junction.take is not None else otherwise
    return way if junction.degrees is None else f"{way} by {junction.degrees} degrees"


def exit_text(number: Amount) -> str:
    """Returns the number of an exit as text, such as 'the third exit'."""
    if number.exact and number.lo is not None and number.lo.is_integer() and 1 <= number.lo <= len(ORDINALS):
        return f"the {ORDINALS[int(number.lo) - 1]} exit"
    return f"exit {number}"


def _listed(ways: tuple[str, ...]) -> str:
    said = {"left": "to the left", "right": "to the right", "straight": "straight on"}
    return " and ".join(said[way] for way in ways)


def _one_way(ways: tuple[str, ...], verb: str) -> str:
    return f"a one-way road that {verb}" if len(ways) == 1 else f"one-way roads that {verb.removesuffix('s')}"


def _from(ways: tuple[str, ...]) -> str:
    said = {"left": "from the left", "right": "from the right", "straight": "from straight ahead"}
    return " and ".join(said[way] for way in ways)


def _article(noun: str) -> str:
    return "an" if noun[:1].lower() in "aei" else "a"
