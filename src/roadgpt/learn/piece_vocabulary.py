"""Selects the part of BERT's vocabulary that descriptions of roads need: Latin letters, numbers up to 20, and
unused entries that stand for slots (the numbers of a description).
"""

import re
from collections.abc import Sequence
from pathlib import Path

MARKS = 25
"""One more than the number of unused vocabulary entries, [unused1] to [unused24], that stand for slots and
marks."""
LATIN = re.compile(r"(##)?[a-zß0-9]+|[!-/:-@\[-`{-~°º€]")
SPECIAL = ("[UNK]", "[CLS]", "[SEP]")


def trimmed(vocabulary: Sequence[str]) -> list[str]:
    """Returns the pieces of BERT's vocabulary that the network uses, with the padding piece first."""
    kept = ["[PAD]", *(f"[unused{number}]" for number in range(1, MARKS)), *SPECIAL]
    seen = set(kept)
    for piece in vocabulary:
        large = piece.isdecimal() and int(piece) > 20  # such numbers are slots
        if piece in seen or not LATIN.fullmatch(piece) or large:
            continue
        kept.append(piece)
        seen.add(piece)
    return kept


def read_vocabulary(path: Path) -> list[str]:
    """Returns the pieces in a vocabulary file with one piece per line, such as BERT's ``vocab.txt``."""
    return path.read_text(encoding="utf-8").rstrip("\n").split("\n")
