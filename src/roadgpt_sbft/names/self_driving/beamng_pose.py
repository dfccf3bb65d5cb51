"""Defines the position and rotation of a car in BeamNG."""

from __future__ import annotations

from typing import Any


class BeamNGPose:
    """The position of a car in metres, and its rotation as a quaternion (x, y, z, w)."""

    def __init__(self, pos: Any = None, rot: Any = None) -> None:
        self.pos = pos or (0, 0, 0)
        self.rot = rot or (0, 0, 0, 1)
