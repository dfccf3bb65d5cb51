"""The order of pages of each rater: random, but the same whenever they come back."""

import numpy as np

from roadgpt.study.survey.survey import QuestionPage, Survey


def pages_for(survey: Survey, digest: str) -> tuple[QuestionPage, ...]:
    """All pages in the order of one rater.

    About the rater first; then the roads in random order, with the attention check among them but neither
    first nor last (where there are two roads or more); then the pairs in random order; then the end.

    Args:
        survey: what is asked.
        digest: of the rater's token, hexadecimal.
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
