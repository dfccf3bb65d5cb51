"""Studies: the thesis' evaluation on any designer, and people's own. Makes a Study. Verb: ``compare``.

``working``     makes the campaigns of a Plan: descriptions, designers, so many roads of each
``reporting``   writes what came of them as one page with its tables
``truth``       what a description asks for, as people wrote it down; ``criteria`` holds roads against it
``similarity``  how alike two roads are: turns, their order and sides, length, incline, shape
``statistics``  the tests and intervals that all of these, and the survey of people, are judged by
"""

from roadgpt.road import Road
from roadgpt.study.similarity import Similarity, likeness, similarity

__all__ = ["Similarity", "compare"]


def compare(one: Road, other: Road, mirror: bool = False) -> Similarity:
    """How alike two roads are, in the criteria of the thesis' survey.

    Args:
        one: a road, however it was made.
        other: a road to compare it with.
        mirror: a road and its mirror image count as alike.

    Raises:
        UsageError: a road has no two different points.
    """
    return similarity(likeness(one), likeness(other), mirror)
