"""Defines a road as it is written in BeamNG's files."""

from __future__ import annotations

import json
import uuid
from typing import Any, Dict, List, Optional, Sequence


class DecalRoad:
    """A decal road in BeamNG; it is written as one line of a level's file."""

    DEFAULT_MATERIAL = "tig_road_rubber_sticky"

    def __init__(
        self,
        name: str,
        material: str = DEFAULT_MATERIAL,
        persistentId: Optional[str] = None,
        drivability: int = 1,
    ) -> None:
        self.name, self.material, self.drivability = name, material, drivability
        self.persistentId = persistentId or str(uuid.uuid4())
        self.nodes: List[List[float]] = []

    def add_4d_points(self, nodes: Sequence[Sequence[float]]) -> DecalRoad:
        """Adds nodes [x, y, height, width] in metres."""
        assert len(nodes) > 0, "a road needs nodes"
        assert all(len(node) == 4 for node in nodes), "a node is [x, y, height, width]"
        assert all(isinstance(value, float) for node in nodes for value in node), "nodes are of floats"
        self.nodes += [list(node) for node in nodes]
        return self

    def to_dict(self) -> Dict[str, Any]:
        return {"name": self.name, "nodes": self.nodes}

    @classmethod
    def from_dict(cls, d: Dict[str, Any]) -> DecalRoad:
        return cls(name=d["name"]).add_4d_points(nodes=d["nodes"])

    def to_json(self) -> str:
        assert self.nodes, "a road needs nodes"
        told = {
            "name": self.name,
            "class": "DecalRoad",
            "breakAngle": 180,
            "distanceFade": [1000, 1000],
            "drivability": self.drivability,
            "material": self.material,
            "overObjects": True,
            "persistentId": self.persistentId,
            "__parent": "generated",
            "position": self.nodes[0][:3],
            "textureLength": 2.5,
            "nodes": self.nodes,
        }
        return json.dumps(told)
