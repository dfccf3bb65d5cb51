"""Several processes that train side by side."""

import os

import pytest

pytest.importorskip("torch", reason="comes with the extra 'learn'")


def test_a_worker_ends_where_its_training_was_killed() -> None:
    from roadgpt.learn.train import _not_alone

    _not_alone(os.getppid())
    with pytest.raises(SystemExit):
        _not_alone(os.getpid())  # as if another process had become the parent
