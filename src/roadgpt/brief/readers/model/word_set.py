"""Makes sets of words from strings in which spaces separate the words."""


def word_set(*lines: str) -> frozenset[str]:
    """Returns the set of the words in some strings."""
    return frozenset(word for line in lines for word in line.split())
