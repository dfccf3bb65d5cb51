"""Makes routes from hand-written pairs: joins descriptions of roads and of junctions into one description."""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from roadgpt.brief.feasible import check
from roadgpt.brief.plan import read_plan
from roadgpt.errors import RoadGPTError
from roadgpt_training.generator import REFUSAL, draw, road_of
from roadgpt_training.grammar import Discarded
from roadgpt_training.mirror import is_of_junctions
from roadgpt_training.pair import Pair, grouped, standard
from roadgpt_training.phrasebook import one_of

JOINTS: Mapping[str, Sequence[str]] = {
    "en": (
        ", then ", "; then ", ". Then ", ", and then ", ". After that, ", ". At its end: ", ", followed by ",
        "; after that, ", ". Next: ", ", next ", "; ", ", ", " - then ", " then ", ". Behind it: ", "\n",
        ". ", ". And after that ",
    ),
    "de": (
        ", dann ", "; dann ", ". Dann ", ". Danach ", ", danach ", ", und dann ", ". Am Ende davon: ",
        "; anschließend ", ". Dahinter ", "; ", ", ", " dann ", "\n", ". ", ", gefolgt von: ",
    ),
    "fr": (
        ", puis ", " puis ", ". Puis ", ". Ensuite, ", ", ensuite ", ", et ensuite ", ". Au bout : ",
        ". Après ça, ", "; ", ", ", "\n", ". ", "; après, ",
    ),
    "es": (
        ", luego ", ". Luego ", ", después ", ". Después, ", ", y después ", ". Al final: ", " y luego ",
        "; ", ", ", "\n", ". ", "; a continuación, ",
    ),
    "it": (
        ", poi ", ". Poi ", ", e poi ", ". Dopo, ", ", quindi ", ". Alla fine: ", " e poi ", "; ", ", ", "\n",
        ". ", "; dopo di che ",
    ),
}  # fmt: skip
"""Texts that join the descriptions of two parts of a route, by language."""
LONGEST = 330  # letters of a joined text
LONGEST_ROAD = 110  # letters of the description of one road
MOST_JUNCTIONS = 6
WHOLE_DRIVE = re.compile(
    r"\b(?:all|whole|entire|total|everything|everywhere|throughout|always|each|every|only|just|no|not|without|"
    r"never|end|ends|last|first|finally|start|starts|begin\w*|ganz\w*|alle\w*|insgesamt|immer|überall|nur|kein\w*|"
    r"nicht|ohne|ende|letzt\w*|erst\w*|start|anfang\w*|beginn\w*|tout\w*|tous|total\w*|toujours|partout|seul\w*|sans|"
    r"pas|fin|dernière?|premi\w+|début\w*|commence\w*|todo\w*|toda\w*|siempre|sólo|solo|sin|nada|fin\w*|últim\w+|"
    r"primer\w*|comienz\w*|empie\w*|inicio|tutt\w+|sempre|solo|senza|niente|fine|ultim\w+|prim\w+|inizi\w*|"
    r"\d+ in)\b",
    re.I,
)
"""Words that may speak of the whole drive, or of its beginning or end; texts with them are not joined."""
OF_ROADS = re.compile(
    r"bend|curve|hairpin|straight (?:for|of|road|bit|stretch|section)|corner|\bturns\b|chicane|winding|crest|"
    r"dip\b|switchback|kurve|kehre|bogen|serpentin|schikane|kuppe|senke|gerade \w*strecke|virage|courbe|"
    r"lacet|épingle|chicane|ligne droite|curva|tornant|rettili|horquilla|tramo recto|eses\b|esse\b",
    re.I,
)
"""Words that only describe roads; a text without such a word, as "turn left", may describe a junction."""
OWN_LENGTH = re.compile(
    r"\b(?:len|hills|climb|steepest|turns|lefts|rights|turning)=|starts\(|ends\(|\bhard\b"
)
OF_ALL = re.compile(r"\|\|\s*(beside\([^()]*\)|[^\s;|]+)")
OF_EVERY_ROAD = re.compile(r"@([^\s;|@]+)")


def routes(roads: Sequence[Pair], junctions: Sequence[Pair], rng: np.random.Generator) -> Iterator[Pair]:
    """Yields an endless series of routes of two or three parts. A hand-written text describes each part: a
    road without junctions, or a route with junctions. Yields nothing if no language has suitable pairs of
    both kinds.
    """
    of_roads = grouped(filter(_is_road, roads), lambda pair: pair.lang)
    of_junctions = grouped(filter(_is_open, junctions), lambda pair: pair.lang)
    languages = [code for code in JOINTS if of_roads.get(code) and of_junctions.get(code)]
    while languages:
        code = one_of(languages, rng) if rng.random() < 0.7 else languages[0]
        shape = one_of(("RJ", "JR", "JJ", "RJR", "RJJ", "JRJ"), rng)
        parts = [one_of((of_roads if kind == "R" else of_junctions)[code], rng) for kind in shape]
        if pair := route_of(parts, code, rng):
            yield pair


def route_of(parts: Sequence[Pair], language: str, rng: np.random.Generator) -> Pair | None:
    """Returns one pair with the joined texts, such as "... then ...", and the joined plans. Returns None if
    the text is longer than 330 letters, or if the route is impossible or has more than six junctions.
    """
    text = parts[0].text.strip()
    for part in parts[1:]:
        joint, said = one_of(JOINTS[language], rng), part.text.strip()
        is_new = joint.endswith((". ", "\n", ": "))
        text = text.rstrip(" .!") + joint + (said if is_new else _lowered(said, language))
    if len(text) > LONGEST:
        return None
    try:
        plan = _standard_route(" // ".join(part.plan for part in parts))
    except (Discarded, RoadGPTError):
        return None
    return Pair(text, plan, "networks/routes", language)


def _standard_route(line: str) -> str:
    """Returns a plan of a route in standard form. Raises BriefError if the plan is impossible, and Discarded
    if it has too many junctions.
    """
    brief = read_plan(line)
    check(brief, map_size=None)
    if len(brief.junctions) > MOST_JUNCTIONS:
        raise Discarded
    return standard(brief)


def _lowered(text: str, language: str) -> str:
    keeps = not text[:1].isupper() or text[1:2].isupper() or text[1:2] in "-' " or language == "de"
    return text if keeps else text[:1].lower() + text[1:]


def _is_road(pair: Pair) -> bool:
    """Returns whether a pair describes a road that can be a part of a route."""
    return (
        not pair.is_change
        and len(pair.text) <= LONGEST_ROAD
        and not pair.plan.startswith(("!", "|"))
        and not pair.text.rstrip().endswith("?")
        and "beside(" not in pair.plan
        and not is_of_junctions(pair.plan)
        and not OWN_LENGTH.search(pair.plan)
        and not WHOLE_DRIVE.search(pair.text)
        and OF_ROADS.search(pair.text) is not None
    )


def _is_open(pair: Pair) -> bool:
    """Returns whether a pair describes a route that begins and ends with a junction and can go on."""
    if pair.plan.startswith(("!", "map")) or "||" in pair.plan:
        return False
    parts = [part.strip() for part in pair.plan.split("//")]
    return (
        is_of_junctions(parts[0])
        and is_of_junctions(parts[-1])
        and not parts[-1].startswith(("merge", "diverge", "lane_"))
        and " back" not in parts[-1]
        and not WHOLE_DRIVE.search(pair.text)
        and not pair.text.rstrip().endswith("?")
    )


def assembled_route(raw: str) -> str:
    """Returns the plan that the grammar rules wrote, in standard form. If the rules wrote a refusal, returns
    only the refusal.

    Raises:
        Discarded: the plan has more than six junctions, a part between two ``//`` names several kinds of
            junction, or a clause of a road does not name exactly one kind of element.
        RoadGPTError: the plan cannot be read, or demands something impossible.
    """
    if refusal := REFUSAL.search(raw):
        return refusal[0]
    of_all, rest = OF_ALL.findall(raw), OF_ALL.sub(" ", raw)
    everywhere, rest = OF_EVERY_ROAD.findall(rest), OF_EVERY_ROAD.sub(" ", rest)
    parts = [part for part in (_part(each) for each in rest.split("//")) if part]
    if everywhere:
        parts = _on_every_road(parts, everywhere)
    line = " // ".join(parts)
    return _standard_route(f"{line} || {' '.join(dict.fromkeys(of_all))}" if of_all else line)


def _part(raw: str) -> str:
    """Returns a road or a junction in the order of words in which plans are written."""
    words = [word for word in raw.split() if not word.endswith("=")]
    if words[:1] == ["map"]:
        return " ".join(words)
    kinds = [word for word in words if is_of_junctions(word)]
    if not kinds:
        return road_of(raw)
    if len(kinds) > 1:
        raise Discarded
    return " ".join(dict.fromkeys([*kinds, *words]))


def _on_every_road(parts: list[str], wishes: list[str]) -> list[str]:
    """Adds requirements to every road, also to those of which the text says nothing else."""
    added = " ".join(dict.fromkeys(wishes))
    out: list[str] = []
    is_road = False
    for part in parts:
        if is_of_junctions(part):
            out += [part] if is_road else [f"| {added}", part]
        else:
            out.append(f"{part} {added}" if "|" in part else f"{part} | {added}")
        is_road = not is_of_junctions(part)
    return out if is_road else [*out, f"| {added}"]


draw_route = partial(
    draw, symbol="networks", phrases="networks", plan_of=assembled_route, family="networks/generated"
)
"""Draws a description of a route or map."""
