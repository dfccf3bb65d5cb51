"""Descriptions that must not be used for training: the project's development prompts, stored as hashes."""

import re
from hashlib import sha256

from roadgpt.brief.readers.model.numerals import plain

HELD_OUT = frozenset((
    "019d204e8d61", "026c044fc007", "17aab1132e8c", "1cda9d23a5ef", "27e89d1e2523", "3633099f7723",
    "4ebf3aa6b12c", "666af6e273b2", "683332d359c9", "71aac9d7e3b7", "7f59b1d31452", "8aa5b9a46d35",
    "8b525e973489", "9886b0cc856d", "9b7cc9230b79", "aadebe82ac34", "ba5318cb6271", "c835218b45e6",
    "db78cec9158e", "dd15d342c028", "e18e6b759f17", "e6b53e71d29f", "ed2be0e5b34d", "f510591305b6",
))  # fmt: skip
"""The first 12 hexadecimal digits of the hash of each text, as computed by ``fingerprint``."""


def is_held_out(text: str) -> bool:
    """Returns whether a text is a held-out description, regardless of capitals, accents and punctuation."""
    return fingerprint(text) in HELD_OUT


def fingerprint(text: str) -> str:
    """Returns the first 12 hexadecimal digits of the SHA-256 hash of a text's words, in lower case,
    without accents and punctuation."""
    bare = " ".join(re.findall(r"[^\W_]+", plain(text)))
    return sha256(bare.encode()).hexdigest()[:12]
