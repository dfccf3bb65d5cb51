"""Evaluates many roads of many descriptions, as RoadGPT's thesis did, and compares roads.

``plan``, ``execution``  what a study consists of; runs it: descriptions, designers, roads of each
``road_record``          what a study reads from each run
``study_report``         writes the report of a study; ``campaign_report`` that of a campaign; ``chapters``
``truth``, ``criteria``  what a description asks for, as people wrote it down, and whether a road keeps it
``similarity``           how similar two roads are: turns, their order and sides, length, incline, shape
``statistics``           the tests and intervals of these reports and of the survey
``survey``               asks people
"""

from roadgpt.road import Road
from roadgpt.study.similarity import Similarity, likeness, similarity

__all__ = ["Similarity", "compare"]


def compare(one: Road, other: Road, mirror: bool = False) -> Similarity:
    """Returns how similar two roads are, in the criteria of the thesis' survey.

    Args:
        one: a road.
        other: the road to compare it with.
        mirror: whether a road and its mirror image count as the same.

    Raises:
        UsageError: a road has no two different points.
    """
    return similarity(likeness(one), likeness(other), mirror)
