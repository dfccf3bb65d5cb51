"""Makes and evaluates many roads from many descriptions, as RoadGPT's thesis did, and compares roads.

plan, execution   read prompts and define a study (descriptions, designers, number of roads); make its roads
road_record       collects the properties of each road for the reports, from the files of its run
study_report      writes the report of a study and of a folder of runs, from the sections in ``chapters``
campaign_report   writes the report of a campaign, from the sections in ``chapters``
truth, criteria   define the requirements of a description; check which of them a road meets
similarity        measures how similar two roads are: turns and their order, length, incline, shape
statistics        computes statistical tests and confidence intervals for reports
survey            asks people to rate roads
"""

from roadgpt.network import refuse_without_route
from roadgpt.road import Road
from roadgpt.study.similarity import Similarity, likeness, similarity

__all__ = ["Similarity", "compare"]


def compare(one: Road, other: Road, mirror: bool = False) -> Similarity:
    """Returns how similar two roads are, by the criteria of the survey in RoadGPT's thesis.

    Args:
        one: a road.
        other: the road to compare it with.
        mirror: True if a road and its mirror image count as the same.

    Raises:
        UsageError: a road has fewer than two different points, or is a map without a route.
    """
    for road in (one, other):
        refuse_without_route(road, "compared")
    return similarity(likeness(one), likeness(other), mirror)
