"""Sets of words that are written as strings with spaces."""


def word_set(*lines: str) -> frozenset[str]:
    """Returns the words of some lines as a set."""
    return frozenset(word for line in lines for word in line.split())
