"""Writes a count with its noun."""


def plural(n: int, word: str) -> str:
    """Returns a count with its noun, such as '1 road' or '2 roads'."""
    return f"{n:,} {word}{'' if n == 1 else 's'}"
