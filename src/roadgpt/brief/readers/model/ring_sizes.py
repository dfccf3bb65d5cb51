"""Corrects the word for the size of a roundabout where the text gives its outer diameter in metres.

The network does not see the values of numbers, so it can only guess whether a roundabout that is 32 m across
is a mini one, a normal one or a large one.
"""

import re
from collections.abc import Sequence

from roadgpt.brief.junctions import SIZES
from roadgpt.brief.readers.model.slots import SlottedText, slot_name
from roadgpt.brief.readers.model.vocabulary import RING_SIZES, SIDES, SLOT_TOKENS, TAKES

ACROSS = re.compile(r"across|diam|durchmess|circle|ø")
ISLAND = re.compile(
    r"island|insel|ilot|isleta|islote|isola|anillo|inner|innen|interi|radius|rayon|radio|raggio"
)
CORRECTED = re.compile(
    r"^metres(?: \w+){0,3} [,.;:-] (?:no|nein|non|sorry|pardon|scusa|perdon) (?:[,.;:!]|\[unused)"
)
"""What follows a length that the next words take back."""
REACH = 4
"""The largest number of words between a length and a word such as "across"."""
ROUNDABOUT = "roundabout"
PARTS = ("//", "||")


def with_ring_sizes(tokens: Sequence[str], text: SlottedText) -> tuple[str, ...]:
    """Returns the tokens of a plan with the sizes of its roundabouts as the text gives them in metres.

    Nothing is changed unless there are as many outer diameters in the text as roundabouts without a radius.
    """
    sizes = [size for _, size in _sizes(tokens, text) if size]
    places = [place for place, token in enumerate(tokens) if token == ROUNDABOUT and _is_open(tokens, place)]
    sized = [place for place in places if _size_at(tokens, place) is not None]
    rings = sized if len(sized) == len(sizes) else places
    if not sizes or len(rings) != len(sizes) or "map" in tokens:
        return tuple(tokens)
    out = list(tokens)
    for place, size in reversed(list(zip(rings, sizes, strict=True))):
        at = _size_at(out, place)
        if at is not None:
            out[at] = size
        else:
            is_taken = out[place + 1 : place + 2] and out[place + 1] in (*SIDES, *TAKES)
            out.insert(place + (2 if is_taken else 1), size)
    return tuple(out)


def used_diameters(tokens: Sequence[str], text: SlottedText) -> frozenset[int]:
    """Returns the indices of the numbers of a text that are outer diameters and whose size the plan has."""
    return frozenset(index for index, size in _sizes(tokens, text) if size in tokens)


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
        place = words.index(name)
        near = " ".join(words[max(0, place - REACH) : place + REACH + 2])
        is_taken_back = CORRECTED.match(" ".join(words[place + 1 : place + 8])) is not None
        if ACROSS.search(near) and not ISLAND.search(near) and not is_taken_back:
            size = next((size for size, span in SIZES.items() if slot.value < span.hi + 1), "")
            found.append((index, size))
    return found


def _clause(tokens: Sequence[str], place: int) -> Sequence[str]:
    ends = [at for at in range(place, len(tokens)) if tokens[at] in PARTS]
    return tokens[place : ends[0] if ends else len(tokens)]


def _is_open(tokens: Sequence[str], place: int) -> bool:
    return not {"r=", "d="} & {*_clause(tokens, place)}


def _size_at(tokens: Sequence[str], place: int) -> int | None:
    own = _clause(tokens, place)
    return next((place + at for at, token in enumerate(own) if token in RING_SIZES), None)
