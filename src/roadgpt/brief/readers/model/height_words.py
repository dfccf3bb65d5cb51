"""Reads heights in metres in change requests ("it should climb 8 m") by rules."""

import re
from typing import NamedTuple

from roadgpt.brief.readers.model.bounds import NOT, bound_before, bound_behind
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.word_set import word_set

UP = (
    r"climbs?|climbing|rises?|ascends?|goes? up|(?:an)?steigen|(?:an)?steigt|montent|monte|monter|grimpe\w*|"
    r"sub(?:an?|en?|ir|iendo)|sal(?:e|ga|gano|ire)"
)
DOWN = r"descends?|goes? down|abfallen|abfallt|descende|descendent|descendre|bajan?|bajen?|scenda|scendere"
RAISED = (
    r"raised?|lift(?:ed)?|higher|hoher|anheben|angehoben|rehauss\w*|relev\w*|plus haut\w*|mas alt[ao]|"
    r"alza\w*|rialza\w*|piu in alto"
)
LOWERED = r"lower(?:ed)?|tiefer|absenken|abgesenkt|abaiss\w*|plus bas\w*|mas baj[ao]|abbassa\w*|piu in basso"
GAINS = r"gains?|gagn\w*|gan[ae]\w*|guadagn\w*|gewinn\w*"
FALLS = r"falls?|drops?|loses?|losing|perd\w*|pierd\w*|verlier\w*"
BY_HEIGHT = (("=", GAINS), ("=-", FALLS))
"""Verbs that may mean a length as well; they count if the request names height."""
HEIGHT = re.compile(
    r"\b(?:height|altitude|elevation|hohe\w*|hauteur|denivele\w*|altura|desnivel|quota|dislivello)\b"
)
OTHER = re.compile(
    r"\b(?:long|longer|short|shorter|length|radius|tighter|wider|lang\w*|kurz\w*|radien|longueur|court\w*|"
    r"rayon|larg\w*|longitud|cort\w*|radio|lung\w*|raggio|distance|gap|size|section|"
    r"add|insert|append|put|mirror|swap|remove|reverse|another|then|and|und|et|e|y|puis|poi|each|every|"
    r"jede\w*|chaque|cada|ogni|more|less|mehr|weniger|moins|plus de|menos|meno|at least|at most|"
    r"below|under|mindestens|"
    r"unter|hochstens|como|sotto|not|no|non|nicht|pas|final|after|before|until|from|between|nach|vor|ab|bis|"
    r"apres|avant|despues|antes|hasta|dopo|prima|start|beginning|anfang|beginn|debut|depart|inicio|comienzo|"
    r"principio|inizio|partenza)\b"
)
"""Words with which the metres may be a length, a place or a limit, or with which more is asked for."""
ALONG = re.compile(
    r"\b(?:for|over|within|during|in|along|last|first|auf|uber|lang|letzten|ersten|sur|pendant|derniers|premiers|"
    r"en|a|an|the climb|climb of|durante|ultimos|primeros|per|su|nei|ultimi|primi) "
    r"(?:the |den |les |los |i )?(?:last |first )?\[unused"
)
"""Words before metres along the road: "climb over the last 80 m"."""
NAMED = re.compile(
    r"\b(?:turn|bend|curve|corner|hairpin|straight|stretch|part|half|kurve\w*|kehre\w*|gerade\w*|abschnitt\w*|"
    r"teil\w*|virage\w*|epingle\w*|droite|partie|troncon|curva\w*|horquilla\w*|recta\w*|tramo\w*|tornant\w*|"
    r"rettiline\w*|tratt\w*)\b"
)
"""Words for parts of a road."""

LOST = re.compile(rf"\b(?:{DOWN}|{FALLS}|falling|dropping|descend\w*|(?:ab)?fall\w*|baj\w*|scend\w*)\b")
GAINED = re.compile(
    rf"\b(?:{UP}|{RAISED}|{GAINS}|rising|risen|gain\w*|ascend\w*|sub[aei]\w*|sal[eigo]\w*|mont\w*|"
    r"(?:an)?steig\w*)\b"
)
OTHERWISE = NOT | word_set(
    "instead rather now statt anstatt jetzt bisher lieu plus maintenant vez ahora invece adesso ora"
)
"""Words with which a fall may be what is not wanted, or what the road does so far."""
BESIDE = re.compile(
    r"\b(?:mirror\w*|swap\w*|reverse\w*|remove\w*|spiegel\w*|tausch\w*|umdreh\w*|entfern\w*|miroir|"
    r"echang\w*|invers\w*|supprim\w*|espejo|intercambi\w*|invier\w*|quita\w*|specchi\w*|scambi\w*|"
    r"inverti\w*|togli\w*)\b"
)
"""Words for a further wish, which a plan of nothing but a climb leaves out."""
POSITIVE = re.compile(r"climb =(?=\d)")


class HeightWish(NamedTuple):
    """A climb in metres that a change request asks for."""

    value: str
    """The value as in a plan of changes: "=8", "=-3", "+5" or "-2"."""
    names_a_part: bool
    """Whether the request names a part of the road."""


def height_wish(text: SlottedText) -> HeightWish | None:
    """Returns the climb that a change request asks for.

    Returns None if it asks for no climb or for something else as well, if the metres are not the only number
    with a unit, or if a word may mean a length or a distance.
    """
    said = " ".join(word.text for word in text.words if word.written)
    metres = [slot.value for slot in text.slots if slot.unit == "metres"]
    if len(text.slots) != 1 or len(metres) != 1 or OTHER.search(said) or ALONG.search(said):
        return None
    verbs = [("=", UP), ("=-", DOWN), ("+", RAISED), ("-", LOWERED)]
    verbs += BY_HEIGHT if HEIGHT.search(said) else ()
    found = [sign for sign, words in verbs if re.search(rf"\b(?:{words})\b", said)]
    if len(found) != 1:
        return None
    return HeightWish(f"{found[0]}{metres[0]:g}", NAMED.search(said) is not None)


def with_sign(line: str, text: SlottedText) -> str:
    """Returns a plan of changes, with a negative climb if the words mention only a descent."""
    return POSITIVE.sub("climb =-", line) if _falls(text) is True else line


def is_doubtful_climb(line: str, text: SlottedText) -> bool:
    """Returns whether a plan has a climb that the words leave in doubt.

    The words give only a bound of it, or the metres may be those along the road, or they mention a descent
    together with an ascent, a negation or a word such as "instead"; or they have a further wish, which the
    plan leaves out.
    """
    words = [word.text for word in text.words]
    numbers = [place for place, word in enumerate(words) if word.startswith("[unused")]
    is_bounded = any(bound_before(words, place) or bound_behind(words, place) for place in numbers)
    # "let it climb for 20 m" may tell how far
    is_along = len(text.slots) == 1 and ALONG.search(" ".join(words)) is not None
    is_all = ";" not in line and BESIDE.search(" ".join(words)) is not None
    return ": climb" in line and (is_bounded or is_along or is_all or _falls(text) is None)


def _falls(text: SlottedText) -> bool | None:
    """Returns whether the words tell of lost height; None if they also speak of a gain or a denial."""
    said = " ".join(word.text for word in text.words)
    if not LOST.search(said):
        return False
    return None if GAINED.search(said) or OTHERWISE.intersection(said.split()) else True
