"""Batches made by several processes: complete, and the same for the same seed."""

from functools import partial
from itertools import islice

import numpy as np

from roadgpt.brief.readers.model import WEIGHTS
from roadgpt.brief.readers.model.neural_network import WordPieces
from roadgpt_training.data import batches, examples, training_batches
from roadgpt_training.feed import fed_batches
from roadgpt_training.pair import Pair
from roadgpt_training.pretrained import read_vocabulary

HAND = [Pair(f"{word} bends to the left", f"turn x{n} left", "test", "en") for n, word in enumerate(
    ("two", "three", "four"), 2
)]  # fmt: skip


def test_batches_come_from_each_process_in_turn() -> None:
    pieces = read_vocabulary(WEIGHTS / "pieces.txt")
    words = WordPieces(pieces)
    make = partial(training_batches, hand=HAND, pieces=pieces, network="roads", size=4, pool=2)
    found = list(islice(fed_batches(2, 5, make), 4))
    for first in (0, 1):
        seed = 10 + first
        alone = batches(examples(seed, HAND, words), 4, 2, seed)
        for mine, theirs in zip(found[first::2], alone, strict=False):
            assert all(np.array_equal(*both) for both in zip(mine, theirs, strict=True))
