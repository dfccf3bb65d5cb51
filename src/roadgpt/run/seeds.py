"""Derives the seeds of the roads of a campaign."""

import numpy as np

from roadgpt.errors import UsageError

BITS = 53  # so that a seed survives every JSON reader


def seed_of(seed: int, index: int) -> int:
    """Returns the seed of road ``index`` (from 1) of the campaign with seed ``seed``.

    The seed comes from numpy's SeedSequence, so that campaigns with consecutive seeds, such as 1 and 2, have
    no road in common. numpy guarantees that SeedSequence gives the same numbers in all versions.

    Raises:
        UsageError: the campaign's seed is negative.
    """
    if seed < 0:
        raise UsageError(f"{seed} is no seed; give a whole number from 0 up")
    drawn = np.random.SeedSequence([seed, index]).generate_state(1, np.uint64)[0]
    return int(drawn) >> (64 - BITS)
