"""What words say of the roads at a junction that the route does not take, and the network left out."""

import re

from roadgpt.brief.junctions import JunctionClause, Way
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain

ONE_WAY_ONLY = re.compile(
    r"\b(?:only|nothing but|all|two) (?:the )?one[- ]?way (?:streets?|roads?)(?: only| cross| meet)?|"
    r"one[- ]?way (?:streets?|roads?) (?:only|throughout|everywhere|cross)|"
    r"(?:all|every|each)(?: of)?(?: the)? (?:streets?|roads?) (?:are |is |being )?one[- ]?way|"
    r"(?:nur|lauter|ausschliesslich|nichts als|zwei) einbahnstra(?:ss|ß)en|alle stra(?:ss|ß)en sind einbahn|"
    r"(?:que|uniquement|rien que|toutes) (?:des |les )?(?:rues|routes) (?:sont )?(?:a|en) sens unique|"
    r"(?:solo|todas) (?:las )?(?:calles|carreteras) (?:son )?de sentido unico|"
    r"(?:solo|tutte) (?:le )?strade (?:sono )?a senso unico"
)
"""All roads are one-way, those that the route does not take as well."""
STOPS = re.compile(
    r"\bstops?\b|stoppschild|stoppstra|\bpanneaux? (?:de )?stop|\barret|\bpare\b|senal(?:es)? de alto"
)
DENIED = re.compile(
    r"\b(?:no|not|without|never|don't|doesn't|kein\w*|nicht|ohne|pas|sans|sin|non|senza)\b[^.,;]*$"
)
FROM: dict[Way, Way] = {"left": "right", "right": "left", "straight": "left"}
"""The side from which traffic comes on a one-way road that the route crosses or turns into, by its take."""


def with_other_roads(brief: Brief, words: str) -> Brief:
    """Returns a route with what the words say of the roads that it does not take.

    If all streets are one-way, so are these. If the route has priority at one junction and stops at none, a
    stop sign is that of the others.
    """
    said = plain(words)
    junctions = brief.junctions
    if all(road.against is not None and road.against.hi == 0 for road in brief.stretches) and (
        ONE_WAY_ONLY.search(said)
    ):
        junctions = tuple(map(_one_way, junctions))
    first = [n for n, each in enumerate(junctions) if each.control == "priority"]
    has_stop = any(not DENIED.search(said[: found.start()]) for found in STOPS.finditer(said))
    if has_stop and len(first) == 1 and all(each.control != "stop" for each in junctions):
        known = junctions[first[0]].model_copy(update={"others_stop": True})
        junctions = (*junctions[: first[0]], known, *junctions[first[0] + 1 :])
    return brief.model_copy(update={"junctions": junctions})


def _one_way(junction: JunctionClause) -> JunctionClause:
    """Returns T-junctions and crossroads with one-way roads on the sides that the route does not take."""
    take, is_open = junction.take, not (junction.only_in or junction.only_out)
    if junction.kind not in ("t_junction", "crossroads") or not is_open:
        return junction
    if take not in ("left", "right", "straight") or (take == "straight" and junction.kind == "t_junction"):
        return junction
    sides: tuple[Way, ...] = junction.ways or ("left", "right")
    sides = ("left", "straight", "right") if junction.kind == "crossroads" else sides
    into = tuple(side for side in sides if side == FROM[take])
    out = tuple(side for side in sides if side not in (*into, take))
    ways = tuple(side for side in junction.ways if side not in into) if out else ()
    return junction.model_copy(update={"only_in": into, "only_out": out, "ways": ways})
