"""Simulates raters, to try out the analysis before people answer. Simulated answers are never mixed with
answers of people."""

import hashlib
from collections.abc import Mapping

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.study.survey.answers import Answers, answers_of_raters
from roadgpt.study.survey.questions import CHECK, MATCHES, Question
from roadgpt.study.survey.survey import Survey

MOST = 10_000
FAILING = 0.05  # share that fails the attention check
REMARK = "synthetic remark of a made-up rater"


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
