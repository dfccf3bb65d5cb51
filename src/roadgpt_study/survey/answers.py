"""Converts the answers to a survey into table rows, one row per answer, and counts the ratings."""

import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.errors import UsageError
from roadgpt_study.statistics import krippendorff
from roadgpt_study.survey.store import code_of
from roadgpt_study.survey.survey import CHECK, MATCHES, OVERALL, Item, Part, Question, Rated, Survey

Array = NDArray[np.float64]
Source = Literal["people", "synthetic"]
Counts = Sequence[tuple[str, Sequence[tuple[str, int]]]]
"""The text of each question about the raters, and each answer with the number of raters who gave it."""
Attention = Literal["passed", "failed", "not asked", "not answered"]
MOST = 10_000
FAILING = 0.05  # share that fails the attention check
REMARK = "synthetic remark of a made-up rater"


class AnswerRow(NamedTuple):
    """One answer of one rater; its fields are the columns of ``answers.csv``."""

    source: Source
    rater: str
    attention: Attention
    part: Part
    item: str
    prompt: str
    criterion: str
    question: str
    answer: str
    score: int | None
    """The score of a rating, 1 to 5; None if the question is not a rating."""
    page_of_rater: int
    """Number of the page, from 1, on which this rater saw the question; raters see pages in different
    orders."""


@dataclass(frozen=True)
class Answers:
    """All answers to a survey, and how many raters were invited, take part (``agreed``), and withdrew."""

    survey: Survey
    source: Source
    rows: tuple[AnswerRow, ...]
    invited: int
    agreed: int
    withdrawn: int

    @property
    def failed(self) -> frozenset[str]:
        """The raters who failed the attention check; their answers are not analysed."""
        return frozenset(row.rater for row in self.rows if row.attention == "failed")

    @property
    def unchecked(self) -> frozenset[str]:
        """The raters who did not answer the attention check; their answers are analysed."""
        return frozenset(row.rater for row in self.rows if row.attention == "not answered")

    @property
    def used(self) -> tuple[AnswerRow, ...]:
        """The answers that are analysed."""
        return tuple(row for row in self.rows if row.attention != "failed")

    @property
    def analysed(self) -> frozenset[str]:
        """The raters whose answers are analysed."""
        return frozenset(row.rater for row in self.used)

    @property
    def finished(self) -> int:
        """Number of raters who rated every road and whose answers are analysed."""
        asked = {
            question.id for item in self.survey.items for question in item.questions if question.is_rating
        }
        by_rater: dict[str, set[str]] = {}
        for row in self.used:
            by_rater.setdefault(row.rater, set()).add(row.question)
        return sum(asked <= given for given in by_rater.values())


def answers_of_raters(
    survey: Survey, given: Mapping[str, Mapping[str, str]], source: Source, invited: int, withdrawn: int = 0
) -> Answers:
    """Returns the answers of several raters; ``given`` has those of each digest by question."""
    rows = [row for digest in sorted(given) for row in _rows(survey, digest, given[digest], source)]
    return Answers(survey, source, tuple(rows), invited, len(given), withdrawn)


def _rows(survey: Survey, digest: str, given: Mapping[str, str], source: Source) -> list[AnswerRow]:
    if not survey.has_check:
        attention: Attention = "not asked"
    elif "check" not in given:
        attention = "not answered"
    else:
        attention = "passed" if given["check"] == MATCHES[CHECK] else "failed"
    return [
        AnswerRow(
            source=source,
            rater=code_of(digest),
            attention=attention,
            part=page.part,
            item=page.item.id if page.item else "",
            prompt=page.item.prompt if page.item else "",
            criterion=question.criterion,
            question=question.id,
            answer=given[question.id],
            score=question.score(given[question.id]) if question.is_rating else None,
            page_of_rater=number,
        )
        for number, page in enumerate(survey.pages_for(digest), 1)
        for question in page.questions
        if question.id in given
    ]


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


def about_counts(answers: Answers) -> Counts:
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


def alpha_of(units: Sequence[Unit]) -> float:
    """Returns Krippendorff's alpha of ordinal ratings; NaN if it is undefined, as for a single unit."""
    return krippendorff(score_matrix(units)) if len(units) > 1 else float("nan")


def synthetic(
    survey: Survey, number: int, seed: int = 0, agreement: float = 0.8, failing: float = FAILING
) -> Answers:
    """Returns the answers of simulated raters. Every rating question has a hidden true answer, which differs
    from road to road; a rater gives it with the probability ``agreement``, and otherwise a random answer. So
    Krippendorff's alpha is 1 if ``agreement`` is 1, and near 0 if it is 0. The fraction ``failing`` of the
    raters fails the attention check and answers at random."""
    if not 1 <= number <= MOST or not 0 <= agreement <= 1 or not 0 <= failing <= 1:
        raise UsageError(f"made-up raters are 1 to {MOST:,}, and shares lie between 0 and 1")
    rng = np.random.default_rng(seed)
    truth = _truths(survey, rng)
    given = {}
    for rater in range(number):
        digest = hashlib.sha256(f"synthetic {seed} {rater}".encode()).hexdigest()
        is_awake = bool(rng.random() >= failing)
        agrees = agreement if is_awake else 0.0
        said = {id_: _answer(question, truth, agrees, rng) for id_, question in survey.questions.items()}
        if "check" in said:
            said["check"] = MATCHES[CHECK] if is_awake else MATCHES[0]
        given[digest] = {id_: value for id_, value in said.items() if value}
    return answers_of_raters(survey, given, "synthetic", number)


def _truths(survey: Survey, rng: np.random.Generator) -> dict[str, int]:
    """Returns the index of each rating's true answer: random for the first road and each criterion, and one
    more from road to road. Without differences, agreement could not be measured."""
    start: dict[tuple[str, str], int] = {}
    truth: dict[str, int] = {}
    for item in survey.items:
        for question in item.questions:
            if question.is_rating:
                key, size = (item.part, question.criterion), len(question.answers)
                truth[question.id] = start.setdefault(key, int(rng.integers(size))) % size
                start[key] += 1
    return truth


def _answer(question: Question, truth: Mapping[str, int], agreement: float, rng: np.random.Generator) -> str:
    if not question.answers:
        return REMARK if rng.random() < 0.1 else ""
    says_truth = question.is_rating and rng.random() < agreement
    place = truth[question.id] if says_truth else int(rng.integers(len(question.answers)))
    return question.answers[place]
