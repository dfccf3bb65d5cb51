"""The old name of ``roadgpt.gym.observation``, kept for scripts that import it."""

from roadgpt.gym.observation import AHEAD, LABELS, MOST, SCALES, Preview

__all__ = ["AHEAD", "LABELS", "MOST", "SCALES", "Preview"]
