"""Counts how raters rated each road by each criterion."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from roadgpt.study.statistics import Interval, krippendorff, wilson
from roadgpt.study.survey.answers import Answers
from roadgpt.study.survey.questions import OVERALL, Question
from roadgpt.study.survey.survey import Item

Array = NDArray[np.float64]
Rated = Literal["alignment", "similarity"]
FAVOURABLE = 4  # lowest score that is in favour of the road, or of the two roads being similar


@dataclass(frozen=True, eq=False)
class Unit:
    """The ratings that all raters gave to one item (a road or a pair of roads) for one criterion."""

    item: Item
    question: Question
    scores: Array
    """Scores of all raters, 1 to 5; NaN if a rater did not answer."""

    @property
    def criterion(self) -> str:
        """The criterion that was rated, or "overall"."""
        return self.question.criterion

    @property
    def given(self) -> Array:
        """The scores of the raters who answered."""
        return self.scores[np.isfinite(self.scores)]

    @property
    def number(self) -> int:
        """Number of raters who rated the item."""
        return len(self.given)

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of raters who gave each answer of the scale."""
        return tuple(int((self.given == score).sum()) for score in range(1, len(self.question.answers) + 1))

    @property
    def quartiles(self) -> tuple[float, float, float]:
        """Lower quartile, median and upper quartile of the scores; NaN if nobody rated the item."""
        if not self.number:
            return (float("nan"),) * 3
        low, middle, high = np.quantile(self.given, [0.25, 0.5, 0.75])
        return float(low), float(middle), float(high)

    @property
    def favourable(self) -> tuple[int, Interval]:
        """Number of scores 4 and 5, and Wilson's interval of their proportion among all scores."""
        count = int((self.given >= FAVOURABLE).sum())
        return count, wilson(count, self.number) if self.number else Interval(float("nan"), float("nan"))

    @property
    def measured(self) -> float | None:
        """The measured score (0 to 1) of the item for this criterion; None if it was not measured."""
        return self.item.machine.get(self.criterion)


@dataclass(frozen=True, eq=False)
class RatingTally:
    """All ratings in one part of the survey: "alignment" or "similarity"."""

    part: Rated
    raters: tuple[str, ...]
    units: tuple[Unit, ...]

    @property
    def overall(self) -> tuple[Unit, ...]:
        """The ratings for the overall question, one Unit per item."""
        return self.of(OVERALL)

    @property
    def criteria(self) -> tuple[str, ...]:
        """All rated criteria, "overall" first."""
        return tuple(dict.fromkeys(unit.criterion for unit in self.units))

    def of(self, criterion: str) -> tuple[Unit, ...]:
        """Returns the ratings for one criterion, one Unit per item."""
        return tuple(unit for unit in self.units if unit.criterion == criterion)


def about_counts(answers: Answers) -> list[tuple[str, list[tuple[str, int]]]]:
    """Returns, for each question about the raters, its text and how many raters gave each answer."""
    given = Counter((row.question, row.answer) for row in answers.used if row.part == "about")
    return [
        (question.text, [(answer, given[question.id, answer]) for answer in question.answers])
        for question in answers.survey.about
        if question.answers
    ]


def tally(answers: Answers, part: Rated) -> RatingTally:
    """Returns the ratings in one part of the survey by all raters whose answers are analysed."""
    scores = {
        (row.rater, row.question): row.score
        for row in answers.used
        if row.part == part and row.score is not None
    }
    raters = tuple(sorted({rater for rater, _ in scores}))
    units = [
        Unit(item, question, np.array([scores.get((rater, question.id), np.nan) for rater in raters], float))
        for item in answers.survey.of_part(part)
        for question in item.questions
        if question.is_rating
    ]
    return RatingTally(part, raters, tuple(units))


def score_matrix(units: Sequence[Unit]) -> Array:
    """Returns the scores of several units as an array ``(raters, units)``; NaN if a rater did not answer."""
    return np.stack([unit.scores for unit in units], axis=1)


def agreement(units: Sequence[Unit]) -> float:
    """Returns Krippendorff's alpha of the ratings as ordinal data; NaN if it is undefined, as for a
    single unit."""
    if len(units) < 2 or not len(units[0].scores):
        return float("nan")
    return krippendorff(score_matrix(units))
