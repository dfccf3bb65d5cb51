"""Finds what words say about the signs and lights of a map: at how many junctions they stand.

two of them have lights; lights at one junction; all crossroads but one have stop signs
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from roadgpt.brief.amount import Amount, exactly
from roadgpt.brief.junctions import Control
from roadgpt.brief.readers.model.denial import DENIAL, TAKEN_BACK
from roadgpt.brief.readers.model.junction_nouns import ANY_KIND, PLURAL
from roadgpt.brief.readers.model.ordinals import ALL, EXCEPT, OF_THEM, ONLY, REST

SIGN_WORDS: Mapping[Control, str] = {
    "lights": (
        r"(?:(?:traffic )?(?:lights?|signals?)|ampeln?(?:anlagen?)?|lichtsignal\w*|feux(?: tricolores)?|"
        r"semafor\w*)"
    ),
    "stop": (
        r"(?:stop signs?|stopp?schild\w*|stopp? - schild\w*|panneaux? (?:de )?stop|senal(?:es)? de stop|"
        r"segnal[ei] di stop|stops?)"
    ),
    "yield": (
        r"(?:(?:give - way|yield) signs?|vorfahrt - (?:gewahren|achten) - schild\w*|cedez - le - passage|"
        r"ceda el paso|(?:segnal[ei] di )?dare (?:la )?precedenza)"
    ),
}
"""What stands at a junction, in a text in lower case without accents."""
PLURALS = rf"(?:{PLURAL}|{ANY_KIND}|stars|sterne|etoiles|estrellas|stelle)"
SINGULARS = (
    r"(?:cross ?-? ?roads?|(?:[ty] - )?(?:junction|crossing|intersection)|corner|node|fork|roundabout|"
    r"kreuzung|einmundung|knoten(?:punkt)?|ecke|gabelung|kreisverkehr|kreisel|carrefour|croisement|intersection|"
    r"rond - point|giratoire|fourche|bifurcation|cruce|interseccion|esquina|rotonda|glorieta|bifurcacion|"
    r"incrocio|intersezione|angolo|nodo|bivio)"
)
OF = (
    r"(?:others?|of|them|which|these|those|the|its|davon|von|der|ihnen|denen|dont|d|'|entre|elles|eux|de|des|"
    r"ellos|ellas|los|las|cuales|di|dei|degli|delle|quali|queste|questi|esse|essi|loro)"
)
BETWEEN = rf"((?: (?:{OF}|{PLURALS}|{SINGULARS})\b){{0,5}})"
"""The words that may stand between a number of junctions and their signs."""
HAVE = (
    r"(?:with|have|has|having|gets?|mit|haben|hat|bekommen|bekommt|avec|ont|a|con|tienen?|llevan?|hanno|ha)"
)
ARTICLE = (
    r"(?:the |an? |a set of |eine[rn]? |ein |des |les |un |une |uno |una |"
    r"unos |unas |los |i |il |el |le |la |lo |dei |degli )?"
)
ONE = r"(?:(?:one|a single|an?|ein(?:e[rnms]?)?|une?|un seul|une seule|un[oa]|un solo|una sola)\b)"
ARTICLES = ("a", "an", "ein", "eine", "einer", "einem", "un", "une", "uno", "una")
SOLE = r"(?:un seul|une seule|un solo|uno solo|una sola)"
SIGNALLED = r"(?:signalled|signalised|signalized|semaforizad\w+)"
EACH = r"(?<!every )(?<!each )(?<!any )(?<!only )(?<!more )"
AT = r"(?:at|on|an|bei|aux?|a|en|in)"
ARE = r"(?:there (?:is|are)|stehen|steht|gibt es|hangen|hangt|il y a|hay|ci sono|c ' e)"
EVERYWHERE = re.compile(rf"\b(?:{ALL}|each|throughout|both|beide\w*|chaque|chacune?|cada|ciascun\w*)\b")
EVERY_STREET = re.compile(
    rf"\b{ALL} (?:the |of the |die |les |las |los |le )?(?:roads?|streets?|stra(?:ss|ß)en?|wege?|routes?|"
    r"rues?|calles?|carreteras?|strad[ae]|vie)\b"
)
"""Words for all streets; such words do not mean that all junctions have a sign."""
LEAST = re.compile(r"\b(?:at least|mindestens|au moins|al menos|por lo menos|almeno)$")
MOST = re.compile(
    r"\b(?:at most|no more than|up to|hochstens|maximal|bis zu|au plus|como mucho|a lo sumo|al massimo)$"
)
NO_NUMBER = re.compile(rf"(?<!, )\b(?:{EXCEPT}(?: (?:{AT}|the))?|x|by|mal|sur|por|per)$")
"""Words before a number that show that the number does not count the junctions with a sign."""
OTHERS_HAVE_NONE = re.compile(rf"\b{REST}\b(?: \w+){{0,3}} {DENIAL}\b[^.;]*")

LIMITED = (
    rf"(?:only|just|nur|lediglich|seulement|uniquement|solo|solamente|soltanto|"
    rf"{EXCEPT} (?:{AT}|\d+|{ONE}|the|in|der|dem|den|le|la|el|il|alla|nella)|half|halfte|moitie|mitad|"
    r"meta|some|einige\w*|manche\w*|certains?|certaines|quelques|algun[ao]s|alcun[ie]|qualche|most|meisten|"
    r"plupart|mayoria|maggior parte|middle|mitte|mittleren?|milieu|centro|mezzo|davon|dont)"
)
"""Words that limit signs to some of the junctions."""


@dataclass(frozen=True)
class CountedSigns:
    """A number of junctions with one sign, as words say it."""

    control: Control
    number: int
    amount: Amount
    """The number with the bound that the words give, such as "at least"."""
    nouns: str
    """The words for these junctions behind the number; empty if there are none."""


@dataclass(frozen=True)
class SignsInWords:
    """What words say about the signs at a number of junctions."""

    counted: tuple[CountedSigns, ...] = ()
    all_but: CountedSigns | None = None
    """A number of junctions without the sign that all others have."""
    others: Control | None = None
    """The sign of all other junctions."""
    of_kinds: tuple[tuple[Control, str], ...] = ()
    """Signs of all junctions of a kind, with the noun of the kind: "lights at the crossroads only"."""


def signs_in_words(said: str) -> SignsInWords:
    """Returns what words say about the signs at a number of junctions of a map.

    ``counted`` has only signs for which the words give exactly one number of junctions. The result is empty
    if the words take something back. The argument ``said`` is a result of ``said_of``.
    """
    if TAKEN_BACK.search(said):
        return SignsInWords()
    said = OTHERS_HAVE_NONE.sub(" ", _without_double_denial(said))
    all_but = [each for control in SIGN_WORDS if (each := _all_but(control, said)) is not None]
    named = {each.control for each in all_but}
    counted = [
        each
        for control in SIGN_WORDS
        if control not in named and not _is_denied(control, said)
        if (each := _counted(control, said)) is not None
    ]
    others = [control for control in SIGN_WORDS if _others(control).search(said)]
    placed = named | {each.control for each in counted} | {*others}
    of_kinds = [
        (control, match["noun"] or match["before"])
        for control in SIGN_WORDS
        if control not in placed and not _is_denied(control, said)
        for match in _at_kinds(control).finditer(said)
    ]
    return SignsInWords(
        tuple(counted),
        all_but[0] if len(all_but) == 1 else None,
        others[0] if len(others) == 1 and not named & {*others} else None,
        tuple(of_kinds),
    )


def limits_signs(said: str) -> bool:
    """Returns whether some words seem to limit a sign to a part of the junctions: "only the roundabout has
    lights", "stop signs at half of them".
    """
    if EVERYWHERE.search(said) and re.search(rf"\b{EXCEPT}\b", said) is None:
        return False
    return any(
        re.search(rf"\b{LIMITED}\b[^.;:]{{0,40}}\b{sign}\b|\b{sign}\b[^.;:]{{0,25}}\b{LIMITED}\b", said)
        for sign in SIGN_WORDS.values()
    )


def _without_double_denial(said: str) -> str:
    """Returns "lights at two of them" for "no lights except at two of them"."""
    for sign in SIGN_WORDS.values():
        denied = rf"\b{DENIAL} (?:\w+ )?({sign}) ?,? {EXCEPT} (?={AT} )"
        said = re.sub(denied, r"\1 ", said)
    return said


@cache
def _others(control: Control) -> re.Pattern[str]:
    nouns = rf"(?: (?:ones?|{PLURALS}|{SINGULARS}|{OF}))"
    return re.compile(
        rf"(?:\b{REST}{nouns}{{0,3}},? (?:all )?{HAVE} {ARTICLE}{SIGN_WORDS[control]}|"
        rf"\b{SIGN_WORDS[control]} {AT} (?:\w+ )?{REST})\b"
    )


@cache
def _at_kinds(control: Control) -> re.Pattern[str]:
    both = r"both|beiden?|amb[oa]s|entramb[ie]"
    the = rf"(?:{both}|the|der|die|den|dem|am|aux?|le|la|les|el|al|los|las|il|alla|gli|i|alle|agli|ai)"
    noun, alone = rf"({SINGULARS}|{PLURALS})", "only|alone|nur|seulement|solamente|solo|soltanto"
    end = rf"(?= (?:{alone}|and|und|et|y|e|[.,;])(?: |$)|$)"
    sign, have = SIGN_WORDS[control], rf"{HAVE} {ARTICLE}{SIGN_WORDS[control]}\b"
    return re.compile(
        rf"\b{sign} {ONLY}?(?:{AT} )?{the} (?P<noun>{noun}){end}|\b(?:{both}) (?P<before>{noun}) {have}"
    )


@cache
def _is_of_all(control: Control) -> re.Pattern[str]:
    sign = SIGN_WORDS[control]
    but = rf"{EXCEPT} (?:{AT} )?(?:the )?(\d+|{ONE})\b{BETWEEN}"
    return re.compile(
        rf"\b{ALL}\b[^.;:,]{{0,40}}? {but} ?,? {HAVE} {ARTICLE}{sign}\b|"
        rf"\b{sign}\b[^.;:,]{{0,25}}? {ALL}\b[^.;:,]{{0,40}}? {but}|"
        rf"\b{AT} {ALL}\b[^.;:,]{{0,40}}? {but} {ARE} {ARTICLE}{sign}\b"
        + (rf"|\b{ALL}\b[^.;:,]{{0,40}}? {but} ?,? (?:\w+ )?{SIGNALLED}\b" if control == "lights" else "")
    )


def _all_but(control: Control, said: str) -> CountedSigns | None:
    """Returns the number of junctions without a sign that all others have; None if the words do not say."""
    found = [*_is_of_all(control).finditer(said)]
    if len(found) != 1:
        return None
    number, nouns = (group for group in found[0].groups() if group is not None)
    return _of(control, number, nouns, "")


@cache
def _forms(control: Control) -> tuple[tuple[re.Pattern[str], ...], ...]:
    """Returns the forms of words that count junctions with a sign: those in which the junctions stand behind
    the sign, and those in which they stand before it. Each form has a number and the words behind it.
    """
    sign = SIGN_WORDS[control]
    noun = rf"(?:{SINGULARS}|{PLURALS})\b"
    number, one = rf"(\d+){BETWEEN}", rf"(?:l ' )?({ONE})((?: {OF}){{0,3}} {noun})"
    only = rf"{ONLY}(?:{AT} )?((?!an? (?!single)){ONE})((?: {OF}){{0,3}}(?: {noun})?)"
    of_them, of_which = rf"({ONE}) {OF_THEM}()", rf"(?:dont|davon|of which) ({ONE})()"
    have, ends = rf",? {HAVE} {ARTICLE}{sign}\b", r"(?! \w+s\b(?<! others))"
    are = rf"{ARE} {ARTICLE}{sign}\b"
    behind = (
        rf"\b{sign} {ONLY}?{AT} {ONLY}?{number}{ends}",
        rf"\b{sign} {AT} {one}",
        rf"\b{sign} (?:{AT} )?{only}{ends}",
        rf"\b{sign} {AT} (?:l ' )?{of_them}",
    )
    before = (
        rf"\b{AT} {ONLY}?{number} {are}",
        rf"\b{AT} {ONLY}?{one} {are}",
        rf"\b{number}{have}",
        rf"{EACH}\b{one}{have}",
        rf"\b{only}{have}",
        rf"\b({SOLE})(){have}",
        rf"{EACH}\b{of_them}{have}",
        rf"\b{of_which}{have}",
        *([rf"\b{number} (?:are )?{SIGNALLED}\b"] if control == "lights" else []),
    )
    return tuple(map(re.compile, behind)), tuple(map(re.compile, before))


def _counted(control: Control, said: str) -> CountedSigns | None:
    """Returns the number of junctions with a sign; None if the words give no number, or several."""
    of_all = EVERYWHERE.search(EVERY_STREET.sub("", said))
    for forms in _forms(control):
        found: dict[int, re.Match[str]] = {}
        for match in (each for form in forms for each in form.finditer(said)):
            is_article = match[1] in ARTICLES and not match[0].startswith(tuple(ONLY[3:-1].split("|")))
            if not NO_NUMBER.search(said[: match.start(1)].strip()) and not (of_all and is_article):
                found.setdefault(match.start(1), match)
        if len(found) == 1:
            match = next(iter(found.values()))
            return _of(control, match[1], match[2], said[: match.start(1)].strip())
        if found:
            return None
    return None


def _of(control: Control, number: str, nouns: str, before: str) -> CountedSigns:
    """Returns a counted sign; ``before`` is the text before the number."""
    count = int(number) if number.isdecimal() else 1
    amount = (
        Amount(lo=count)
        if LEAST.search(before)
        else Amount(hi=count)
        if MOST.search(before)
        else exactly(count)
    )
    return CountedSigns(control, count, amount, nouns)


def _is_denied(control: Control, said: str) -> bool:
    return re.search(rf"\b{DENIAL} (?:\w+ )?{SIGN_WORDS[control]}\b", said) is not None
