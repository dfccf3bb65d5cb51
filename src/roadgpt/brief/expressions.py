"""Finds what a description asks for besides the shape of a road, in five languages: the size of the map,
traffic on the left, a motorway.

The readers take every length for a length of the road. The size of a map ("on a map of 500 m by 500 m") is
therefore removed from the words before a reader reads the words."""

import re
from itertools import pairwise

from roadgpt.brief.languages import TABLE, pattern_of, with_plain_numbers, word_set
from roadgpt.brief.model import Brief
from roadgpt.brief.words import LARGEST_MAP, SMALLEST_MAP, unaccented
from roadgpt.errors import BriefError

PARTS = {name: text.replace("\n", "") for name, text in TABLE["map_size"].items() if name != "forms"}


def _filled(form: str) -> str:
    while "{" in form:
        form = re.sub(r"\{([a-z]+)\}", lambda part: PARTS[part[1]], form)
    return form


MAP_SIZES = tuple(re.compile(_filled(form), re.IGNORECASE) for form in TABLE["map_size"]["forms"])
ONLY_SIZE = "this gives only the size of the map; say what the road should be like, such as 'two sharp turns'"
LOOSE = re.compile(r"^[\s,;:.]+|[,;:]\s*(?=[,;:.!?]|$)|\s+(?=[,.;:!?])")
"""Spaces and marks that are left over where words were taken out."""


def said_map_size(words: str) -> tuple[float, str] | None:
    """Returns the side in metres of the square map that words ask for (the shorter one, if they give two),
    and the other words; None if the words give no size.

    "On a map of 500 m by 500 m" is removed; "a map of 500 m by 500 m with two crossroads" only loses the
    size. Raises BriefError if no map may have this size, or if the words say nothing else."""
    words = with_plain_numbers(words)
    found = next(filter(None, (form.search(words) for form in MAP_SIZES)), None)
    if found is None:
        return None
    groups = found.groupdict()
    numbers = [each for each in found.groups() if each and re.fullmatch(r"[\d.,]+", each)]
    factors = [
        1000.0 if each.lower().startswith(("k", "chil")) else 1.0
        for each in found.groups()
        if each and re.fullmatch(PARTS["unit"], each, re.IGNORECASE)
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


LEFT_HAND, TRAFFIC, FORK, NEGATED = map(pattern_of, ("left_hand", "traffic", "fork", "negated"))


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
    cars, "traffic" is removed from ``beside``, the things that are mentioned but not required."""
    if not (brief.left_hand or says_left_hand(words)):
        return brief
    has_others = TRAFFIC.search(LEFT_HAND.sub(" ", unaccented(words))) is not None
    beside = tuple(name for name in brief.beside if has_others or name != "traffic")
    return brief.model_copy(update={"left_hand": True, "beside": beside})


MOTORWAYS, NOT_ONE, PARTS_OF_ONE = map(word_set, ("motorways", "not_one", "parts_of_one"))
PAIRS = frozenset([("voie", "rapide"), ("voies", "rapides")])
WORDS_BEFORE = 3  # how many words before "motorway" are searched for NOT_ONE


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
