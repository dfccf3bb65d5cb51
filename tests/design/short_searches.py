"""Searches that give up sooner, for tests in which a refusal need not be sure; test_offers has all drafts."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from roadgpt.design import road_search

SHORT = {"TRIALS": (1,), "TRIED": 30, "GROWN": 3, "GROWN_ON_TRIAL": 1}


@contextmanager
def short_searches() -> Iterator[None]:
    """Fewer drafts before a road of required length is given up, and before a map counts as too small."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in SHORT.items():
            patch.setattr(road_search, name, value)
        yield
    road_search.sufficient_map.cache_clear()
