"""Gives turns the angles or radii that words list, one for each turn: "six turns, angles 30, 45, 60, 60, 45
and 30". The network loses count of longer lists.
"""

import re
from collections.abc import Iterator, Sequence

from roadgpt.brief.model import Brief, exactly
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.readers.model.listed_sides import JOINTS
from roadgpt.brief.readers.model.slots import NumberSlot, SlottedText
from roadgpt.brief.readers.model.turn_list import joined, one_by_one

FEWEST = 3
SLOT = re.compile(r"\[unused(\d+)\]")
UNITS = {"degrees": "degrees", "radius": "metres"}
"""The unit of each field that words list."""


def with_listed_values(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a single road whose turns have the angles or radii of a list in the words.

    The Brief is returned unchanged unless the list has as many numbers as the road has turns, all turns have
    exact values of this kind, and each of these values is in the list.
    """
    each = one_by_one(brief.clauses)
    turning = [clause for clause in each if clause.kind not in STRAIGHT]
    lists = [] if brief.junctions else [slots for slots in _lists(text) if len(slots) == len(turning)]
    for name, unit in UNITS.items():
        own = [getattr(clause, name) for clause in turning]
        for slots in lists:
            listed = [exactly(slot.value) for slot in slots if slot.unit in ("", unit)]
            if len(listed) == len(own) and own != listed and {*own} <= {*listed}:
                values = iter(listed)
                new = [
                    clause if clause.kind in STRAIGHT else clause.model_copy(update={name: next(values)})
                    for clause in each
                ]
                return brief.model_copy(update={"clauses": joined(new)})
    return brief


def _lists(text: SlottedText) -> Iterator[Sequence[NumberSlot]]:
    """Yields the numbers of each list in the words: nothing but commas and units stand between them."""
    slots: list[NumberSlot] = []
    for word in [*(word.text for word in text.words), "."]:
        slot = SLOT.fullmatch(word)
        if slot and int(slot[1]) <= len(text.slots):
            slots.append(text.slots[int(slot[1]) - 1])
        elif word not in JOINTS | {*UNITS.values()} or word == ".":
            if len(slots) >= FEWEST:
                yield slots
            slots = []
