"""Converts the answers to a survey into table rows, one row per answer, for export and analysis."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.report.page.text import unformulated
from roadgpt.run.atomic import csv_text
from roadgpt.study.survey.questions import CHECK, MATCHES, Part, Question
from roadgpt.study.survey.store import AnswerStore, code_of
from roadgpt.study.survey.survey import Survey

Source = Literal["people", "synthetic"]
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
    """The criterion that is rated, or "overall"; empty if the question is not a rating."""
    question: str
    answer: str
    score: int | None
    """The score of a rating, 1 to 5; None if the question is not a rating."""
    page_of_rater: int
    """Number of the page, counted from 1, on which this rater saw the question; raters see pages in
    different orders."""


@dataclass(frozen=True)
class Answers:
    """All answers to a survey, and the numbers of raters who were invited, who take part (``agreed``), and
    who withdrew."""

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
    def finished(self) -> int:
        """Number of raters who rated every road and whose answers are analysed."""
        asked = {
            question.id for item in self.survey.items for question in item.questions if question.is_rating
        }
        by_rater: dict[str, set[str]] = {}
        for row in self.used:
            by_rater.setdefault(row.rater, set()).add(row.question)
        return sum(asked <= given for given in by_rater.values())


def answers_in(store: AnswerStore, survey: Survey) -> Answers:
    """Returns the answers of all people who agreed to take part and did not withdraw."""
    raters = store.raters()
    given = {rater.digest: store.answers_of(rater) for rater in raters if rater.state == "agreed"}
    states = [rater.state for rater in raters]
    return answers_of_raters(survey, given, "people", len(raters), states.count("withdrawn"))


def answers_of_raters(
    survey: Survey, given: Mapping[str, Mapping[str, str]], source: Source, invited: int, withdrawn: int = 0
) -> Answers:
    """Returns the answers of several raters as table rows.

    Args:
        survey: the survey.
        given: the answers of each rater by question; the keys are the digests that identify the raters.
        source: whether the raters are people or simulated.
        invited: number of invited raters.
        withdrawn: number of raters who withdrew.
    """
    rows = [row for digest in sorted(given) for row in _rows(survey, digest, given[digest], source)]
    return Answers(survey, source, tuple(rows), invited, len(given), withdrawn)


def _rows(survey: Survey, digest: str, given: Mapping[str, str], source: Source) -> list[AnswerRow]:
    attention = _attention(survey, given)
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


def _attention(survey: Survey, given: Mapping[str, str]) -> Attention:
    if not survey.has_check:
        return "not asked"
    if "check" not in given:
        return "not answered"
    return "passed" if given["check"] == MATCHES[CHECK] else "failed"


def csv_of(rows: Sequence[AnswerRow]) -> str:
    """Returns the rows as CSV; text that a spreadsheet would evaluate as a formula is prefixed with an
    apostrophe."""
    return csv_text(AnswerRow._fields, ([unformulated(value) for value in row] for row in rows))


def synthetic(
    survey: Survey, number: int, seed: int = 0, agreement: float = 0.8, failing: float = FAILING
) -> Answers:
    """Returns the answers of simulated raters.

    Every rating question has a hidden true answer, which differs from road to road. A rater gives the true
    answer with the probability ``agreement`` and otherwise a random answer. Krippendorff's alpha is therefore
    1 if ``agreement`` is 1, and near 0 if ``agreement`` is 0.

    Args:
        survey: the survey.
        number: number of simulated raters.
        seed: seed of the answers.
        agreement: probability of the true answer, 0 to 1.
        failing: fraction of raters who fail the attention check and answer at random, 0 to 1.

    Raises:
        UsageError: ``number``, ``agreement`` or ``failing`` is out of range.
    """
    if not 1 <= number <= MOST or not 0 <= agreement <= 1 or not 0 <= failing <= 1:
        raise UsageError(f"made-up raters are 1 to {MOST:,}, and shares lie between 0 and 1")
    rng = np.random.default_rng(seed)
    truth = _truths(survey, rng)
    given = {}
    for rater in range(number):
        digest = hashlib.sha256(f"synthetic {seed} {rater}".encode()).hexdigest()
        is_awake = bool(rng.random() >= failing)
        given[digest] = _answers(survey, truth, agreement if is_awake else 0.0, is_awake, rng)
    return answers_of_raters(survey, given, "synthetic", number)


def _truths(survey: Survey, rng: np.random.Generator) -> dict[str, int]:
    """Returns the index of each rating's true answer. It is random for the first road, separately for each
    criterion, and increases by one from road to road.

    If the true answer were the same for all roads, agreement between raters could not be measured.
    """
    start: dict[tuple[str, str], int] = {}
    truth: dict[str, int] = {}
    for item in survey.items:
        for question in item.questions:
            if question.is_rating:
                key, size = (item.part, question.criterion), len(question.answers)
                truth[question.id] = start.setdefault(key, int(rng.integers(size))) % size
                start[key] += 1
    return truth


def _answers(
    survey: Survey, truth: Mapping[str, int], agreement: float, is_awake: bool, rng: np.random.Generator
) -> dict[str, str]:
    said = {id_: _answer(question, truth, agreement, rng) for id_, question in survey.questions.items()}
    if "check" in said:
        said["check"] = MATCHES[CHECK] if is_awake else MATCHES[0]
    return {id_: value for id_, value in said.items() if value}


def _answer(question: Question, truth: Mapping[str, int], agreement: float, rng: np.random.Generator) -> str:
    if not question.answers:
        return REMARK if rng.random() < 0.1 else ""
    says_truth = question.is_rating and rng.random() < agreement
    place = truth[question.id] if says_truth else int(rng.integers(len(question.answers)))
    return question.answers[place]
