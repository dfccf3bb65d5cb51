"""Defines the Scene: who else is on the road, what they do, and under which conditions."""

from typing import Literal

from roadgpt.brief.amount import Frozen

ActorKind = Literal[
    "car", "van", "truck", "bus", "motorcycle", "bicycle", "adult", "child", "animal", "cones", "barrier", "lost_load"
]
Flow = Literal["light", "medium", "dense"]


class Scene(Frozen):
    """The others on the road and the conditions of a drive."""

    flow: Flow | None = None
    """How many vehicles drive in the lanes of the map: 5, 12 or 25 for each km and lane; None: nobody."""
