"""Seeds of the roads of a campaign."""

import numpy as np

from roadgpt.errors import UsageError

BITS = 53  # so that a seed survives every JSON reader


def seed_of(seed: int, index: int) -> int:
    """The seed of road ``index`` (from 1) of the campaign ``seed``: well mixed, so that campaigns whose seeds
    are neighbours share no road. By numpy's SeedSequence, whose results are promised to stay the same.

    Raises:
        UsageError: the campaign's seed is negative.
    """
    if seed < 0:
        raise UsageError(f"{seed} is no seed; give a whole number from 0 up")
    drawn = np.random.SeedSequence([seed, index]).generate_state(1, np.uint64)[0]
    return int(drawn) >> (64 - BITS)
