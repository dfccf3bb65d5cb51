"""The road has 2 to 500 control points: the SBFT competition's limits on ``road_points``."""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.road import Road, World

FEWEST, MOST = 2, 500  # SBFT validator


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Says how many control points there are, where these are too few or too many."""
    count = len(road.control_points())
    if FEWEST <= count <= MOST:
        return ()
    return (Finding("number_of_points", f"the road has {count} points; give {FEWEST} to {MOST}"),)
