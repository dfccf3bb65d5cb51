"""Finds the size of the map that a description asks for: "on a map of 500 m by 500 m", in five languages.

The readers take a length for one of a road; so the size is taken out of the words before they are read.
"""

import re
from typing import NamedTuple

from roadgpt.brief.map_fit import LARGEST_MAP
from roadgpt.errors import BriefError

SMALLEST_MAP = 50.0  # metres
MAP = r"(?:maps?|karten?|landkarten?|cartes?|mapas?|mapp[ae])"
GROUND = (
    r"(?:areas?|sites?|plots?|terrains?|grounds?|fl[äa]chen?|gel[äa]nden?|areale?n?|gebiet(?:en|es)?|zones?|"
    r"surfaces?|terrenos?|[áa]reas?|zonas?|terren[oi]|zon[ae])"
)
ON = r"(?:on|onto|in|inside|within|over|auf|innerhalb|sur|dans|en|sobre|dentro de|su|sopra)"
ARTICLE = r"(?:an?|the|one|die|il|eine[rmn]?|der|dem|une?|la|le|una?|uno|el)"
OF = r"(?:(?:of|with|that is|measuring|von|mit|de|di|d[ae]|size|sized|que mide|mesurant) )*"
UNIT = (
    r"(?:km|kilomet(?:er|re)s?n?|kil[óo]metros?|chilometr[oi]|kilom[èe]tres?|"
    r"m|met(?:er|re)s?n?|m[èe]tres?|metros?|metri)"
)
NUMBER = r"(\d+(?:[.,]\d+)?)"
METRES = rf"{NUMBER}[ -]?({UNIT})\b"
BY = r"\s*(?:x|×|\*|by|mal|auf|sur|per|por)\s*"
TWO = rf"{NUMBER}(?:[ -]?({UNIT})\b)?{BY}{METRES}"
SQUARE = (
    r"(?:square|wide|across|on each side|im quadrat|breite?[ns]?|gro(?:ß|ss)e?[ns]?|de c[ôo]t[ée]|de large|"
    r"de lado|cuadrad[oa]s?|di lato|quadrat[oa])"
)
SIZE = (
    r"(?:(?:map|site|area) size|kartengr[öo](?:ß|ss)e|gr[öo](?:ß|ss)e der karte|taille de (?:la )?carte|"
    r"tama[ñn]o del? mapa|dimensione della mappa)"
)
IS = r"(?::|(?: is| has| measures| ist| misst| hat| fait| mesure| mide| tiene| es| misura| [eè] di| [eè]))"
FORMS = tuple(
    re.compile(form, re.IGNORECASE)
    for form in (
        rf"(?P<on>(?:\b{ARTICLE} |\bour |\bmy )?\b{MAP}{IS} {OF})(?P<rest>){TWO}(?: {SQUARE})?",
        rf"(?P<on>(?:\b{ARTICLE} |\bour |\bmy )?\b{MAP}{IS} {OF})(?P<rest>){METRES} {SQUARE}",
        rf"(?P<on>\b{ON} )?(?P<rest>\b(?:{ARTICLE} )?(?:{MAP}|{GROUND})) {OF}{TWO}(?: {SQUARE})?",
        rf"(?P<on>\b{ON} )?(?P<rest>\b(?:{ARTICLE} )?(?:{MAP}|{GROUND})) {OF}{METRES} {SQUARE}",
        rf"(?P<on>\b{ON} )?(?P<rest>\b(?:{ARTICLE} )?){TWO}[ -](?:{SQUARE} )?(?P<noun>{MAP}|{GROUND})",
        rf"(?P<on>\b{ON} )?(?P<rest>\b(?:{ARTICLE} )?){METRES}[ -]{SQUARE} (?P<noun>{MAP}|{GROUND})",
        rf"(?P<on>\b{ON} )(?P<rest>(?:{ARTICLE} )?{MAP}) {OF}{METRES}(?! (?:of|de|von|di)\b)",
        rf"(?P<on>\b{ON} )(?P<rest>(?:{ARTICLE} )?){METRES}[ -](?P<noun>{MAP})",
        rf"(?P<on>(?:^|(?<=[.;] ))(?:{ARTICLE} )?)(?P<rest>){METRES}[ -]{MAP}(?=[,.;:])",
        rf"(?P<on>\b{SIZE}(?: of| von| de| di|:| =| is)? )(?P<rest>){TWO}",
        rf"(?P<on>\b{SIZE}(?: of| von| de| di|:| =| is)? )(?P<rest>){METRES}",
    )
)
ONLY_SIZE = "this gives only the size of the map; say what the road should be like, such as 'two sharp turns'"
LOOSE = re.compile(r"^[\s,;:.]+|[,;:]\s*(?=[,;:.!?]|$)|\s+(?=[,.;:!?])")
"""Spaces and marks that are left over where words were taken out."""


class SizedMap(NamedTuple):
    """The size of a map, and the rest of the words."""

    metres: float
    """The side of the square map; of two different sides, the shorter one."""
    rest: str


def said_map_size(words: str) -> SizedMap | None:
    """Returns the size of the map that words ask for; None if they give none.

    "On a map of 500 m by 500 m" is taken out; of "a map of 500 m by 500 m with two crossroads", its size.

    Raises:
        BriefError: no map may have this size, or the words say nothing else.
    """
    found = next(filter(None, (form.search(words) for form in FORMS)), None)
    if found is None:
        return None
    groups = found.groupdict()
    numbers = [each for each in found.groups() if each and re.fullmatch(r"[\d.,]+", each)]
    units = [each for each in found.groups() if each and re.fullmatch(UNIT, each, re.IGNORECASE)]
    metres = min(
        float(number.replace(",", ".")) * _metres(units[min(n, len(units) - 1)])
        for n, number in enumerate(numbers)
    )
    if not SMALLEST_MAP <= metres <= LARGEST_MAP:
        limits = f"{SMALLEST_MAP:g} to {LARGEST_MAP:g} m"
        raise BriefError(f"a map of {metres:g} m by {metres:g} m cannot be made; ask for one of {limits}")
    noun = f"{groups['rest']}{groups.get('noun') or ''}" if groups["on"] is None else ""
    rest = LOOSE.sub("", f"{words[: found.start()]}{noun}{words[found.end() :]}").strip()
    if not re.search(r"\w", rest):
        raise BriefError(ONLY_SIZE)
    return SizedMap(metres, rest)


def _metres(unit: str) -> float:
    return 1000.0 if unit.lower().startswith(("k", "chil")) else 1.0
