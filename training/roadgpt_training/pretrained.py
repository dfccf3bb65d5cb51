"""Prepares a new training run, and verifies the hash of the public weights from which the encoder starts."""

import re
from collections.abc import Sequence
from hashlib import file_digest
from pathlib import Path

from roadgpt.errors import UsageError

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


NAME = "sentence-transformers/all-MiniLM-L6-v2 (Apache-2.0)"
HASH = "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db"
"""SHA-256 of the public ``model.safetensors``."""
PIECES = "pieces.txt"
NOTICE = f"""\
These weights were trained for RoadGPT and are under its licence, Apache-2.0.

The encoder was fine-tuned from all-MiniLM-L6-v2 (sentence-transformers, Apache-2.0; based on
nreimers/MiniLM-L6-H384-uncased, and that on microsoft/MiniLM-L12-H384-uncased), whose
model.safetensors has the SHA-256
{HASH}.
Changes: the vocabulary was cut to Latin letters, one encoder was grown to twelve layers, all layers
were trained further, and the weights were rounded to 7 bits. pieces.txt is a part of the vocabulary
of BERT (Google, Apache-2.0).
"""
"""The text of the licence notice that is distributed with the weights."""


def begin(out: Path, weights: Path | None, exported: Path | None = None) -> Sequence[str]:
    """Returns the word pieces used by a training run, and prepares the folder of the run if the run is new.

    A new run starts from ``weights``, the folder with ``model.safetensors`` and ``vocab.txt``, or from
    ``exported``, the folder of an exported reader.

    Raises:
        UsageError: a new training has no weights, files are missing, or the weights are not the public ones.
    """
    kept = out / PIECES
    if kept.exists():
        return read_vocabulary(kept)
    if exported is not None:
        if not (exported / PIECES).is_file():
            raise UsageError(f"there is no {PIECES} in {exported}; give the folder of an exported reader")
        out.mkdir(parents=True, exist_ok=True)
        kept.write_bytes((exported / PIECES).read_bytes())
        return read_vocabulary(kept)
    if weights is None:
        raise UsageError(
            "a new training needs --weights, the folder of all-MiniLM-L6-v2, or --installed, "
            "which starts from the installed reader"
        )
    for name in ("model.safetensors", "vocab.txt"):
        if not (weights / name).is_file():
            raise UsageError(f"there is no {name} in {weights}; give the folder of all-MiniLM-L6-v2")
    with (weights / "model.safetensors").open("rb") as file:
        found = file_digest(file, "sha256").hexdigest()
    if found != HASH:
        raise UsageError(
            f"model.safetensors in {weights} is not the public all-MiniLM-L6-v2: its SHA-256 is {found}, "
            f"not {HASH}; download it again"
        )
    out.mkdir(parents=True, exist_ok=True)
    pieces = trimmed(read_vocabulary(weights / "vocab.txt"))
    kept.write_text("\n".join(pieces), encoding="utf-8")
    return pieces
