"""A copy of a running environment goes on as the original does, and neither moves the other's car."""

import copy
import pickle
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from gym.agents import made
from roadgpt.errors import UsageError

ACTION = np.array([0.1, 0.5], np.float32)
BEFORE, AFTER = 10, 6  # steps

CONTINUED = f"""
import pickle, sys
import numpy as np
env = pickle.load(sys.stdin.buffer)
action = np.array({ACTION.tolist()}, np.float32)
sys.stdout.buffer.write(pickle.dumps([env.step(action) for _ in range({AFTER})]))
"""


def running(**arguments: Any) -> Any:
    env = made(**arguments)
    env.reset(seed=1)
    for _ in range(BEFORE):
        env.step(ACTION)
    return env


def steps(env: Any) -> list[Any]:
    return [env.step(ACTION) for _ in range(AFTER)]


def assert_same(one: list[Any], other: list[Any]) -> None:
    for (seen, *rest), (seen_too, *rest_too) in zip(one, other, strict=True):
        assert np.array_equal(seen, seen_too)
        assert rest == rest_too


@pytest.mark.parametrize("observation", ["state", "camera"])
def test_a_copy_goes_on_by_itself(observation: str) -> None:
    untouched = steps(running(observation=observation))
    original = running(observation=observation)
    copies = copy.deepcopy(original), pickle.loads(pickle.dumps(original)), copy.copy(original.unwrapped)
    for each in (*copies, original):  # none of them moves another one
        assert_same(steps(each), untouched)


def test_a_copy_goes_on_in_another_process() -> None:
    env = running()
    asked = subprocess.run(
        [sys.executable, "-c", CONTINUED], input=pickle.dumps(env), capture_output=True, check=True
    )
    assert_same(pickle.loads(asked.stdout), steps(env))


def test_a_copy_draws_its_own_next_road() -> None:
    env = running()
    copied = copy.deepcopy(env)
    roads = [each.reset()[1] and each.unwrapped.road.length for each in (copied, env)]
    assert roads[0] == roads[1]  # the generator's state was copied, not shared
    assert copied.reset() is not None
    assert copied.unwrapped.road.length != roads[0]


def test_a_copy_that_shows_images_goes_on() -> None:
    env = running(render_mode="rgb_array")
    before = env.render()
    copied = copy.deepcopy(env)
    steps(env)
    assert np.array_equal(copied.render(), before)
    assert not np.array_equal(env.render(), before)


def test_a_misspelt_option_is_refused_before_anything_changes() -> None:
    env = running()
    with pytest.raises(UsageError, match=r"no option 'promt', 'sed'; it has 'prompt'"):
        env.reset(seed=2, options={"promt": "a road", "sed": 3})
    assert_same(steps(env), steps(running()))
