"""Several environments side by side, and a curriculum of descriptions."""

from typing import Any

import gymnasium
import numpy as np
import pytest

from gym.agents import made
from roadgpt.errors import UsageError
from roadgpt_gym.curriculum import Curriculum


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_vectorised_environments_see_what_single_ones_see(mode: Any) -> None:
    many = gymnasium.make_vec(
        "roadgpt/LaneKeeping-v0", num_envs=2, vectorization_mode=mode, prompt="a road with 2 turns"
    )
    single = [made() for _ in range(2)]
    try:
        seen, _ = many.reset(seed=20)
        alone = [env.reset(seed=20 + place)[0] for place, env in enumerate(single)]
        assert np.array_equal(seen, np.stack(alone))
        actions = np.array([[0.1, 0.5], [-0.1, 0.9]], np.float32)
        for _ in range(20):
            seen, rewards, *_ = many.step(actions)
            alone = [env.step(action) for env, action in zip(single, actions, strict=True)]
            assert np.array_equal(seen, np.stack([each[0] for each in alone]))
            assert rewards.tolist() == [each[1] for each in alone]
    finally:
        many.close()


class Told(gymnasium.Env[Any, Any]):
    """Ends each episode at once, in the way that it is told."""

    observation_space = gymnasium.spaces.Discrete(1)
    action_space = gymnasium.spaces.Discrete(1)

    def __init__(self) -> None:
        self.ending, self.prompts = "goal", list[str]()

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        self.prompts.append((options or {})["prompt"])
        return 0, {}

    def step(self, action: Any) -> Any:
        return 0, 0.0, self.ending != "timeout", self.ending == "timeout", {"ended": self.ending}


def test_a_curriculum_goes_on_when_enough_have_arrived_and_then_stays() -> None:
    told = Told()
    env = Curriculum(told, ["easy", "middling", "hard"], share=0.75, episodes=4)

    def levels(*endings: str) -> list[int]:
        out = []
        for told.ending in endings:
            _, info = env.reset()
            *_, after = env.step(0)
            out.append(info["level"])
            assert after["level"] == env.level
        return out

    assert levels("goal", "goal", "out_of_lane", "timeout") == [0, 0, 0, 0]
    assert levels("goal", "goal") == [0, 0]  # of the last four, two; then, three
    assert levels("goal") == [0]
    assert levels("goal", "goal", "goal") == [1, 1, 1]  # counted anew
    assert levels("out_of_lane", "goal", "goal", "goal") == [1, 2, 2, 2]
    assert levels(*["goal"] * 9) == [2] * 9  # there is no next one
    assert told.prompts[0] == "easy"
    assert set(told.prompts[12:]) == {"hard"}


def test_a_curriculum_gives_roads_of_its_level_unless_told_otherwise() -> None:
    env = Curriculum(made(), ["a straight road", "two hairpins"], episodes=1)
    assert env.reset(seed=1)[1]["prompt"] == "a straight road"
    assert env.reset(options={"prompt": "a winding road"})[1]["prompt"] == "a winding road"
    env.level = 1
    assert env.reset()[1]["prompt"] == "two hairpins"


@pytest.mark.parametrize("wrong", [{"prompts": []}, {"share": 0.0}, {"share": 1.2}, {"episodes": 0}])
def test_a_curriculum_without_sense_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match="a curriculum needs"):
        Curriculum(Told(), **{"prompts": ["a road"], **wrong})
