"""Defines a survey that can be served: its texts, roads and questions, as stored in ``survey.json``.

The texts and questions of every questionnaire are in ``questionnaire.toml``.
"""

import tomllib
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from roadgpt.brief.model import Frozen
from roadgpt.reading import read_model, read_text

CARD = "survey.json"
MEDIA = "media"
Part = Literal["about", "alignment", "check", "similarity", "end"]
"""The parts of a questionnaire."""
Rated = Literal["alignment", "similarity"]
"""The parts in which raters rate roads."""
MOST_LETTERS = 2000  # of a remark
REMARKS = "remarks"
OVERALL = "overall"
TABLE: dict[str, Any] = tomllib.loads(read_text(Path(__file__).with_name("questionnaire.toml")))
MATCHES, ALIKE = (tuple[str, ...](TABLE[part]["answers"]) for part in ("alignment", "similarity"))
CHECK = 2  # index in MATCHES of the answer that the attention check asks for
CRITERIA: Mapping[str, str] = TABLE["criteria"]
PAIR_CRITERIA = tuple(CRITERIA.values())


class Question(Frozen):
    """One question with a choice of answers, or with free text if no answers are given."""

    id: str
    text: str
    answers: tuple[str, ...] = ()
    criterion: str = ""
    """The criterion that is rated, or "overall"; empty if the question is not a rating."""
    is_needed: bool = True
    """True if the page reminds raters who leave the question unanswered."""

    @property
    def is_rating(self) -> bool:
        """True if the answer is a rating of a road or of two roads."""
        return bool(self.criterion)

    def takes(self, value: str) -> bool:
        """Returns whether a value is an answer; an empty one deletes an earlier answer."""
        return value in self.answers or not value if self.answers else len(value) <= MOST_LETTERS

    def score(self, value: str) -> int:
        """Returns the position of an answer on the scale of answers, counted from 1."""
        return self.answers.index(value) + 1


ABOUT = tuple(
    Question(id=row["id"], text=row["text"], answers=(*row["answers"], TABLE["about"]["rather_not"]))
    for row in TABLE["about"]["questions"]
)
ATTENTION = Question(id="check", text=TABLE["check"]["text"].format(answer=MATCHES[CHECK]), answers=MATCHES)
END = Question(id="end.remarks", text=TABLE["end"]["text"], is_needed=False)


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
        """An overall rating, a rating for each criterion, and remarks."""
        asked = TABLE[self.part]
        answers = tuple(asked["answers"])
        in_each = (*answers[:-1], asked.get("best_of_each", answers[-1]))
        return (
            Question(id=f"{self.id}.{OVERALL}", text=asked["overall"], answers=answers, criterion=OVERALL),
            *(
                Question(
                    id=f"{self.id}.{number}",
                    text=f"{criterion[:1].upper()}{criterion[1:]}: {asked['each']}",
                    answers=in_each,
                    criterion=criterion,
                )
                for number, criterion in enumerate(self.criteria, 1)
            ),
            Question(id=f"{self.id}.{REMARKS}", text=asked["remarks"], is_needed=False),
        )


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
        """All pages: questions about the rater, roads, pairs of roads, attention check, end."""
        pages = [QuestionPage(part="about", questions=self.about)] if self.about else []
        pages += [
            QuestionPage(part=item.part, questions=item.questions, item=item)
            for item in (*self.of_part("alignment"), *self.of_part("similarity"))
        ]
        if self.has_check:
            pages.append(QuestionPage(part="check", questions=(ATTENTION,)))
        return (*pages, QuestionPage(part="end", questions=(END,)))

    def pages_for(self, digest: str) -> tuple[QuestionPage, ...]:
        """Returns all pages in the order in which one rater sees them, which depends only on the digest of
        the rater's token: roads and pairs of roads in random order, and the attention check at random between
        two roads, or between two pairs if there are no roads."""
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
    """Returns the survey in a folder."""
    absent = f"{folder} holds no survey; make one with 'roadgpt study survey new'"
    return read_model(Survey, Path(folder) / CARD, "a survey", absent, "make the survey again")


def clean(text: str) -> str:
    """Returns text with plain spaces, and with line feeds as line ends. Control characters (except tabs),
    surrogates, and white space at both ends are removed."""
    text = text.replace("\r\n", "\n").replace("\r", "\n").encode("utf-8", "ignore").decode()
    return "".join(map(_letter, text)).strip()


def _letter(letter: str) -> str:
    """White space becomes a plain space (tabs and line feeds are kept); other invisible characters, except
    joiners, go."""
    if letter in "\n\t\u200c\u200d" or letter.isprintable():
        return letter
    return " " if letter.isspace() else ""
