"""The part of BERT's vocabulary that descriptions of roads need: Latin letters, small numbers, slots."""

import re
from collections.abc import Sequence
from pathlib import Path

MARKS = 25
"""Unused words of the vocabulary, [unused1] and on, that stand for slots and marks."""
LATIN = re.compile(r"(##)?[a-zß0-9]+|[!-/:-@\[-`{-~°º€]")
SPECIAL = ("[UNK]", "[CLS]", "[SEP]")


def trimmed(vocabulary: Sequence[str]) -> list[str]:
    """The pieces that are kept, padding first."""
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
    """BERT's ``vocab.txt``, or a part of it."""
    return path.read_text(encoding="utf-8").rstrip("\n").split("\n")
