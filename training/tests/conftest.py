"""What several tests of the training data look at is made once."""

from itertools import islice

import pytest

from roadgpt_training.generator import pairs
from roadgpt_training.pair import Pair


@pytest.fixture(scope="session")
def generated() -> tuple[Pair, ...]:
    """Generated pairs, as many as tell of every way in which pairs are made."""
    return tuple(islice(pairs(11), 400))
