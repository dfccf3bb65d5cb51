"""How many junctions the words ask for, where their nouns leave little doubt."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from roadgpt.brief.junctions import LANE_KINDS, NAMES, RAMPS
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.word_set import word_set

ONE = word_set(
    "junction intersection crossing crossroad roundabout fork rotary kreuzung strassenkreuzung",
    "ampelkreuzung einmundung gabelung kreisverkehr abzweigung knotenpunkt carrefour croisement giratoire",
    "fourche bifurcation jonction cruce interseccion rotonda glorieta bifurcacion encrucijada nudo",
    "incrocio rotatoria bivio nodo",
)
"""Nouns for one junction, in lower case without accents."""
MANY = word_set(
    "junctions intersections roundabouts forks crossings kreuzungen ampelkreuzungen einmundungen",
    "gabelungen kreisverkehre abzweigungen knotenpunkte carrefours croisements giratoires fourches",
    "bifurcations jonctions cruces intersecciones rotondas glorietas bifurcaciones encrucijadas nudos",
    "incroci rotatorie bivi nodi",
)
"""Nouns for several junctions."""
BOTH = word_set("crossroads kreisel knoten intersections carrefours")
"""Nouns for one junction or several; their number decides."""
NOUNS = ONE | MANY | BOTH
OF_ANY_KIND = word_set(
    "junctions intersections crossings kreuzungen knoten knotenpunkte carrefours croisements jonctions",
    "cruces intersecciones nudos incroci nodi",
)
"""Plural nouns that may mean junctions of all kinds together."""
FURTHER = word_set(
    "next another other others more further again no not without none forget star turning second third",
    "fourth fifth times x zebra pedestrian level railway rail noch weitere weiteren weiterer nachste",
    "nachsten nachster wieder nicht kein keine keinen ohne nein stern andere anderen zweite zweiten",
    "zweiter dritte dritten zweimal dreimal mehrere autre autres encore prochain prochaine suivant",
    "suivante sans aucun aucune pas non etoile deuxieme troisieme quatrieme otro otra otros otras",
    "siguiente proximo proxima sin ningun ninguna estrella mas segundo segunda tercero tercera altro",
    "altra altri altre prossimo prossima successivo senza nessun nessuna stella piu secondo seconda terzo",
    "terza",
)
"""Words that may tell of a junction beside those that nouns name, or of fewer."""
LETTERS = ("t", "y", "x")
"""Junctions by their shapes."""
JOINT = "//"
NEAR = 2
"""How many words may stand between a number or a letter and its noun."""
STOPS = frozenset(",.;:()")


class Group(NamedTuple):
    """A noun for junctions in the text."""

    number: int | None
    """How many there are; None if the noun is a plural without a number."""
    noun: str


def number_said(text: SlottedText) -> int | None:
    """Returns the number of junctions on the route that the words ask for; None where they leave doubt.

    One noun is counted with its number. Of several nouns, the first is a total if it may mean junctions of
    every kind and the numbers of the others add up to it.
    """
    words = [word.text for word in text.words]
    groups = _groups(words)
    if len(groups) == 1:
        return None if _tells_of_more(words) else groups[0].number
    first, rest = (groups[0], [group.number or 0 for group in groups[1:]]) if groups else (None, [])
    is_total = first is not None and first.noun in OF_ANY_KIND and 0 not in rest
    return first.number if first and is_total and first.number == sum(rest) else None


def number_of(plan: Sequence[str]) -> int | None:
    """Returns the number of junctions in the tokens of a plan; None if it is no plan of a route, or one with
    ramps or changes of lanes, for which the words have other nouns.
    """
    kinds = kinds_of(plan)
    return len(kinds) if kinds and not {*RAMPS, *LANE_KINDS}.intersection(kinds) else None


def kinds_of(plan: Sequence[str]) -> list[str]:
    """Returns the kinds of the junctions in the tokens of a plan of a route, finished or not."""
    return [token for before, token in pairwise((JOINT, *plan)) if before == JOINT and token in NAMES]


def _groups(words: Sequence[str]) -> list[Group]:
    found = []
    for at, word in enumerate(words):
        if word in ("point", "points") and words[at - 2 : at] in (["rond", "-"], ["ronds", "-"]):
            word = "roundabouts" if "ronds" in words[at - 2 : at] or word == "points" else "roundabout"
        if word not in NOUNS:
            continue
        number = _number_before(words, at)
        is_many = word in MANY or (word in BOTH and number is not None and number > 1)
        found.append(Group(number if is_many else 1, word))
    return found


def _number_before(words: Sequence[str], at: int) -> int | None:
    """Returns the number that stands before a noun, with adjectives between at most; that of "four-way
    crossroads" is none.
    """
    for n in range(at - 1, max(-1, at - 2 - NEAR), -1):
        if words[n] in STOPS or (words[n] == "-" and words[n - 1] not in (*LETTERS, "rond", "ronds")):
            return None
        if words[n].isdecimal():
            return int(words[n])
    return None


def _tells_of_more(words: Sequence[str]) -> bool:
    """Returns whether there is a word that may tell of more junctions, or a letter without its noun."""
    nouns = [at for at, word in enumerate(words) if word in NOUNS or word.startswith("point")]
    letters = [at for at, word in enumerate(words) if word in LETTERS]
    is_bare = any(all(abs(at - noun) > NEAR for noun in nouns) for at in letters)
    return is_bare or not FURTHER.isdisjoint(words)
