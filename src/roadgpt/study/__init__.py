"""Makes and evaluates many roads of many descriptions, as RoadGPT's thesis did, and compares roads.

plan, execution   defines a study: descriptions, designers, roads of each; makes its roads
road_record       reads from each run what reports need
study_report      writes the report of a study and of a folder of runs, from the sections in ``chapters``
campaign_report   writes the report of a campaign, from the sections in ``chapters``
truth, criteria   defines what people wrote down about a description; checks whether a road meets it
similarity        measures how similar two roads are: turns and their order, length, incline, shape
statistics        computes the tests and intervals of the reports and of the survey
survey            asks people to rate roads
"""

from roadgpt.road import Road
from roadgpt.study.similarity import Similarity, likeness, similarity

__all__ = ["Similarity", "compare"]


def compare(one: Road, other: Road, mirror: bool = False) -> Similarity:
    """Returns how similar two roads are, in the criteria of the thesis' survey.

    Args:
        one: a road.
        other: the road to compare it with.
        mirror: True if a road and its mirror image count as the same.

    Raises:
        UsageError: a road has fewer than two different points.
    """
    return similarity(likeness(one), likeness(other), mirror)
