"""Computes figures that are said by an earlier one: in "40 m, a bend, and a straight twice as long", the last
straight is 80 m long, and so is "a straight 40 m longer than the first".

The network only copies numbers, so it cannot compute them. A multiple is left as it is if its value is
ambiguous, or if the words also give the figure ("twice as long, that is 80 m").
"""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roadgpt.brief.readers.model.measures import Number, is_radius
from roadgpt.brief.readers.model.units import Unit

FACTORS = {
    "half": 0.5, "twice": 2, "double": 2, "thrice": 3, "triple": 3,
    "halb": 0.5, "halbe": 0.5, "halben": 0.5, "halber": 0.5, "halbem": 0.5,
    "doppelter": 2, "doppeltem": 2, "doppelt": 2, "doppelte": 2, "doppelten": 2, "zweimal": 2,
    "dreimal": 3, "dreifach": 3, "dreifache": 3, "dreifachen": 3, "viermal": 4,
    "moitie": 0.5, "mitad": 0.5, "meta": 0.5, "doble": 2, "doppio": 2, "triplo": 3,
}  # fmt: skip
LENGTHS = "long|length|lang|lange|langen|laenge|longue|longueur|larga|largo|longitud|lunga|lungo|lunghezza"
ANGLES = "angle|winkel|angulo|angolo|degrees|grad|degres|grados|gradi"
GRADES = (
    "steep|steeply|grade|gradient|slope|steil|steigung|gefalle|raide|pente|empinada|empinado|pendiente|ripida"
    "|ripido|pendenza"
)
RADII = "radius|radii|halbmesser|rayon|radio|raggio"
SIZES = "far|weit|loin|lejos|much|viel"
KINDS: tuple[tuple[str, Unit], ...] = ((LENGTHS, "metres"), (ANGLES, "degrees"), (GRADES, "percent"))
NAMED = f"(?P<what>{LENGTHS}|{ANGLES}|{GRADES}|{SIZES})"
TIMES = r"(?P<times>{[^}]*}) (?:times|mal|fois|veces|volte)"
ONCE = r"(?P<once>twice|thrice|double|triple|half|halb|doppelt|zweimal|dreimal|viermal|dreifach)"
WHOLE = "(?P<whole>doppelten?|halben?|dreifachen?|double|triple|moitie|mitad|doble|meta|doppio|triplo)"
PHRASES = tuple(
    re.compile(phrase)
    for phrase in (
        rf"(?<!\S)(?:{ONCE}|{TIMES}) (?:as|so) {NAMED}\b(?! again\b)",
        rf"(?<!\S)(?P<once>half|twice|double|triple) the (?P<what>{LENGTHS}|{ANGLES}|{GRADES})\b",
        rf"(?<!\S){TIMES} (?:the|plus|mas|piu) {NAMED}\b",
        rf"(?<!\S)(?:der|die|den|dem|la|el|le|il) {WHOLE} (?:de )?(?P<what>{LENGTHS}|{ANGLES}|{GRADES})\b",
        rf"(?<!\S)(?P<what>{LENGTHS}) (?:le|la|el|il) {WHOLE}\b",
        rf"(?<!\S)(?:das|le|el|il) {WHOLE} (?=$|[.,;]|a |nach )",
        r"(?<!\S)(?P<once>half|twice|double|triple) (?:of )?(?P<that>that|it|this)(?= (?:$|[.,;:!?)]))",
        rf"(?<!\S)(?:der|den|dem|le|la|el|il|del) {WHOLE} (?:de |del |di |du )?(?P<what>{RADII})\b",
        rf"(?<!\S)(?P<what>{RADII}) (?:(?:le|la|el|il) )?{WHOLE}\b",
        rf"(?<!\S)(?P<what>{RADII}) {TIMES} (?:plus|mas|piu) grande?\b",
        rf"(?<!\S)(?:{ONCE}|{TIMES}) (?:that|the|its) (?P<what>{RADII})\b",
        rf"(?<!\S)(?P<once>halber|halbem|halben|halbe|doppelter|doppeltem|doppelte) "
        rf"(?P<what>{RADII}|{ANGLES})\b",
    )
)
"""Multiples as they are said in five languages, in words without accents; numbers stand in braces."""
THAT = "that"
"""What a multiple measures that is said of "that" or "it": the number before it, of whatever kind."""
RADIUS_BEHIND = [[word] for word in RADII.split("|")]
FILLERS = ("m", "metre", "metres", "meter", "metern", "metros", "metri", "of", "de", "di")
REFERENCES = frozenset(
    ["as", "than", "wie", "als", "que", "come", "of", "di", "de", "du", "del", "der", "des"]
)
KNOWN = frozenset(
    [
        "first",
        "previous",
        "last",
        "before",
        "one",
        "erste",
        "ersten",
        "vorige",
        "vorher",
        "premiere",
        "premier",
    ]
    + ["precedente", "primera", "primero", "anterior", "prima", "primo"]
    + ["initial", "initiale", "inicial", "iniziale", "opening", "anfangliche", "anfanglichen"]
)
"""What a multiple may be compared with: the part that was named before it."""
ROAD = frozenset(
    [
        "road",
        "route",
        "track",
        "whole",
        "total",
        "all",
        "altogether",
        "strasse",
        "straße",
        "strecke",
        "insgesamt",
    ]
    + ["parcours", "carretera", "ruta", "recorrido", "strada", "percorso", "tracciato"]
)
"""Words beside the length of the whole road, of which no part is a multiple."""
NEAR = 3  # words
DENIALS = frozenset(["not", "no", "nicht", "keine", "pas", "ne", "non"])
DENIED = 4  # words
"""How far before a multiple it may be denied: "not really twice as long"."""
EACH = "each every jede jeder jedes je chaque chacun chacune cada ogni ognuna ognuno"
BARRING = DENIALS | frozenset(EACH.split())
"""Words before a difference that is denied, or one of several: "each 20 degrees more than the one before"."""
BARRED = 6  # words
COMPARED = 8  # words
"""How far behind a number it may be compared: "40 degrees further than the first one"."""
SIGNS: tuple[Unit, ...] = ("metres", "degrees", "percent")
EXPLAINED = 8  # words
"""How far behind a multiple its figure may be said: "twice as long as the first one, that is 80 m"."""


MORE = (
    r"more|further|farther|longer|wider|larger|bigger|steeper|mehr|weiter|langer|grosser|steiler|de plus|mas|"
    r"in piu|di piu"
)
LESS = (
    r"less|fewer|shorter|tighter|smaller|weniger|kurzer|enger|kleiner|flacher|de moins|menos|in meno|di meno"
)
THAN = r"(?:than|als|que|che|di|rispetto a)"
ONE = r"(?: (?:one|turn|bend|curve|corner|straight|kurve|gerade|virage|courbe|curva|recta|rettilineo))?"
ARTICLE = r"(?:the|der|die|das|dem|den|ce|la|le|el|los?|quel\w*|il)"
FIRST = rf"{ARTICLE} (?:first|ersten?|premi(?:er|ere)|primer[oa]?|prim[oa]){ONE}"
BEFORE = (
    rf"(?:{ARTICLE} (?:previous|vorigen?|vorherigen?|precedente?|anterior){ONE}|"
    rf"{ARTICLE} one before|that|this|it|das|cela|ca|eso|quello)"
)
THE_ONE = rf"(?:(?P<first>{FIRST})|(?P<before>{BEFORE}))"
"""Words for a part that was named before."""
DIFFERENCE = re.compile(rf"(?:(?P<more>{MORE})|(?P<less>{LESS}))(?: {THAN} {THE_ONE})?(?= |$)")
AT_END = re.compile(r"(?: ?[.,;!?]|$)")
SUM = re.compile(
    rf"\[unused\d+\] (?:degrees|metres|percent) (?:{MORE}|{LESS}) {THAN} "
    rf"(?:{FIRST}|{BEFORE}|{ARTICLE})(?: |$)"
)
"""A difference from another part, "40 degrees more than that", that is not computed, in a text of slots."""


def tells_a_difference(said: str) -> bool:
    """Returns whether a text, as networks read it, gives a number only by its difference from another one."""
    return SUM.search(said) is not None


class Multiple(NamedTuple):
    """A multiple in a text: the first and the last of its words, its factor, and what it measures."""

    first: int
    last: int
    factor: float
    what: str


def with_multiples(numbers: Sequence[Number], tokens: Sequence[str]) -> list[Number]:
    """Returns the numbers of a text, including one computed number for each multiple whose value is clear.

    Args:
        numbers: the numbers of the text with their units, in the order of the text.
        tokens: the words of the text, in lower case and without accents.
    """
    out = [*numbers]
    made = list[Number]()
    for multiple in _multiples(numbers, tokens):
        within = range(multiple.first, multiple.last + 1)
        others = [number for number in out if number.first not in within]
        before = [number for number in others if number.last < multiple.first]
        is_chained = multiple.what == THAT and made != [] and before[-1] == made[-1]
        base = made[-1] if is_chained else _base(before, tokens, multiple.what)
        is_denied = not DENIALS.isdisjoint(tokens[max(multiple.first - DENIED, 0) : multiple.first])
        if (
            base is None
            or is_denied
            or (multiple.what != THAT and _is_of_another(tokens[multiple.last + 1 :][: 2 * NEAR]))
            or _is_explained(others, multiple.last, base.unit)
        ):
            continue
        value = round(base.value * multiple.factor, 1)
        made.append(Number(value, multiple.first, multiple.last, base.unit, False))
        out = sorted([*others, made[-1]], key=lambda number: number.first)
    return out


def with_differences(numbers: Sequence[Number], tokens: Sequence[str]) -> list[Number]:
    """Returns the numbers of a text, where "40 degrees more than the first" is a sum if it is clear of which
    figure. The words of the comparison become part of the number.

    Args:
        numbers: the numbers of the text with their units, in the order of the text.
        tokens: the words of the text, in lower case and without accents.
    """
    out = list[Number]()
    for number in numbers:
        behind = " ".join(tokens[number.last + 1 : number.last + 1 + COMPARED])
        found = DIFFERENCE.match(behind) if number.unit in SIGNS else None
        base = _compared(out, number, found, behind) if found else None
        is_barred = not BARRING.isdisjoint(tokens[max(number.first - BARRED, 0) : number.first])
        value = base.value + number.value * (1 if found["more"] else -1) if found and base else 0.0
        if found is None or value <= 0 or is_barred:
            out.append(number)
            continue
        last = number.last + len(found[0].split())
        out.append(Number(round(value, 1), number.first, last, number.unit, False))
    return out


def _compared(before: Sequence[Number], number: Number, found: re.Match[str], behind: str) -> Number | None:
    """Returns the earlier number to which a difference is added; None if it is not clear which one.

    Degrees are those of turns only, so that "the first" and "that" say which. Metres and percent are clear if
    all earlier ones are equal.
    """
    alike = [each for each in before if each.unit == number.unit]
    if not alike or not (found["first"] or found["before"] or number.unit == "degrees"):
        return None
    if not (found["first"] or found["before"]) and AT_END.match(behind[found.end() :]) is None:
        return None  # "30 degrees more to the left"
    if number.unit == "degrees":
        return alike[0] if found["first"] else alike[-1]
    return alike[-1] if len({each.value for each in alike}) == 1 else None


def _multiples(numbers: Sequence[Number], tokens: Sequence[str]) -> Iterator[Multiple]:
    """Yields the multiples of a text in its order, none within another."""
    said = list(tokens)
    for number in numbers:
        if number.is_bare and number.first == number.last and number.value == int(number.value):
            said[number.first] = f"{{{int(number.value)}}}"
    text, starts = "", list[int]()
    for word in said:
        starts.append(len(text))
        text += f"{word} "
    found = sorted((m for phrase in PHRASES for m in phrase.finditer(text)), key=lambda m: m.start())
    end = -1
    for match in found:
        first = starts.index(match.start()) if match.start() in starts else -1
        last = first + match[0].strip().count(" ")
        if first > end:
            end = last
            yield Multiple(first, last, *_factor(match))


def _factor(match: re.Match[str]) -> tuple[float, str]:
    """Returns the factor of a multiple, and the word for what it measures; empty if there is none."""
    said = match.groupdict()
    times = (said.get("times") or "").strip("{}")
    factor = float(times) if times else FACTORS[said.get("once") or said.get("whole") or ""]
    return factor, said.get("what") or (THAT if "that" in said else "")


def _base(numbers: Sequence[Number], tokens: Sequence[str], what: str) -> Number | None:
    """Returns the number that a multiple is of; None if there is none, or if it is not clear which one.

    It is the last measured number, which has to be of the kind that the multiple names, and if there are
    several of this kind, all are equal.
    """
    if what in RADII.split("|") or what == THAT:
        return _base_of_any(numbers, tokens, is_of_a_radius=what != THAT)
    unit = next((unit for names, unit in KINDS if what in names.split("|")), "")
    units = {unit for _, unit in KINDS}
    measured = [number for number in numbers if number.unit in units and not is_radius(tokens, number)]
    if not measured:
        return None
    unit = unit or next((number.unit for number in reversed(measured) if number.unit != "percent"), "")
    alike = [number for number in measured if number.unit == unit]
    if not alike or len({number.value for number in alike}) > 1:
        return None
    around = tokens[max(alike[-1].first - NEAR, 0) : alike[-1].last + 1 + NEAR]
    has_radius = any(is_radius(tokens, number) or number.unit == "" for number in numbers)
    is_unclear = what in SIZES.split("|") and unit == "metres" and has_radius
    return None if is_unclear or not ROAD.isdisjoint(around) else alike[-1]


def _base_of_any(numbers: Sequence[Number], tokens: Sequence[str], is_of_a_radius: bool) -> Number | None:
    """Returns the last radius, or the last measured number, if all numbers of its kind are equal."""
    units = {unit for _, unit in KINDS}
    measured = [(number, _has_radius(tokens, number)) for number in numbers if number.unit in units]
    rows = [(number, kind) for number, kind in measured if kind or not is_of_a_radius]
    if not rows:  # "left on 35 m, right on double that radius"
        rows = [(number, kind) for number, kind in measured if number.unit == "metres"]
    if not rows:
        return None
    base, is_radius_ = rows[-1]
    alike = {number.value for number, kind in rows if kind == is_radius_ and number.unit == base.unit}
    around = tokens[max(base.first - NEAR, 0) : base.last + 1 + NEAR]
    return base if len(alike) == 1 and ROAD.isdisjoint(around) else None


def _has_radius(tokens: Sequence[str], number: Number) -> bool:
    """Returns whether a word for a radius stands before a number, or right behind it and its unit."""
    behind = [token for token in tokens[number.last + 1 :][:NEAR] if token not in FILLERS]
    return is_radius(tokens, number) or (number.unit == "metres" and behind[:1] in RADIUS_BEHIND)


def _is_of_another(behind: Sequence[str]) -> bool:
    """Returns whether the words behind a multiple compare it with something but the part named before it."""
    at = next((n for n, word in enumerate(behind[:NEAR]) if word in REFERENCES), None)
    return at is not None and KNOWN.isdisjoint(behind[at:])


def _is_explained(numbers: Sequence[Number], last: int, unit: Unit) -> bool:
    """Returns whether a number of the same unit follows a multiple closely and may be its figure."""
    behind = (number.first - last for number in numbers if number.first > last and number.unit in ("", unit))
    return any(distance <= EXPLAINED for distance in behind)
