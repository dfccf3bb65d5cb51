"""A curriculum of descriptions: it advances to the next description when the agent reaches the goal often
enough."""

from collections import deque
from collections.abc import Sequence
from typing import Any

import gymnasium

from roadgpt.errors import UsageError


class Curriculum(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Wraps an environment: starts with the first description and advances to the next one as the agent
    improves.

    ``info["level"]`` is the index of the current description, from 0.

    Args:
        env: a LaneKeeping environment.
        prompts: descriptions, the easiest first.
        share: fraction (0 to 1) of the last ``episodes`` episodes in which the agent must reach the goal
            before the curriculum advances.
        episodes: number of most recent episodes from which the share is computed."""

    def __init__(
        self, env: gymnasium.Env[Any, Any], prompts: Sequence[str], share: float = 0.8, episodes: int = 20
    ) -> None:
        super().__init__(env)
        if not prompts or not 0 < share <= 1 or episodes < 1:
            raise UsageError("a curriculum needs descriptions, a share up to 1, and 1 or more episodes")
        self.prompts, self.share = [*prompts], share
        self.level = 0
        self._last: deque[bool] = deque(maxlen=episodes)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, Any]:
        """Starts an episode on a road of the current description."""
        chosen = {"prompt": self.prompts[self.level], **(options or {})}
        seen, info = self.env.reset(seed=seed, options=chosen)
        return seen, {**info, "level": self.level}

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Runs a step of the environment. At the end of an episode, records whether the agent reached the
        goal, and advances to the next description if the agent did so in enough of the last episodes."""
        seen, reward, terminated, truncated, info = self.env.step(action)
        if terminated or truncated:
            self._last.append(info.get("ended") == "goal")
            is_full = len(self._last) == self._last.maxlen
            has_next = self.level + 1 < len(self.prompts)
            if is_full and has_next and sum(self._last) >= self.share * len(self._last):
                self.level += 1
                self._last.clear()
        return seen, reward, terminated, truncated, {**info, "level": self.level}
