"""Finds what a description asks for besides the shape of a road, in five languages: the size of the map,
traffic on the left, a motorway.

The readers take every length for a length of the road. The size of a map ("on a map of 500 m by 500 m") is
therefore removed from the words before a reader reads the words.
"""

import re
from itertools import pairwise

from roadgpt.brief.model import Brief
from roadgpt.brief.words import LARGEST_MAP, SMALLEST_MAP, unaccented
from roadgpt.errors import BriefError

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
MAP_SIZES = tuple(
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


def said_map_size(words: str) -> tuple[float, str] | None:
    """Returns the side in metres of the square map that words ask for (the shorter one, if they give two),
    and the other words; None if the words give no size.

    "On a map of 500 m by 500 m" is removed; "a map of 500 m by 500 m with two crossroads" only loses the
    size. Raises BriefError if no map may have this size, or if the words say nothing else.
    """
    found = next(filter(None, (form.search(words) for form in MAP_SIZES)), None)
    if found is None:
        return None
    groups = found.groupdict()
    numbers = [each for each in found.groups() if each and re.fullmatch(r"[\d.,]+", each)]
    factors = [
        1000.0 if each.lower().startswith(("k", "chil")) else 1.0
        for each in found.groups()
        if each and re.fullmatch(UNIT, each, re.IGNORECASE)
    ]
    metres = min(
        float(number.replace(",", ".")) * factors[min(n, len(factors) - 1)]
        for n, number in enumerate(numbers)
    )
    if not SMALLEST_MAP <= metres <= LARGEST_MAP:
        limits = f"{SMALLEST_MAP:g} to {LARGEST_MAP:g} m"
        raise BriefError(f"a map of {metres:g} m by {metres:g} m cannot be made; ask for one of {limits}")
    noun = f"{groups['rest']}{groups.get('noun') or ''}" if groups["on"] is None else ""
    rest = LOOSE.sub("", f"{words[: found.start()]}{noun}{words[found.end() :]}").strip()
    if not re.search(r"\w", rest):
        raise BriefError(ONLY_SIZE)
    return metres, rest


LEFT_HAND = re.compile(
    r"left[- ]?hand traffic|\blht\b|traffic (?:(?:is|keeps|drives|goes) )?(?:on the )?left\b(?! lane)|"
    r"\bdriv(?:e|es|ing) (?:on|to) the left\b(?! lane)|\bso on the left|"
    r"on the left(?:-hand)? side of the road like|wrong side,? ie the left|"
    r"linksverkehr|\bfahr(?:en|t) (?:sie |wir |man )?(?:links,|auf der linken (?:strassen)?seite)|"
    r"\b(?:conduite|circulation) a gauche|\b(?:roul|condui|circul)\w* a gauche|\btient la gauche|"
    r"\b(?:circul|conduc|condu[cz]|manej|transit|trafico)\w*(?: siempre)? por la izquierda|"
    r"\bguida\w* a sinistra|\b(?:si|che) (?:viaggia|guida|circola|tiene) (?:a |la |sulla )?sinistra|"
    r"\bbritish (?:rules|traffic)"
)
TRAFFIC = re.compile(r"traffic|verkehr|circulation|circulacion|circolazione|trafico")
FORK = re.compile(r"\b(?:bivio|biforcazione|fourche|bifurcation)\b")
"""Words for a fork, where "keep left" tells the way of the route instead of the driving side."""
NEGATED = re.compile(
    r"\b(?:no|not|without|never|kein|keinen|nicht|ohne|pas de|sans|sin|senza)\b(?:\s\w+)?\s*$"
)


def says_left_hand(words: str) -> bool:
    """Returns True if a description in one of the five languages asks for traffic that drives on the left."""
    said = unaccented(words)
    is_at_fork = FORK.search(said) is not None
    return any(
        not NEGATED.search(said[: each.start()]) and not (is_at_fork and "tien" in each[0])
        for each in LEFT_HAND.finditer(said)
    )


def with_driving_side(brief: Brief, words: str) -> Brief:
    """Returns the Brief with traffic on the left if the Brief or the words ask for it; otherwise unchanged.

    The phrase "left-hand traffic" does not ask for other cars. If no other word of the description asks for
    cars, "traffic" is removed from ``beside``, the things that are mentioned but not required.
    """
    if not (brief.left_hand or says_left_hand(words)):
        return brief
    has_others = TRAFFIC.search(LEFT_HAND.sub(" ", unaccented(words))) is not None
    beside = tuple(name for name in brief.beside if has_others or name != "traffic")
    return brief.model_copy(update={"left_hand": True, "beside": beside})


def _bag(*lines: str) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split())


MOTORWAYS = _bag(
    "motorway motorways freeway freeways expressway expressways highway highways interstate turnpike",
    "autobahn autobahnen schnellstrasse schnellstraße kraftfahrstrasse kraftfahrstraße autoroute autoroutes",
    "autopista autopistas autovia autovias autostrada autostrade superstrada superstrade",
)
PAIRS = frozenset([("voie", "rapide"), ("voies", "rapides")])
NOT_ONE = _bag(
    "no not without off from to towards toward near beside leaving leave join joining over under",
    "kein keine keiner ohne neben zur zum von pas sans vers quitter sin hacia junto senza verso accanto non",
)
"""Words, up to three before "motorway", that say that the road is no motorway or only near a motorway."""
WORDS_BEFORE = 3  # how many words before "motorway" are searched for NOT_ONE
PARTS_OF_ONE = _bag(
    "exit exits ramp ramps slip interchange junction entrance bridge services ausfahrt auffahrt"
)
"""Words that, right after "motorway", name only a part of it, such as a ramp or a bridge."""


def says_motorway(words: str) -> bool:
    """Returns True if a description in English, German, French, Spanish or Italian asks for a motorway."""
    said = re.findall(r"[^\W\d_]+", unaccented(words))
    for at, (word, after) in enumerate(pairwise([*said, ""])):
        is_pair = (word, after) in PAIRS
        if is_pair or word in MOTORWAYS:
            follows = "".join(said[at + 2 : at + 3]) if is_pair else after
            if follows not in PARTS_OF_ONE and not NOT_ONE & {*said[max(at - WORDS_BEFORE, 0) : at]}:
                return True
    return False
