"""Takes the sizes of roundabouts from their outer diameters, where the text gives these in metres.

The network does not see the values of numbers, so it can only guess whether a roundabout that is 32 m across
is a mini one, a normal one or a large one."""

from collections.abc import Sequence

from roadgpt.brief.amount import exactly, span
from roadgpt.brief.junctions import ACROSS, SIZES, JunctionClause
from roadgpt.brief.languages import pattern_of
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.slots import SlottedText, slot_name
from roadgpt.brief.readers.model.vocabulary import ROUNDABOUT, SLOT_TOKENS

TOLD, ISLAND, SHARED = map(pattern_of, ("across", "island", "shared"))
REACH = 4
"""The largest number of words between a length and a word such as "across"."""
LEAST, MORE, FEW = 28.0, 8.0, 4
"""The outer diameter in metres at which FEW arms and one lane have room, the additional diameter for each
further arm and for a second lane, and the number of arms FEW."""


def with_diameters(brief: Brief, tokens: Sequence[str], text: SlottedText) -> Brief:
    """Returns a Brief with the outer diameters of its roundabouts, and the words for these sizes, as the text
    gives them in metres.

    They are set only if each roundabout without a radius, or each of these with a size word, has a diameter
    in the text; one may be given for all. Where a diameter is above 70 m, or has too little room for the arms
    and lanes, only the size word is set."""
    told = diameters(tokens, text)
    rings = [n for n, each in enumerate(brief.junctions) if each.kind == ROUNDABOUT and not each.radius]
    sized = [n for n in rings if brief.junctions[n].size]
    if len(told) == 1 and SHARED.search(_near(text, told[0])):
        told = told * len(rings)
    places = sized if len(sized) == len(told) else rings
    if len(places) != len(told):
        return brief
    junctions = list(brief.junctions)
    for n, index in zip(places, told, strict=True):
        across = round(text.slots[index].value, 1)
        ring = junctions[n].model_copy(update={"size": _size(across)})
        has_room = least_diameter(ring, brief.stretches[n : n + 2]) <= across <= ACROSS.hi
        junctions[n] = ring.model_copy(update={"outer": exactly(across)}) if has_room else ring
    return brief.model_copy(update={"junctions": tuple(junctions)})


def diameters(tokens: Sequence[str], text: SlottedText) -> list[int]:
    """Returns the indices of the numbers of a text that are outer diameters, and that its plan lacks."""
    words = [word.text for word in text.words]
    return [
        index
        for index, slot in enumerate(text.slots)
        if slot.unit == "metres" and SLOT_TOKENS[index] not in tokens and words.count(slot_name(index)) == 1
        if TOLD.search(near := _near(text, index)) and not ISLAND.search(near) and _size(slot.value)
    ]


def least_diameter(ring: JunctionClause, roads: Sequence[Brief]) -> float:
    """Returns the least outer diameter in metres at which every draft of a roundabout has room for its arms
    and lanes, and for the lanes of the roads before and behind the roundabout."""
    arms = max(span(ring.arms).lo, span(ring.exit).lo + 1)
    lanes = [ring.lanes, *(each for road in roads for each in (road.lanes, road.against))]
    is_wide = any(span(each).lo > 1 for each in lanes)
    return LEAST + MORE * max(arms - FEW, 0.0) + MORE * is_wide


def _size(across: float) -> str | None:
    return next((size for size, span in SIZES.items() if across < span.hi + 1), None)


def _near(text: SlottedText, index: int) -> str:
    words = [word.text for word in text.words]
    place = words.index(slot_name(index))
    return " ".join(words[max(0, place - REACH) : place + REACH + 2])
