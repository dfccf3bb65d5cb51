"""Sets of words, written as people write words: one after another."""


def word_set(*lines: str) -> frozenset[str]:
    """The words of some lines as a set."""
    return frozenset(word for line in lines for word in line.split())
