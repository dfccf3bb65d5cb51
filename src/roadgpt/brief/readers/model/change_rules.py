"""Reads change requests by rules where the words leave no choice, and finds numbers that a plan has lost."""

from roadgpt.brief.readers.model.height_words import height_wish
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.swap_words import exchanged_values, turns_to_swap
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan


def read_by_rules(line: str, text: SlottedText) -> str | None:
    """Returns the plan of a change request that rules read; None if the network has to read it.

    Args:
        line: the plan that the network wrote.
        text: the change request.
    """
    return _climb(text, line) or _swap(text, line) or exchanged_values(line, text)


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


def lost_numbers(draft: ScoredPlan, text: SlottedText) -> tuple[str, ...]:
    """Returns the small numbers of a change request (positions and counts) that its plan lacks."""
    if draft.is_refusal:
        return ()
    return tuple(
        word.written
        for word in text.words
        if word.written and word.text.isdecimal() and word.text not in (*draft.tokens, "1")
    )
