"""Adds the side of a side road to a T-junction where the neural network left it out."""

import re
from collections.abc import Sequence
from itertools import pairwise

from roadgpt.brief.junctions import JunctionClause, Side
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model.denial import TAKEN_BACK, says
from roadgpt.brief.readers.model.junction_nouns import SIDE_STREETS
from roadgpt.brief.readers.model.nouns import LEFT, RIGHT
from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.ordinals import OTHERS, PLACE, WHICH, place_of, places_in
from roadgpt.brief.readers.model.slots import SlottedText

SIDE_STREET = re.compile(
    r"\b(?:out of|from|leav\w+) (?:an?|the|my|our) side (?:street|road)|"
    r"\baus (?:einer|der|meiner|unserer) (?:neben|seiten)stra(?:ss|ß)e|"
    r"\b(?:d'une|de la|de ma) (?:petite )?(?:rue|route) (?:laterale|secondaire)|"
    r"\b(?:de|desde) (?:una|la|mi) (?:calle|carretera|via) (?:lateral|secundaria)|"
    r"\bda(?:lla| una) (?:strada|via|stradina) (?:laterale|secondaria)"
)
"""Phrases for a route that begins on a side street; the street ends at the next junction, a T-junction."""
EXIT = r"(?:exit|off - ramp|off ramp|slip road|ausfahrt|abfahrt|sortie|salida|uscita|svincolo)"
SIDES: tuple[Side, ...] = ("left", "right")
ENGLISH = frozenset(["left", "right"])
BEFORE_SIDE = frozenset(["the", "my", "our", "your", "its"])
"""Words before "left" or "right" where these are sides: "on the right", but not "right after the bend"."""
AFTER_SIDE = frozenset(["-", "hand", "side"])
TAKEN_NEXT = re.compile(
    rf"\b(?:pass|past|ignore|skip|vorbei|passe[rz]?|pasa\w*|supera\w*|oltre)\b[^.;]{{0,20}}?"
    rf"\b(\d+) [^.;]{{0,60}}?({PLACE})\b"
)
"""A number of streets that the route passes, and the place of the one that it takes."""
TURNS_INTO = re.compile(
    rf"\b(?:(?:turn|go|drive)\w* (?:in ?to|down|up)|take|biege\w* in|nimm|nehm\w*|prend\w*|tom[aoe]\w*) "
    rf"(?:the |die |la |le )?({PLACE})\b(?! (?:\w+ )?{EXIT}\b)"
)
"""The place of the street that the route takes."""
NUMBER_OF_SIDE_ROADS = re.compile(
    rf"\b(\d) (?:\w+ )?(?:{SIDE_STREETS.pattern}|t - (?:junctions|crossings|intersections|einmundungen)|"
    r"einmundungen)"
)
"""The number of side roads."""
ON_SIDE = re.compile(
    rf"({WHICH}|{OTHERS})(?: (?:of them|ones?|road|street|is|are|comes?|lies|also|again|wieder|ist|liegt|"
    r"liegen|sind|auch|est|sont|encore|esta|estan|queda|quedan|otra vez|de nuevo|e|sono|ancora|di nuovo))*"
    r"(?: (?:on|to|auf|an|a|sur|por|sulla|al))?(?: (?:the|my|our|your|der|la|le))? "
    r"(left|right|linken|rechten|links|rechts|gauche|droite|izquierda|derecha|sinistra|destra)\b"
)
"""The places of side roads in their row, and their side."""
OFF_A_ROAD = re.compile(
    r"\b(?:left|right) off (?:the|a|our|my) (?:main|major|priority|through) (?:road|street)\b|"
    r"\boff (?:the|a|our|my) (?:main|major|priority|through) (?:road|street) to the (?:left|right)\b|"
    r"\bleave (?:the|our|my) (?:main|major|priority|through) (?:road|street) (?:to|on) the (?:left|right)\b|"
    r"\b(?:links|rechts) von der (?:haupt|vorfahrt|durchgangs)s?stra(?:ss|ß)e ab|"
    r"\bquitte[rz]? la (?:route|rue) principale (?:a|par la|sur la) (?:gauche|droite)\b|"
    r"\b(?:deja|dejo|dejar|deje) la (?:calle|carretera|via) principal (?:a|por) la (?:izquierda|derecha)\b|"
    r"\blasci(?:o|a|are|amo|ate) la (?:strada|via) principale (?:a|sulla) (?:sinistra|destra)\b"
)
"""Words that say that the route turns out of a road that goes straight on."""


def with_sides_of_side_roads(brief: Brief, text: SlottedText, words: str) -> Brief:
    """Returns the Brief of a route with the ways on at its T-junctions, where the words tell these ways.

    - The side roads that the route passes get the sides that the words give for their places in the row.
    - If the words number the street that the route takes, the route takes this street.
    - If the route passes a street and takes the next on the same side, the road goes straight on there.
    - The T-junctions that the route passes get the sides that the words name, if the words name as many sides
      as there are such T-junctions and the plan uses no side.
    - If the route turns "off the main road" at the only T-junction, the main road goes straight on.
    """
    brief = _on_told_sides(_into_numbered(_as_many_as_passed(brief, text), text), text)
    brief = _with_ways(brief, _taken_behind_others(brief.junctions))
    passed = [n for n, each in enumerate(brief.junctions) if _is_open(each) and each.take == "straight"]
    sides = _sides(text)
    if passed and not brief.left_hand and len(passed) == len(sides) and not _uses_sides(brief):
        return _with_ways(brief, dict(zip(passed, sides, strict=True)))
    turned = [n for n, each in enumerate(brief.junctions) if each.kind == "t_junction"]
    if len(turned) == 1 and says(OFF_A_ROAD, plain(words)) and _is_open(brief.junctions[turned[0]]):
        side = brief.junctions[turned[0]].take
        if side in ("left", "right"):
            return _with_ways(brief, {turned[0]: side})
    return brief


def _as_many_as_passed(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route that takes the third street behind two passed ones, where the network has one more of
    those that it passes: "pass two side streets, then turn into the third".
    """
    found = TAKEN_NEXT.findall(text.text)
    passed = brief.junctions[:-1]
    is_alike = len(passed) > 1 and all(each == passed[0] for each in passed)
    if len(found) != 1 or not is_alike or passed[0].take != "straight":
        return brief
    number, ordinal = int(found[0][0]), place_of(found[0][1])
    if (
        ordinal != number + 1
        or len(passed) != number + 1
        or any(not road.is_open for road in brief.stretches[1:-1])
    ):
        return brief
    return brief.model_copy(
        update={"junctions": brief.junctions[1:], "stretches": (brief.stretches[0], *brief.stretches[2:])}
    )


def _on_told_sides(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route that passes as many side roads as the words count, each on the side that they tell by
    its place: "three side roads, the second on the left, the others on the right".

    The Brief is returned unchanged if the words leave one of these sides open, or if the route passes more
    side roads, or none.
    """
    told = [*NUMBER_OF_SIDE_ROADS.finditer(text.text)]
    passed = [n for n, each in enumerate(brief.junctions) if _is_passed(each)]
    number = int(told[0][1]) if len(told) == 1 else 0
    if not 1 <= len(passed) <= number or TAKEN_BACK.search(text.text):
        return brief
    sides = _sides_by_place(text.text[told[0].end() :], number)
    if sides is None:
        return brief
    junctions, roads, last = list(brief.junctions), list(brief.stretches), passed[-1]
    for _ in range(number - len(passed)):
        junctions.insert(last, junctions[last])
        roads.insert(last + 1, roads[last] if last else Brief())
    row = [*passed, *range(last + 1, last + 1 + number - len(passed))]
    for n, side in zip(row, sides, strict=True):
        junctions[n] = junctions[n].model_copy(update={"ways": (side, "straight")})
    return brief.model_copy(update={"junctions": tuple(junctions), "stretches": tuple(roads)})


def _is_passed(junction: JunctionClause) -> bool:
    """Returns whether the route passes a side road here, and stays on the road that goes straight on."""
    is_beside = not junction.ways or {*junction.ways} in ({"left", "straight"}, {"right", "straight"})
    return junction.kind == "t_junction" and junction.take == "straight" and is_beside


def _sides_by_place(said: str, number: int) -> list[Side] | None:
    """Returns the side of each of some side roads; None if the words do not tell one, or tell two."""
    found: dict[int, Side] = {}
    rest: list[Side] = []
    for where, word in ON_SIDE.findall(said):
        side: Side = "left" if word in LEFT or word == "linken" else "right"
        if re.fullmatch(OTHERS, where):
            rest.append(side)
            continue
        places = places_in(where, number) or frozenset()
        if not places or any(found.get(place, side) != side for place in places):
            return None
        found |= dict.fromkeys(places, side)
    if len(rest) > 1 or not found:
        return None
    found = {**dict.fromkeys(range(number), rest[0]), **found} if rest else found
    return [found[n] for n in range(number)] if len(found) == number else None


def _into_numbered(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route that takes the last of some side streets where the words say so by its number: "there
    are four side streets on the left, turn into the fourth".
    """
    found = TURNS_INTO.findall(text.text)
    row = [n for n, each in enumerate(brief.junctions) if each.ways and _is_passed(each)]
    if len(row) < 2 or len(found) != 1 or place_of(found[0]) not in (-1, len(row)):
        return brief
    junctions = list(brief.junctions)
    last, behind = junctions[row[-1]], junctions[row[-1] + 1 :]
    side: Side = "left" if "left" in last.ways else "right"
    is_further = bool(behind) and behind[0].take == side  # the street that is taken
    if is_further or any(each.kind == "junction" and each.ways for each in behind):
        return brief
    junctions[row[-1]] = last.model_copy(update={"take": side})
    return brief.model_copy(update={"junctions": tuple(junctions)})


def _taken_behind_others(junctions: Sequence[JunctionClause]) -> dict[int, Side]:
    """Returns the junctions at which the route takes the next street on a side where it has passed some."""
    return {
        n: side
        for n, (before, junction) in enumerate(pairwise(junctions), 1)
        for side in SIDES
        if junction == JunctionClause(kind="junction", take=side)
        if before.kind == "junction" and {*before.ways} == {side, "straight"}
    }


def _is_open(junction: JunctionClause) -> bool:
    has_ways = junction.ways or junction.only_in or junction.only_out or junction.angle or junction.degrees
    return junction.kind == "t_junction" and not has_ways


def _sides(text: SlottedText) -> list[Side]:
    """Returns the sides that a text names, in order."""
    said = ["", *(word.text for word in text.words), ""]
    return [
        "left" if said[n] in LEFT else "right"
        for n in range(1, len(said) - 1)
        if said[n] in LEFT | RIGHT
        and (said[n] not in ENGLISH or said[n - 1] in BEFORE_SIDE or said[n + 1] in AFTER_SIDE)
        and said[n + 1] != "of"  # the right of way
    ]


def _uses_sides(brief: Brief) -> bool:
    written = plan(brief).replace("left_hand", "")
    return "left" in written or "right" in written


def _with_ways(brief: Brief, sides: dict[int, Side]) -> Brief:
    junctions = tuple(
        each.model_copy(update={"ways": (sides[n], "straight")}) if n in sides else each
        for n, each in enumerate(brief.junctions)
    )
    return brief.model_copy(update={"junctions": junctions})


def with_end_of_side_street(brief: Brief, words: str) -> Brief:
    """Returns the Brief with a T-junction where a side street ends and the kind of the junction is open."""
    first = brief.junctions[0] if brief.junctions else None
    is_open = first is not None and first.kind == "junction" and first.take in ("left", "right")
    if first is None or not is_open or first.arms or not SIDE_STREET.search(plain(words)):
        return brief
    known = first.model_copy(update={"kind": "t_junction"})
    return brief.model_copy(update={"junctions": (known, *brief.junctions[1:])})
