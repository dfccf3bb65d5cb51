"""Corrects what a route does at a ramp of a motorway if the words say where it comes from or goes to."""

import re

from roadgpt.brief.amount import exactly
from roadgpt.brief.junctions import JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.ordinals import PLACE, place_of

ROAD = (
    r"(?:motorway|freeway|highway|interstate|main (?:road|carriageway|line)|mainline|autobahn|hauptfahrbahn|"
    r"autoroute|voie principale|autopista|autovia|calzada principal|autostrada|carreggiata principale)"
)
EXIT = r"(?:exit|off - ramp|off ramp|slip road|ausfahrt|abfahrt|sortie|salida|uscita|svincolo)"
STAYS = (
    rf"(?:(?:stay|remain|keep|carry|continu)\w* (?:\w+ ){{0,3}}?(?:on|along) (?:the |my )?{ROAD}|"
    rf"bleib\w* (?:\w+ ){{0,5}}?auf (?:der |meiner )?{ROAD}|auf der {ROAD} (?:zu )?bleib\w*|"
    rf"(?:rest|continu|poursui)\w* (?:\w+ ){{0,2}}?sur (?:l ?' ?|la |ma )?{ROAD}|"
    r"(?:sigo|sigue|seguir|permane\w*|quedo|queda\w*|continu\w*) "
    rf"(?:\w+ ){{0,2}}?(?:en|por) (?:la |mi )?{ROAD}|"
    rf"(?:rest|riman|rimang|prosegu|continu)\w* (?:\w+ ){{0,2}}?(?:in |sull ?' ?|sulla |nella ){ROAD})\b"
)
PASSES = re.compile(
    rf"\b{EXIT}\b(?:(?!\b(?:until|till|bis|jusqu|hasta|fino)\b)[^.;]){{0,40}}?\b{STAYS}|"
    rf"\b(?:past|ignor\w+|skip\w*|vorbei an|depass\w+|paso de largo|supero|oltre) (?:\w+ ){{0,2}}?{EXIT}\b"
    rf"[^.;]{{0,30}}?\b{STAYS}"
)
"""An exit, and words behind it that say that the route stays on the motorway."""
REFUSES = re.compile(
    rf"\b(?:not|n ' t|without) (?:take|taking|use|using) (?:the |that |this |any |my )?{EXIT}\b|"
    rf"\bohne (?:abzufahren|auszufahren|rauszufahren)\b|\bsans (?:sortir|prendre (?:la |une )?{EXIT})\b|"
    rf"\bsin (?:salir|tomar (?:la |ninguna )?{EXIT})\b|"
    rf"\bsenza (?:uscire|prendere (?:l ?' ?|la |una )?{EXIT})\b|"
    r"\b(?:stay|remain|keep)\w* on it (?:the whole time|all the time|all the way|throughout)\b"
)
"""Words that say that no exit is taken."""
JOINED = re.compile(
    r"^\W*(?:(?:i|we|you|let us|the (?:car|ego)) )?"
    r"(?:stay|remain|keep|carry|continu)\w* (?:\w+ )?(?:on|along) (?:(?:the|my|an?) )?(?:\S+ ){0,2}?"
    rf"{ROAD}[^.;]{{0,40}}?"
    r"\b(?:while|as|where|when|past|whereas) (?:an?|the|another) "
    r"(?:on ?-? ?ramp|slip road|ramp|entry|entrance)[^.;]{0,20}? (?:come|join|merge|run|feed|enter)\w*\b"
)
"""The route is on the motorway first, and a ramp joins it."""
COUNTS = {
    **dict.fromkeys(("2", "two", "zwei", "deux", "dos", "due"), 2),
    **dict.fromkeys(("3", "three", "drei", "trois", "tres", "tre"), 3),
    **dict.fromkeys(("4", "four", "vier", "quatre", "cuatro", "quattro"), 4),
}
NUMBER = f"({'|'.join(COUNTS)})"
ONTO_LANES = re.compile(
    rf"\b(?:on ?to|join\w*|enter\w*|into) (?:an?|the|my) {NUMBER} ?-? ?laned? "
    r"(?:motorway|freeway|highway|interstate)\b|"
    rf"\bauf (?:eine|die) {NUMBER}spurige autobahn\b|"
    rf"\b(?:sur|rejoin\w+) (?:une |l ?' ?)autoroute a {NUMBER} voies\b|"
    rf"\ba (?:una|la) auto(?:pista|via) de {NUMBER} carriles\b|"
    rf"\b(?:in|su|nell?'? ?)(?: ?una?'? ?)? ?autostrada a {NUMBER} corsie\b"
)
"""Words that give the number of lanes of the motorway that a route joins."""
NUMBERED = re.compile(rf"\b({PLACE}) (?:\w+ )?{EXIT}\b")
"""An exit with its number: those before it are passed."""
LEAVES = re.compile(
    r"\b(?:leav\w*|off|come off|get off|take|taking|turn|exits? (?:there|again|right|left)|verlass\w*|"
    r"(?:fahr\w*|geh\w*) [^.;]*\b(?:ab|raus|runter)|abfahren|ausfahren|herunter|nehm\w*|nimm\w*|genommen|"
    r"(?:res)?sort(?:ir|ons|ez)|(?:res)?sors|on sort|prend\w*|prenons|quitt\w*|salgo|salir|salimos|"
    r"abandon\w*|tom[oae]\w*|esco|uscire|usciamo|si esce|lasci\w*|not?|nicht|pas)\b"
)


def with_stay_on_motorway(brief: Brief, words: str) -> Brief:
    """Returns the Brief of a route that passes its only exit, if the words say that it stays on the motorway.

    The Brief is returned unchanged if a word may say that the route leaves the motorway, or stays on it
    somewhere else.
    """
    ramps = [n for n, each in enumerate(brief.junctions) if each.kind == "diverge"]
    said = plain(words)
    passes = PASSES.search(said) and not LEAVES.search(said)
    if len(ramps) != 1 or brief.junctions[ramps[0]].take == "main" or not (passes or REFUSES.search(said)):
        return brief
    at = ramps[0]
    passed = brief.junctions[at].model_copy(update={"take": "main"})
    return brief.model_copy(update={"junctions": (*brief.junctions[:at], passed, *brief.junctions[at + 1 :])})


def with_passed_exits(brief: Brief, words: str) -> Brief:
    """Returns the Brief of a route that leaves a motorway at "the second exit" and passes those before it.

    The Brief is returned unchanged if it has another number of exits, or passes one of them already.
    """
    ramps = [n for n, each in enumerate(brief.junctions) if each.kind == "diverge"]
    found = {place_of(each) for each in NUMBERED.findall(plain(words))}
    if len(ramps) < 2 or found != {len(ramps)} or _is_passed(brief.junctions):
        return brief
    junctions = tuple(
        each.model_copy(update={"take": "main"}) if n in ramps[:-1] else each
        for n, each in enumerate(brief.junctions)
    )
    return brief.model_copy(update={"junctions": junctions})


def with_motorway_behind_ramp(brief: Brief, words: str) -> Brief:
    """Returns the Brief of a route that joins a motorway, with the motorway where the words have it.

    - If the route comes from a ramp, what is said of a motorway before the merge is true of the road behind
      it, unless that road has other lanes.
    - If the route is on the motorway while a ramp joins it, it does not come from the ramp.
    - If the words give the lanes of the motorway that it joins, the road behind the ramp has them.
    """
    merges = [n for n, each in enumerate(brief.junctions) if each.kind == "merge"]
    if merges != [0]:
        return brief
    merge, (before, behind, *roads) = brief.junctions[0], brief.stretches
    onto = ONTO_LANES.search(plain(words))
    if onto is not None and merge.take == "ramp" and not before.motorway and behind.lanes is None:
        lanes = exactly(COUNTS[next(filter(None, onto.groups()))])
        behind = behind.model_copy(update={"motorway": True, "lanes": lanes})
        return brief.model_copy(update={"stretches": (before, behind, *roads)})
    if JOINED.search(plain(words)) and merge.take != "main":
        junctions = (merge.model_copy(update={"take": "main"}), *brief.junctions[1:])
        has_lanes = before.motorway or before.lanes is not None
        before = before if has_lanes else before.model_copy(update=_carriageway(behind))
        return brief.model_copy(update={"junctions": junctions, "stretches": (before, behind, *roads)})
    is_misplaced = before.motorway and merge.take == "ramp"
    if not is_misplaced or (behind.lanes is not None and behind.lanes != before.lanes):
        return brief
    bare = before.model_copy(update={"motorway": False, "lanes": None, "against": None})
    behind = behind.model_copy(update=_carriageway(before))
    return brief.model_copy(update={"stretches": (bare, behind, *roads)})


def _carriageway(road: Brief) -> dict[str, object]:
    """Returns whether a road is a motorway, and its lanes."""
    return {"motorway": road.motorway, "lanes": road.lanes, "against": road.against}


def _is_passed(junctions: tuple[JunctionClause, ...]) -> bool:
    """Returns whether the route stays on the road at some ramp."""
    return any(each.take == "main" for each in junctions)
