"""Recognises a refusal that is due to a denial alone: in "15 m higher, and never going down", the denial says
nothing against the rest, so nothing is contradicted.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise

from roadgpt.brief.readers.model.denial import places_reached
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.used_words import NEGATORS

DENIABLE = frozenset(["left", "right", "up", "down"])
"""Tokens of plans for what cannot both be denied and asked for."""
TO_BOTH_SIDES = frozenset(["s_bend", "chicane", "slalom", "serpentine", "zigzag", "winding", "alternating"])
"""Tokens of turns to both sides."""
CAUSES = frozenset(["sides", "slope", "climb"])
"""The causes of a contradiction that such a denial may have been taken for."""
REACH = 6  # words after a negation that it can deny


def without_denials(
    text: SlottedText, why: str, offered: Sequence[str], meanings: Mapping[str, Sequence[str]]
) -> SlottedText | None:
    """Returns the text of a refused description without its denials, if the plan that is offered has nothing
    of what they deny; None if it has, if nothing is denied, or if something else is the cause of the refusal.

    ``why`` is the refusal with its causes, such as "!contradiction sides"; ``offered`` has the tokens of the
    likeliest plan that is no refusal.
    """
    causes = why.split()[1:]
    words = [word.text for word in text.words]
    implied = _implied(offered)
    if not causes or not CAUSES.issuperset(causes) or not implied:
        return None
    dropped = set[int]()
    for at in (n for n, word in enumerate(words) if word in NEGATORS and n not in dropped):
        reached = places_reached(words, at, REACH)
        denied = [token for n in reached for token in _denied(meanings.get(words[n], ()))]
        if not denied or not implied.isdisjoint(denied):
            return None
        dropped |= {at, *reached}
    if not dropped:
        return None
    return SlottedText(tuple(word for n, word in enumerate(text.words) if n not in dropped), text.slots)


def _implied(offered: Sequence[str]) -> set[str]:
    """Returns what a plan asks for of all that can be denied; a required climb implies "up", or "down" if it
    is negative, and "flat" excludes both.
    """
    found = {token.rpartition("_")[2] for token in offered} & DENIABLE
    if not TO_BOTH_SIDES.isdisjoint(offered):
        found |= {"left", "right"}
    if "hills=" in offered:
        found |= {"up", "down"}
    if "flat" in offered:
        found |= {"flat"}
    climbs = [after for key, after in pairwise([*offered, ""]) if key == "climb="]
    return found | {"down" if after == "-" else "up" for after in climbs}


def _denied(asked: Sequence[str]) -> Sequence[str]:
    """Returns what a denied word excludes: what it asks for most, if that can be excluded."""
    return [token for token in asked if token in DENIABLE][:1]
