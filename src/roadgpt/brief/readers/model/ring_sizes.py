"""Corrects the word for the size of a roundabout where the text gives its outer diameter in metres.

The network does not see the values of numbers, so it can only guess whether a roundabout that is 32 m across
is a mini one, a normal one or a large one.
"""

import re
from collections.abc import Sequence

from roadgpt.brief.amount import exactly, span
from roadgpt.brief.junction_ranges import ACROSS, SIZES
from roadgpt.brief.junctions import JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.slots import SlottedText, slot_name
from roadgpt.brief.readers.model.vocabulary import RING_SIZES, ROUNDABOUT, SIDES, SLOT_TOKENS, TAKES
from roadgpt.brief.readers.model.word_set import word_set

TOLD = re.compile(r"across|diam|durchmess|circle|ø")
ISLAND = re.compile(
    r"island|insel|ilot|\bisla\b|isleta|islote|isola|anillo|inner|innen|interi|radius|rayon|radio|raggio"
)
SHARED = re.compile(
    r"\b(?:both|each|all|every|beide|jeweils|alle|chacun|chaque|tous|cada|ambas|todas|tutte|entrambe|ognuna|"
    r"ciascuna)\b|\b(?:roundabouts|ronds - points|giratoires|rotatorie|rotonde|glorietas|rotondas) "
    r"(?:of|de|di) \[unused"
)
"""Words near the only diameter of a text that make it the diameter of all roundabouts."""
CORRECTED = re.compile(
    r"^metres(?: \w+){0,3} [,.;:-] (?:no|nein|non|sorry|pardon|scusa|perdon) (?:[,.;:!]|\[unused)"
)
"""Matches the words behind a length that is taken back at once, as in "30 metres, no, 40"."""
EXCEPT = word_set(
    "but save except excepting excluding bar ausser außer auf sauf excepte hormis salvo menos excepto tranne",
    "eccetto meno",
)
"""Words for an exception; "auf" stands for "bis auf"."""
REACH = 4
"""The largest number of words between a length and a word such as "across"."""
LEAST, MORE, FEW = 28.0, 8.0, 4
"""The outer diameter in metres at which FEW arms and one lane have room, the additional diameter for each
further arm and for a second lane, and the number of arms FEW.
"""
PARTS = ("//", "||")


def with_ring_sizes(tokens: Sequence[str], text: SlottedText) -> tuple[str, ...]:
    """Returns the tokens of a plan with the size words of its roundabouts, such as "mini", that follow from
    the outer diameters in the text.

    Size words are changed only if each roundabout without a radius in the plan, or each of these with a size
    word, has an outer diameter in the text. One diameter may be given for all of them. The plan of a map is
    returned unchanged.
    """
    out = list(tokens)
    for place, _, size in reversed(_sized_rings(tokens, text)):
        at = _size_at(out, place)
        if at is not None:
            out[at] = size
        else:
            is_taken = out[place + 1 : place + 2] and out[place + 1] in (*SIDES, *TAKES)
            out.insert(place + (2 if is_taken else 1), size)
    return tuple(out)


def with_diameters(brief: Brief, tokens: Sequence[str], text: SlottedText) -> Brief:
    """Returns a Brief with the outer diameters of its roundabouts as the text gives them in metres.

    A diameter above 70 m, or with too little room for the arms and lanes, is not set. The tokens are those
    that ``with_ring_sizes`` returns.
    """
    rings = [place for place, token in enumerate(tokens) if token == ROUNDABOUT]
    own = [n for n, each in enumerate(brief.junctions) if each.kind == ROUNDABOUT]
    if len(rings) != len(own):
        return brief
    junctions = list(brief.junctions)
    for place, index, _ in _sized_rings(tokens, text):
        n = own[rings.index(place)]
        across = round(text.slots[index].value, 1)
        if least_diameter(junctions[n], brief.stretches[n : n + 2]) <= across <= ACROSS.hi:
            junctions[n] = junctions[n].model_copy(update={"outer": exactly(across)})
    return brief.model_copy(update={"junctions": tuple(junctions)})


def least_diameter(ring: JunctionClause, roads: Sequence[Brief]) -> float:
    """Returns the least outer diameter in metres at which every draft of a roundabout has room for its arms
    and lanes, and for the lanes of the roads before and behind the roundabout. If the text gives a smaller
    diameter, only the size word is kept.
    """
    arms = max(span(ring.arms).lo, span(ring.exit).lo + 1)
    lanes = [ring.lanes, *(each for road in roads for each in (road.lanes, road.against))]
    is_wide = any(span(each).lo > 1 for each in lanes)
    return LEAST + MORE * max(arms - FEW, 0.0) + MORE * is_wide


def _sized_rings(tokens: Sequence[str], text: SlottedText) -> list[tuple[int, int, str]]:
    """Returns the place of each roundabout of which the text gives the outer diameter, the index of its
    number, and the word for its size.
    """
    sizes = [found for found in _sizes(tokens, text) if found[1]]
    places = [
        place
        for place, token in enumerate(tokens)
        if token == ROUNDABOUT and {"r=", "d="}.isdisjoint(_clause(tokens, place))
    ]
    sized = [place for place in places if _size_at(tokens, place) is not None]
    is_shared = len(sizes) == 1 and SHARED.search(_near(text, sizes[0][0])) is not None
    if is_shared and EXCEPT.isdisjoint(word.text for word in text.words):
        sizes = sizes * len(places)
    rings = sized if len(sized) == len(sizes) else places
    if len(rings) != len(sizes) or "map" in tokens:
        return []
    return [(place, *found) for place, found in zip(rings, sizes, strict=True)]


def used_diameters(tokens: Sequence[str], text: SlottedText) -> frozenset[int]:
    """Returns the indices of the text's slots that are outer diameters of 28 m or more, if their size word is
    in the plan.
    """
    found = (index for index, size in _sizes(tokens, text) if size in tokens)
    return frozenset(index for index in found if text.slots[index].value >= LEAST)


def _sizes(tokens: Sequence[str], text: SlottedText) -> list[tuple[int, str]]:
    """Returns each outer diameter that the text gives and the plan does not use: the index of its number, and
    the word for its size, which is empty if there is none.
    """
    words = [word.text for word in text.words]
    found: list[tuple[int, str]] = []
    for index, slot in enumerate(text.slots):
        name = slot_name(index)
        if slot.unit != "metres" or SLOT_TOKENS[index] in tokens or words.count(name) != 1:
            continue
        place, near = words.index(name), _near(text, index)
        is_taken_back = CORRECTED.match(" ".join(words[place + 1 : place + 8])) is not None
        if TOLD.search(near) and not ISLAND.search(near) and not is_taken_back:
            size = next((size for size, span in SIZES.items() if slot.value < span.hi + 1), "")
            found.append((index, size))
    return found


def _near(text: SlottedText, index: int) -> str:
    """Returns the words around a slot that the text has once."""
    words = [word.text for word in text.words]
    place = words.index(slot_name(index))
    return " ".join(words[max(0, place - REACH) : place + REACH + 2])


def _clause(tokens: Sequence[str], place: int) -> Sequence[str]:
    ends = [at for at in range(place, len(tokens)) if tokens[at] in PARTS]
    return tokens[place : ends[0] if ends else len(tokens)]


def _size_at(tokens: Sequence[str], place: int) -> int | None:
    own = _clause(tokens, place)
    return next((place + at for at, token in enumerate(own) if token in RING_SIZES), None)
