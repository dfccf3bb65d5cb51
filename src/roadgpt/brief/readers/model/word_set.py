"""Writes sets of words as strings with spaces between the words."""


def word_set(*lines: str) -> frozenset[str]:
    """Returns the set of the words in some strings, which are split at spaces."""
    return frozenset(word for line in lines for word in line.split())
