"""What words say of maps without a route: that a map is meant, and how many dead ends or blocks it has."""

import re
from collections.abc import Sequence

from roadgpt.brief.amount import Amount, exactly
from roadgpt.brief.junctions import ARMS
from roadgpt.brief.map_clause import MapClause
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.slots import SlottedText

ONLY_A_MAP = re.compile(
    r"\b(?:map only|(?:only|just) (?:a|the) map|(?:no|without (?:a |any )?) ?routes?|"
    r"nur (?:eine |die )?karte|(?:keine|ohne) (?:route|strecke)|"
    r"(?:carte|plan|reseau) sans|sans (?:itineraire|parcours|trajet)|pas d ' itineraire|"
    r"(?:seulement|juste) (?:une|la) carte|(?:mapa|plano|red) sin|sin (?:ruta|recorrido|itinerario)|"
    r"solo (?:un|el) mapa|(?:mappa|rete) senza|senza (?:percorso|itinerario)|solo (?:una|la) mappa)\b"
)
MAPS = re.compile(
    r"\b(?:maps?|networks?|towns?|villages?|hamlet|\w*karten?|\w*netz|\w*dorf|\w*stadt|carte|plan|reseau|village|"
    r"hameau|ville|mapa|plano|pueblo|aldea|mappa|pianta|rete|paese|borgo)\b"
)
ONE = r"one|single|ein(?:e[nm]?|zige\w*)?|une?|seul|un[ao]?|solo"
NONE = r"no|without(?: any)?|kein\w*|ohne|aucune?|pas d '|sans|ningun\w*|sin|nessun\w*|senza"
DEAD_ENDS = re.compile(
    rf"\b(\d+|{NONE}) (?:\w+ )?(?:dead(?: -)? ends?|cul - de - sacs?|sackgassen?|impasses?|"
    r"(?:callejon\w*|calles?) sin salida|vicol[io] ciec(?:o|hi)|strad[ae] senza uscita)\b"
)
BLOCKS = re.compile(
    rf"\b(\d+|{NONE}|{ONE}) (?:\w+ )?(?:blocks?|(?:hauser)?blocke?|ilots?|manzanas?|isolat[oi])\b"
)
BY = re.compile(r"\b(\d+) (?:by|x|mal|auf|per|por|sur) (\d+)\b")
IN_A_ROW = re.compile(
    r"\bin (?:one|1|a|single|einer|una) (?:single |einzigen )?(?:row|reihe|fila)\b|en (?:une )?rangee"
)
ACROSS = re.compile(
    r"\b(?:by|across|columns?|rows?|mal|auf|spalten?|colonn\w+|filas?|righ[ae]|sur|por|per|deep|high|north|"
    r"south|each|long|len\w*|lang|x)\b"
)
"""Words of grids that may have more blocks than the number in the text."""
SIDE_STREETS = re.compile(
    r"side (?:streets?|roads?)|(?:seiten|neben)strassen?|rues? (?:laterale|secondaire|transversale)s?|"
    r"(?:calles?|laterales) (?:laterales|secundarias)?|(?:strade|vie) (?:laterali|secondarie)|laterali"
)
TREE = re.compile(
    r"dead(?: -)? end|end dead|cul - de - sac|sackgasse|impasse|sin salida|ciechi|cieco|senza uscita"
)


def asks_for_map(text: SlottedText) -> bool:
    """Returns whether a description says that it wants a map without a route."""
    said = _said(text)
    return ONLY_A_MAP.search(said) is not None and MAPS.search(said) is not None


def with_counted_map(brief: Brief, text: SlottedText) -> Brief:
    """Returns a map with the numbers of blocks and dead ends that follow from the words; other Briefs as they
    are.

    Of a map of junctions, the number of dead ends follows from that of blocks. A main street with side
    streets that are dead ends encloses no block. Where the words give several numbers, the plan keeps its
    own.
    """
    asked = brief.map
    if asked is None:
        return brief
    said = _said(text)
    dead_ends = _only_number(DEAD_ENDS.findall(said))
    if asked.dead_ends is not None and not asked.dead_ends.exact:  # "at least two"
        dead_ends = None
    elif asked.junctions and dead_ends is None:
        dead_ends = _around_blocks(asked, said)
    update = {} if asked.junctions else _blocks(asked, said)
    if dead_ends is not None:
        update["dead_ends"] = exactly(dead_ends)
    return brief.model_copy(update={"map": asked.model_copy(update=update)})


def _blocks(asked: MapClause, said: str) -> dict[str, Amount]:
    """Returns the columns and rows of a grid if the words leave no doubt about them: "two by three", "four
    blocks in a row", "a single block".
    """
    found = {(int(columns), int(rows)) for columns, rows in BY.findall(said)}
    number = _only_number(BLOCKS.findall(said))
    if len(found) == 1:
        columns, rows = found.pop()
    elif number and not found and (IN_A_ROW.search(said) or (number == 1 and not ACROSS.search(said))):
        columns, rows = number, 1
    else:
        return {}
    is_turned = asked.columns == exactly(rows) and asked.rows == exactly(columns)
    return {} if is_turned else {"columns": exactly(columns), "rows": exactly(rows)}


def _around_blocks(asked: MapClause, said: str) -> int | None:
    """Returns how many dead ends a map has, from its number of blocks; None if this number is not known."""
    is_tree = SIDE_STREETS.search(said) and TREE.search(said)
    blocks = 0 if is_tree else _only_number(BLOCKS.findall(said))
    if blocks is None or any(not each.count.exact or _arms(each.kind) is None for each in asked.junctions):
        return None
    number = sum(int(each.count.lo or 0) for each in asked.junctions)
    ends = sum(int(each.count.lo or 0) * (_arms(each.kind) or 0) for each in asked.junctions)
    # blocks = roads - nodes + 1, where each dead end is a node and half a road's ends
    dead_ends = ends - 2 * number + 2 - 2 * blocks
    return dead_ends if dead_ends >= 0 else None


def _arms(kind: str) -> int | None:
    """Returns how many roads meet at a kind of junction; None if that is open."""
    least, most = next((each.lo, each.hi) for name, each in ARMS.items() if name == kind)
    return int(least) if least == most else None


def _only_number(found: Sequence[str]) -> int | None:
    numbers = {int(each) if each.isdecimal() else int(re.fullmatch(ONE, each) is not None) for each in found}
    return numbers.pop() if len(numbers) == 1 else None


def _said(text: SlottedText) -> str:
    """Returns the words in lower case without accents, with small numbers as figures."""
    return " ".join(word.text for word in text.words)
