"""Adds to a Brief what the words say about roads at junctions that the route does not take, where the neural
network left it out.
"""

import re

from roadgpt.brief.amount import exactly
from roadgpt.brief.junctions import JunctionClause, Way
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import says
from roadgpt.brief.readers.model.numerals import plain

ONE_WAY = exactly(0)
"""The number of oncoming lanes of a one-way road."""
ONE_WAY_ONLY = re.compile(
    r"\bone[- ]?way (?:streets|roads) (?:only|throughout|everywhere)\b|"
    r"\b(?:nothing but|only) one[- ]?way (?:streets|roads)\b(?! (?:is|are))|"
    r"\ball (?:the )?(?:streets|roads) (?:are )?one[- ]?way\b|"
    r"\b(?:nur|lauter|ausschliesslich) einbahnstra(?:ss|ß)en\b|alle stra(?:ss|ß)en sind einbahnstra|"
    r"\b(?:que|uniquement|rien que) des (?:rues|routes) a sens unique|"
    r"\btoutes les (?:rues|routes) (?:sont )?a sens unique|"
    r"\b(?:solo (?:hay )?|todas las )(?:calles|carreteras) (?:son )?de sentido unico|"
    r"\b(?:solo |tutte le )strade (?:sono )?a senso unico"
)
"""Phrases that say that all roads are one-way, including those that the route does not take."""
STOP_SIGNS = re.compile(
    r"stop signs?|stopp?(?:schild|tafel|zeichen)|panneaux? (?:de )?stop|senal(?:es)? de (?:stop|alto)|"
    r"(?:cartell[oi]|segnal[ei]) di stop"
)
FROM: dict[Way, Way] = {"left": "right", "right": "left", "straight": "left"}
"""The side from which traffic comes on a one-way road that the route crosses or turns into, by ``take``."""


def with_other_roads(brief: Brief, words: str) -> Brief:
    """Returns the Brief of a route with what the words say about the roads that the route does not take.

    If the words say that all streets are one-way, the roads of the route and the other roads at T-junctions
    and crossroads become one-way. If the words name a stop sign, and the route has priority at exactly one
    junction and stops at none, the other roads at this junction get the stop sign.
    """
    said, junctions, roads = plain(words), brief.junctions, brief.stretches
    if says(ONE_WAY_ONLY, said) and junctions:
        roads = tuple(
            each if each.against else each.model_copy(update={"against": ONE_WAY}) for each in roads
        )
        if all(each.against == ONE_WAY for each in roads):
            junctions = tuple(map(_one_way, junctions))
        else:
            roads = brief.stretches
    first = [n for n, each in enumerate(junctions) if each.control == "priority"]
    if len(first) == 1 and says(STOP_SIGNS, said) and all(each.control != "stop" for each in junctions):
        known = junctions[first[0]].model_copy(update={"others_stop": True})
        junctions = (*junctions[: first[0]], known, *junctions[first[0] + 1 :])
    return brief.model_copy(update={"junctions": junctions, "stretches": roads})


def _one_way(junction: JunctionClause) -> JunctionClause:
    """Returns a T-junction or crossroads with one-way roads on the sides that the route does not take."""
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
