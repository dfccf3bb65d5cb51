"""Puts the pages of a questionnaire into a random order, which stays the same for each rater."""

import numpy as np

from roadgpt.study.survey.survey import QuestionPage, Survey


def pages_for(survey: Survey, digest: str) -> tuple[QuestionPage, ...]:
    """Returns all pages in the order of one rater.

    The page about the rater comes first, then the roads in random order, then the pairs in random order,
    then the end. The attention check stands among the roads,
    neither first nor last if there are two roads or more.

    Args:
        survey: the survey.
        digest: digest of the rater's token, hexadecimal.
    """
    rng = np.random.default_rng(int(digest, 16))
    by_part = {part: [page for page in survey.pages if page.part == part] for part in
               ("about", "alignment", "check", "similarity", "end")}  # fmt: skip
    roads, pairs = _shuffled(by_part["alignment"], rng), _shuffled(by_part["similarity"], rng)
    among = roads if roads else pairs
    if by_part["check"]:
        place = int(rng.integers(1, len(among))) if len(among) > 1 else len(among)
        among[place:place] = by_part["check"]
    return (*by_part["about"], *roads, *pairs, *by_part["end"])


def _shuffled(pages: list[QuestionPage], rng: np.random.Generator) -> list[QuestionPage]:
    return [pages[i] for i in rng.permutation(len(pages))]
