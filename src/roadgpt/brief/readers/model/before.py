"""What happens to the words before a network reads them. Asides that would be read as weather, light or land
are taken out: colours, lamps, good sight, names and idioms. Closed circuits, negative lengths, radii and
counts are refused; and the network for routes reads only texts with a word that may mention a junction, ramp,
lane or map. A text with such a word may still describe a single road ("no junctions, please").

Grades and climbs may be negative, and a dash may be just punctuation, so only negative numbers that are
certainly lengths, radii or counts are refused."""

import re
import unicodedata
from collections import Counter
from collections.abc import Sequence

from roadgpt.brief.languages import TABLE, pattern_of, word_set
from roadgpt.brief.readers.model.number_words import COUNTED, ONE_TURN, plain
from roadgpt.brief.readers.model.slots import SlottedText, slot_name

TOLD_ON_ROUTES = frozenset(
    ["junction", "crossroads", "roundabout", "merge", "exit", "lane_change", "traffic_light", "sign", "lanes"]
)
"""Names of parts of routes that the networks for single roads give in ``beside(...)`` or as the cause of a
refusal."""
CLOSED, NOT_ASKED, DENIED = map(pattern_of, ("closed", "not_asked", "denied"))
TELLING = [pattern_of(language, "routes", re.IGNORECASE) for language in TABLE["routes"]]
COMPANIONS = word_set("companions")
MINUS, BEFORE_DASH, LENGTHS = word_set("minus"), word_set("before_dash"), word_set("lengths")
NEAR = 4
ASIDES, SIGHT = (
    [(re.compile(aside), instead) for aside, instead in TABLE["asides"][rows]] for rows in ("rows", "sight")
)


def without_asides(words: str, asides: Sequence[tuple[re.Pattern[str], str]] = ASIDES) -> str:
    """Returns the words without those that are no weather, light or land, such as "dark" in "dark green"."""
    for aside, instead in asides:
        words = aside.sub(instead, words)
    return words


def other_script(words: str) -> str:
    """Returns the name of the script in which more letters of a text are written than in Latin ones, such as
    "Cyrillic"; empty if there is none."""
    scripts = Counter(unicodedata.name(letter, "?").split()[0] for letter in words if letter.isalpha())
    script, count = scripts.most_common(1)[0] if scripts else ("LATIN", 0)
    is_other = script != "LATIN" and count > scripts["LATIN"]
    return {"CJK": "Chinese", "?": "unknown"}.get(script, script.capitalize()) if is_other else ""


def asks_for_a_closed_loop(words: str) -> bool:
    """Returns whether the words ask for a road that ends where it starts, and do not deny it."""
    said = " ".join(map(plain, words.split()))
    return any(
        not DENIED.search(said[: found.start()]) and not NOT_ASKED.search(said[: found.start()])
        for found in CLOSED.finditer(said)
    )


def negative_number(text: SlottedText) -> str | None:
    """Returns the first negative length, radius or count, for example "minus three turns"; None if there is
    none."""
    words = [word.text for word in text.words]
    for at, word in enumerate(words):
        if not _is_number(word) or not _is_below_nothing(words, at):
            continue
        after = words[at + 1 : at + 3]
        said = text.words[at].written
        noun = next((word for word in after if word in COUNTED | ONE_TURN), None)
        if noun:
            return f"minus {said} {noun}"
        if after[:1] == ["metres"] and LENGTHS.intersection(words[max(at - NEAR, 0) : at + 1 + NEAR]):
            return f"minus {said}"
    return None


def _is_number(word: str) -> bool:
    return word.isdecimal() or word.startswith(slot_name(0)[:-2])


def _is_below_nothing(words: Sequence[str], at: int) -> bool:
    before = words[at - 1] if at else ""
    if before in MINUS:
        # "five minus two", "5 plus or minus 1" are sums
        return at < 2 or not (_is_number(words[at - 2]) or words[at - 2] in ("or", "/", "plus"))
    return before == "-" and at > 1 and words[at - 2] in BEFORE_DASH


def may_tell_a_route(words: str) -> bool:
    """Returns whether a description has a word that may mention junctions, ramps, lanes or maps."""
    return any(telling.search(words) for telling in TELLING)
