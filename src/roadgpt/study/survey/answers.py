"""Converts the answers to a survey into table rows, one row per answer, for export and analysis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from roadgpt.report.page.text import unformulated
from roadgpt.run.atomic import csv_text
from roadgpt.study.survey.questions import CHECK, MATCHES, Part
from roadgpt.study.survey.store import AnswerStore, code_of
from roadgpt.study.survey.survey import Survey

Source = Literal["people", "synthetic"]
Attention = Literal["passed", "failed", "not asked", "not answered"]


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
