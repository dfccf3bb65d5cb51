"""Defines the goal of a drive, as it is written in BeamNG's files."""

from __future__ import annotations

import json
import uuid
from typing import Optional, Sequence


class BeamNGWaypoint:
    """A goal (waypoint) in BeamNG; it is written as one line of a level's file."""

    def __init__(self, name: str, position: Sequence[float], persistentId: Optional[str] = None) -> None:
        self.name, self.position = name, position
        self.persistentId = persistentId or str(uuid.uuid4())

    def to_json(self) -> str:
        told = {
            "name": self.name,
            "class": "BeamNGWaypoint",
            "persistentId": self.persistentId,
            "__parent": "generated",
            "position": self.position,
            "scale": [4, 4, 4],
        }
        return json.dumps(told)
