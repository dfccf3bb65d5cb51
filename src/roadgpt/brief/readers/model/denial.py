"""Finds out whether a phrase of a description is denied, in five languages."""

import re

DENIED = re.compile(
    r"(?:\b(?:no|not|without|never|cannot|neither|nor|nicht|nie|kein\w*|ohne|pas|ni|aucune?|sans|jamais|sin|"
    r"ningun[ao]?|tampoco|non|nessun[ao]?|ne|senza)|n['’]t)\b[^.,;:!?]*$"
)


def is_denied(before: str) -> bool:
    """Returns whether a negation, such as "no" or "without", stands before a phrase.

    The negation counts only if there is no punctuation mark between it and the phrase.

    Args:
        before: the text before the phrase, in lower case without accents.
    """
    return DENIED.search(before) is not None


def says(pattern: re.Pattern[str], said: str) -> bool:
    """Returns whether the pattern matches a phrase of the text that is not denied.

    The text ``said`` must be in lower case without accents.
    """
    return any(not is_denied(said[: found.start()]) for found in pattern.finditer(said))
