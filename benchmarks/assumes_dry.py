"""A driver for bench_search.py: the reference driver, which takes every road for dry.

Knowing its friction, it keeps its lane on every road that the competition allows; there is nothing to find.
"""

from roadgpt.drive.drivers.reference import Reference
from roadgpt.road import Road, World


class AssumesDry(Reference):
    """Plans its speed for dry asphalt, whatever lies there."""

    name = "assumes_dry"

    def start(self, road: Road, world: World, seed: int) -> None:
        """Plan line and speed for a friction of 1."""
        super().start(road, world.changed(friction=1.0), seed)
