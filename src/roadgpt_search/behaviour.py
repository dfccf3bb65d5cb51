"""Features of a road that can be axes of the space in which a search looks for diverse roads.

This space is called the feature map. It is divided into cells or bins, which are not the cells of a campaign.

RoadGPT itself has the five features of the SBFT competition: MAX_CURV, DIR_COV, STD_SA, MEAN_LP, MAX_LP. This
module adds features of the road's geometry; most come from ``check.measures``:

    DIR_COV_360   share of the 36 sectors of 10 degrees that contain a heading of the road
    RADIUS        smallest radius, m
    TURNED        sum of the angles of all turns, degrees
    TURNS         number of turns
    LEFT          share of the turns that turn left, 0 to 1
    GRADE         steepest grade, percent
    CLIMB         height of the end above the start, m
    LENGTH        length, m
    SIGHT         in land: least distance at which the driver sees the road, m

If a description states the number of turns, each turn has features of its own, in driving order: RADIUS_1,
DEGREES_1, RADIUS_2, ..."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.outline import outline
from roadgpt.campaign.columns import ResultColumns
from roadgpt.campaign.columns.execution import columns as of_competition
from roadgpt.check.measures import measure
from roadgpt.geometry.curve import Array
from roadgpt.road import Road
from roadgpt.run import Run

DRIVEN = ("STD_SA", "MEAN_LP", "MAX_LP", "SIGHT")  # the features that a sketch of a road has not
DIRECTIONS = 36  # of 10 degrees each
WIDEST = 1000.0  # m; larger radii count as this radius
TIGHTEST = 0.2  # 1 + 2k is kept above this
MOST_TURNS = 6  # that have features of their own
DECIMALS = 6

OWN_BOUNDS = {
    "DIR_COV_360": (0.0, 1.0),
    "RADIUS": (10.0, 110.0),  # m
    "TURNED": (0.0, 900.0),  # degrees
    "TURNS": (0.0, 12.0),
    "LEFT": (0.0, 1.0),
    "GRADE": (0.0, 15.0),  # percent
    "CLIMB": (-40.0, 40.0),  # m
    "LENGTH": (20.0, 620.0),  # m
    "SIGHT": (0.0, 200.0),  # m
}
BOUNDS = {**of_competition.bounds, **OWN_BOUNDS}
"""The range of the feature map along each axis; values beyond this range belong to the outermost cell."""

DEGREES = (0.0, 180.0)  # the range of the feature map along the axes DEGREES_1, DEGREES_2, and so on


def behaviour_of(road: Road, brief: Brief | None) -> dict[str, float]:
    """Returns the features of the geometry of a road for a Brief, by name."""
    samples = road.sample()
    return behaviour_of_samples(samples.points, samples.heading, brief)


def behaviour_of_samples(points: Array, heading: Array, brief: Brief | None) -> dict[str, float]:
    """Returns the features of a road's geometry, by name, from points ``(n, 3)`` of the centre line and from
    headings in radians at equally spaced stations."""
    found = measure(points, outline(brief or Brief()).widest)
    turns = found.turns
    out = {
        "DIR_COV_360": directions(heading),
        "RADIUS": min(found.radius, WIDEST),
        "TURNED": found.turning,
        "TURNS": float(len(turns)),
        "LEFT": found.count("left") / len(turns) if turns else 0.0,
        "GRADE": found.steepest,
        "CLIMB": found.climb,
        "LENGTH": found.length,
    }
    for number, turn in enumerate(turns[: turns_asked(brief)], 1):
        out[f"RADIUS_{number}"] = min(turn.radius, WIDEST)
        out[f"DEGREES_{number}"] = turn.degrees
    return {name: round(float(value), DECIMALS) for name, value in out.items()}


def curvature_of_lane(curvature: Array, middle: Array) -> Array:
    """Returns the curvature in 1/m of the middle of the driven lane, from that of the centre line and the
    offset of the middle in metres, positive to the left."""
    return curvature / np.maximum(1 - middle * curvature, TIGHTEST)


def turns_asked(brief: Brief | None) -> int:
    """Returns the number of turns that the Brief states, which get features such as RADIUS_1; 0 if it states
    none, a range, or more than six."""
    asked = outline(brief).turns if brief else None
    return int(asked.lo) if asked and 0 < asked.lo == asked.hi <= MOST_TURNS else 0


def directions(heading: Array) -> float:
    """Returns the share, 0 to 1, of the 36 sectors of 10 degrees that contain a heading (radians)."""
    number = np.floor(np.degrees(heading) % 360 / (360 / DIRECTIONS)).astype(int) % DIRECTIONS
    return len(np.unique(number)) / DIRECTIONS


def bounds_of(axis: str) -> tuple[float, float]:
    """Returns the range of the feature map along an axis; raises KeyError if there is no such feature."""
    name, _, number = axis.rpartition("_")
    if number.isdecimal() and 0 < int(number) <= MOST_TURNS and name in ("RADIUS", "DEGREES"):
        return BOUNDS["RADIUS"] if name == "RADIUS" else DEGREES
    return BOUNDS[axis]


def _numbers(run: Run) -> dict[str, float]:
    assert run.road is not None
    found = behaviour_of(run.road, run.brief)
    if run.world.has_ground and run.road.has_way:
        from roadgpt.network.sight import sight_along

        found["SIGHT"] = round(min(float(sight_along(run.road, run.world)[1].min()), run.road.length), 1)
    return found


columns = ResultColumns(_numbers, bounds=OWN_BOUNDS)
