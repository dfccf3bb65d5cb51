"""Defines a survey that can be served: its texts, roads and questions, as stored in ``survey.json``."""

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np

from roadgpt.brief.model import Frozen
from roadgpt.reading import read_model
from roadgpt.study.survey.questions import (
    ABOUT,
    ATTENTION,
    END,
    Part,
    Question,
    Rated,
    rating_questions,
)

CARD = "survey.json"
MEDIA = "media"


class Medium(Frozen):
    """A picture, a film or a 3-D view for raters."""

    name: str
    """Name of the file in the folder ``media``."""
    kind: Literal["picture", "film", "view"]
    title: str


class Item(Frozen):
    """What raters judge: one road with its description, or two roads made from one description."""

    id: str
    part: Rated
    prompt: str
    criteria: tuple[str, ...] = ()
    media: tuple[Medium, ...] = ()
    roads: tuple[str, ...] = ()
    """Paths of the roads' runs; raters do not see them."""
    machine: Mapping[str, float] = {}
    """Measured score (0 to 1) for each criterion; raters do not see these scores."""

    @property
    def questions(self) -> tuple[Question, ...]:
        """The questions about the road or the pair of roads."""
        return rating_questions(self.id, self.part, self.criteria)


class QuestionPage(Frozen):
    """One page of the questionnaire; ``item`` is None if the page is not about roads."""

    part: Part
    questions: tuple[Question, ...]
    item: Item | None = None


class Survey(Frozen):
    """The texts, roads and questions of a survey."""

    format: Literal[1] = 1
    title: str
    asks: str
    """Who conducts the survey: names and institute."""
    contact: str
    purpose: str
    keeps: str
    """What happens to the answers, and how long they are kept."""
    has_check: bool = True
    about: tuple[Question, ...] = ABOUT
    items: tuple[Item, ...]
    lacks: str = ""
    """A sentence that names missing films or other media; empty if no media are missing."""

    def of_part(self, part: Part) -> tuple[Item, ...]:
        """Returns the items in one part of the survey, in the order of ``survey.json``."""
        return tuple(item for item in self.items if item.part == part)

    @cached_property
    def pages(self) -> tuple[QuestionPage, ...]:
        """All pages in a fixed order: questions about the rater, roads, pairs of roads, attention check, end.
        ``pages_for`` returns them in the order in which one rater sees them."""
        pages = [QuestionPage(part="about", questions=self.about)] if self.about else []
        pages += [
            QuestionPage(part=item.part, questions=item.questions, item=item)
            for item in (*self.of_part("alignment"), *self.of_part("similarity"))
        ]
        if self.has_check:
            pages.append(QuestionPage(part="check", questions=(ATTENTION,)))
        return (*pages, QuestionPage(part="end", questions=(END,)))

    def pages_for(self, digest: str) -> tuple[QuestionPage, ...]:
        """Returns all pages in the order in which one rater sees them; the order is always the same for this
        rater.

        The page about the rater comes first, then the roads in random order, then the pairs of roads in
        random order, then the last page. The attention check is placed at random among the roads, or among
        the pairs if there are no roads. If there are two or more roads (or pairs), the attention check is
        neither before the first nor after the last.

        Args:
            digest: digest of the rater's token, hexadecimal.
        """
        rng = np.random.default_rng(int(digest, 16))
        about, roads, check, pairs, end = (
            [page for page in self.pages if page.part == part]
            for part in ("about", "alignment", "check", "similarity", "end")
        )
        roads, pairs = ([pages[i] for i in rng.permutation(len(pages))] for pages in (roads, pairs))
        among = roads if roads else pairs
        if check:
            place = int(rng.integers(1, len(among))) if len(among) > 1 else len(among)
            among[place:place] = check
        return (*about, *roads, *pairs, *end)

    @cached_property
    def questions(self) -> Mapping[str, Question]:
        """All questions by their ids."""
        return {question.id: question for page in self.pages for question in page.questions}

    @cached_property
    def media(self) -> Mapping[str, Medium]:
        """All files that may be sent to raters, by their names."""
        return {medium.name: medium for item in self.items for medium in item.media}


def read_survey(folder: Path | str) -> Survey:
    """Returns the survey in a folder.

    Raises:
        UsageError: there is no survey, or it cannot be read.
    """
    absent = f"{folder} holds no survey; make one: roadgpt study survey new SURVEY.toml --out {folder}"
    return read_model(Survey, Path(folder) / CARD, "a survey", absent, "make the survey again")
