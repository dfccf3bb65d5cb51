"""Reads change requests by rules where the words leave no choice, and finds numbers that a plan has lost."""

import re

from roadgpt.brief.readers.model.height_words import height_wish
from roadgpt.brief.readers.model.nouns import LEFT, RIGHT
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.swap_words import SWAP, exchanged_values, turns_to_swap
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan

PARTS = {
    3: ("third|drittel|tiers|tercio|terzo", "0.333", "0.667"),
    4: ("quarter|viertel|quart|cuarto|cuarta parte|quarto", "0.25", "0.75"),
}
"""For each share: its words, the factor of what is reduced to it, and of what is reduced by it."""
TO = r"(?:(?:to|auf) (?:(?:a|one|its|ein) )?|(?:a|al|alla|au) (?:un[ea]?|la|le) )"
BY = r"(?:(?:by|um) (?:(?:a|one|ein) )?|(?:de|d '|en|di) (?:un[ea]?|la|le) )"
BECOMES = re.compile(r"\b(?:flip|becomes?|wird|werden|invers\w*|devien\w*|inviert\w*|pasa\w* a|divent\w*)\b")
"""Words with which one side becomes the other, beside those that exchange two things."""
ALTERNATE = "turn all: alternate"
CLASH_OF_SIDES = "!contradiction sides"
ALTERNATES = re.compile(r"\b(?:altern\w*|abwechs\w*|wechsel\w*|tour a tour|avvicend\w*)\b")


def read_by_rules(line: str, text: SlottedText, second: str = "") -> str | None:
    """Returns the plan of a change request that rules read; None if the network has to read it.

    Args:
        line: the plan that the network wrote.
        text: the change request.
        second: the second likeliest plan; empty if there is none.
    """
    read = _climb(text, line) or _swap(text, line) or exchanged_values(text)
    of_sides = second if line == CLASH_OF_SIDES else line  # "left becomes right, right becomes left"
    return read or _other_sides(text, of_sides) or _share(text, line)


def _climb(text: SlottedText, line: str) -> str | None:
    """Returns the plan of a change request that asks for a climb in metres; None for other requests.

    The place is the one in ``line``, the plan that the network wrote, or the road if no part is named.
    """
    wish = height_wish(text)
    if wish is None:
        return None
    is_one = not line.startswith(("!", "add ")) and ";" not in line
    if ";" in line or (wish.names_a_part and not is_one):
        return None
    return f"{line.partition(':')[0].strip() if wish.names_a_part else 'road'}: climb {wish.value}"


def _swap(text: SlottedText, line: str) -> str | None:
    """Returns the plan of a change request that asks two turns to change places; None for other requests."""
    place = turns_to_swap(text) if "swap" not in line else None
    return f"{place}: swap" if place else None


def _other_sides(text: SlottedText, line: str) -> str | None:
    """Returns the plan with all turns to their other sides, where the network lets them alternate and the
    words exchange left and right; None for other requests.
    """
    said = text.text
    words = {word.text for word in text.words}
    names_both = not words.isdisjoint(LEFT) and not words.isdisjoint(RIGHT)
    is_exchange = names_both and (SWAP.search(said) or BECOMES.search(said)) and not ALTERNATES.search(said)
    return line.replace(ALTERNATE, "turn all: side other") if ALTERNATE in line and is_exchange else None


def _share(text: SlottedText, line: str) -> str | None:
    """Returns the plan of a request to reduce a value to, or by, a third or a quarter, where the network has
    taken one for the other; None for other requests.
    """
    for words, to, by in PARTS.values():
        is_to = re.search(rf"\b{TO}(?:{words})\b", text.text) is not None
        is_by = re.search(rf"\b{BY}(?:{words})\b", text.text) is not None
        factors = re.findall(r"\bx(0\.\d+)\b", line)
        if is_to != is_by and len(factors) == 1 and factors[0] == (by if is_to else to):
            return line.replace(f"x{factors[0]}", f"x{to if is_to else by}")
    return None


def lost_numbers(draft: ScoredPlan, text: SlottedText) -> tuple[str, ...]:
    """Returns the small numbers of a change request (positions and counts) that its plan lacks."""
    if draft.is_refusal:
        return ()
    return tuple(
        word.written
        for word in text.words
        if word.written and word.text.isdecimal() and word.text not in (*draft.tokens, "1")
    )
