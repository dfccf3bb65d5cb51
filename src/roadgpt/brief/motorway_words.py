"""Finds the words that ask for a motorway, in five languages."""

import re
from itertools import pairwise

from roadgpt.brief.words import unaccented


def _bag(*lines: str) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split())


NAMES = _bag(
    "motorway motorways freeway freeways expressway expressways highway highways interstate turnpike",
    "autobahn autobahnen schnellstrasse schnellstraße kraftfahrstrasse kraftfahrstraße autoroute autoroutes",
    "autopista autopistas autovia autovias autostrada autostrade superstrada superstrade",
)
PAIRS = frozenset([("voie", "rapide"), ("voies", "rapides")])
NOT_ONE = _bag(
    "no not without off from to towards toward near beside leaving leave join joining over under",
    "kein keine keiner ohne neben zur zum von pas sans vers quitter sin hacia junto senza verso accanto non",
)
"""Words that mean, up to three words before "motorway", that the road is not one, or only near one."""
BACK = 3  # how many words before "motorway" are searched for NOT_ONE
PARTS_OF_ONE = _bag(
    "exit exits ramp ramps slip interchange junction entrance bridge services ausfahrt auffahrt"
)
"""Words that, right after "motorway", name only a part of it, such as a ramp or a bridge."""


def says_motorway(words: str) -> bool:
    """Returns True if a description in English, German, French, Spanish or Italian asks for a motorway."""
    said = re.findall(r"[^\W\d_]+", unaccented(words))
    for at, (word, after) in enumerate(pairwise([*said, ""])):
        is_pair = (word, after) in PAIRS
        if is_pair or word in NAMES:
            follows = "".join(said[at + 2 : at + 3]) if is_pair else after
            if follows not in PARTS_OF_ONE and not NOT_ONE & {*said[max(at - BACK, 0) : at]}:
                return True
    return False
