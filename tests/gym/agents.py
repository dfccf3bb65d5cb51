"""Agents for the tests: they know the observation and nothing else."""

from typing import Any

import gymnasium
import numpy as np

from roadgpt_gym.observation import LABELS, SCALES

LOCK = 0.62  # rad
WHEELBASE = 2.83  # m


def good(seen: Any, kmh: float = 40.0) -> Any:
    """Feed-forward of the bend ahead and feedback on place and direction."""
    told = dict(zip(LABELS, (np.asarray(seen, float) * SCALES).tolist(), strict=True))
    error = told["offset"] + (5 + 0.25 * told["speed"]) * told["heading_error"]
    steer = WHEELBASE * told["curvature_2"] - 0.1 * error
    pedal = 0.4 * (kmh / 3.6 - told["speed"]) + 9.81 * told["grade_2"] / 6
    return np.array([steer / LOCK, pedal], np.float32)


def straight(seen: Any) -> Any:
    """Never steers."""
    del seen
    return np.array([0.0, 0.5], np.float32)


def episode(
    env: Any, agent: Any, most: int = 5000, **reset: Any
) -> list[tuple[Any, Any, float, dict[str, Any]]]:
    """Rows of (what was seen, action, reward, info after it)."""
    seen, _ = env.reset(**reset)
    rows = []
    for _ in range(most):
        action = agent(seen)
        before = seen
        seen, reward, terminated, truncated, info = env.step(action)
        rows.append((before, action, reward, info))
        if terminated or truncated:
            break
    return rows


def made(prompt: Any = "a road with 2 turns", **arguments: Any) -> Any:
    """The environment as Gymnasium makes it, without its checks."""
    return gymnasium.make("roadgpt/LaneKeeping-v0", disable_env_checker=True, prompt=prompt, **arguments)
