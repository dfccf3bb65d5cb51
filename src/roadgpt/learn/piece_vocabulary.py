"""Selects the part of BERT's vocabulary that descriptions of roads need: Latin letters, numbers, slots."""

import re
from collections.abc import Sequence
from pathlib import Path

MARKS = 25
"""Number of unused words of the vocabulary, from [unused1], that stand for slots and marks, plus one."""
LATIN = re.compile(r"(##)?[a-zß0-9]+|[!-/:-@\[-`{-~°º€]")
SPECIAL = ("[UNK]", "[CLS]", "[SEP]")


def trimmed(vocabulary: Sequence[str]) -> list[str]:
    """Returns the pieces that are kept, padding first."""
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
    """Returns the pieces in BERT's ``vocab.txt`` or a part of it."""
    return path.read_text(encoding="utf-8").rstrip("\n").split("\n")
