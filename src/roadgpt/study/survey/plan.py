"""Reads and writes SURVEY.toml, which contains the texts of a survey and names the roads that people rate."""

import json
import tomllib
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError

from roadgpt.brief.model import Frozen
from roadgpt.errors import UsageError
from roadgpt.reading import read_text
from roadgpt.study.survey.questions import ABOUT, PAIR_CRITERIA, Question

Words = Annotated[str, Field(min_length=1, max_length=4000)]
PURPOSE = (
    "A program made roads from descriptions, for tests of self-driving cars. We want to know whether people "
    "find that the roads match their descriptions, and how different two roads of one description are. "
    "It takes about {minutes} minutes."
)
KEEPS = (
    "Answers are stored on a computer of the people who run this survey. They are published only as totals "
    "over all raters and as single remarks without names."
)
PER_PAGE = 1.5  # minutes that a page takes, roughly: plots, films, a handful of questions


class RoadPlan(Frozen):
    """A road that people compare with its description."""

    run: Words
    """Path of a run's folder or of its file test.NNNN.json, relative to SURVEY.toml."""
    prompt: str = ""
    """The description that raters see; empty: the description from which the road was made."""
    criteria: tuple[Words, ...] | None = None
    """The criteria that are rated; None: those that the description mentions."""

    @property
    def names(self) -> tuple[str, ...]:
        """The path of the road's run, as a tuple of one element."""
        return (self.run,)


class PairPlan(Frozen):
    """Two roads made from one description, which people compare with each other."""

    runs: tuple[Words, Words]
    prompt: str = ""
    criteria: tuple[Words, ...] = PAIR_CRITERIA

    @property
    def names(self) -> tuple[str, ...]:
        """The paths of the two runs."""
        return self.runs


class AboutPlan(Frozen):
    """A question about the rater. Questions in SURVEY.toml replace the standard questions."""

    text: Words
    answers: Annotated[tuple[Words, ...], Field(min_length=2, max_length=20)]


class SurveyPlan(Frozen):
    """The contents of SURVEY.toml."""

    title: Words = "Roads from words"
    asks: Words
    contact: Words
    purpose: str = ""
    keeps: Words = KEEPS
    attention_check: bool = True
    films: bool = True
    views: bool = True
    about: Annotated[tuple[AboutPlan, ...], Field(max_length=30)] | None = None
    """Questions about the rater; None: the thesis' six questions; an empty list: no questions."""
    alignment: Annotated[tuple[RoadPlan, ...], Field(max_length=200)] = ()
    similarity: Annotated[tuple[PairPlan, ...], Field(max_length=200)] = ()

    @property
    def said_purpose(self) -> str:
        """The text that raters read about the purpose of the survey."""
        if self.purpose:
            return self.purpose
        minutes = round(PER_PAGE * (len(self.alignment) + len(self.similarity)) + 2)
        return PURPOSE.format(minutes=minutes)

    @property
    def questions(self) -> tuple[Question, ...]:
        """The questions about the rater."""
        if self.about is None:
            return ABOUT
        return tuple(
            Question(id=f"about.{number}", text=each.text, answers=each.answers)
            for number, each in enumerate(self.about, 1)
        )


def read_plan(path: Path | str) -> SurveyPlan:
    """Returns the contents of a SURVEY.toml.

    Raises:
        UsageError: the file does not exist, is not TOML, names no road, or has a wrong key or value.
    """
    path = Path(path)
    try:
        data = tomllib.loads(read_text(path, 4_000_000, "the plan of a survey"))
    except OSError as error:
        raise UsageError(
            f"{path} cannot be read ({error.strerror or error}); name the file of a survey"
        ) from error
    except (ValueError, RecursionError) as error:
        raise UsageError(f"{path} is not valid TOML ({error}); correct it") from error
    try:
        plan = SurveyPlan.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part + 1 if isinstance(part, int) else part) for part in first["loc"])
        raise UsageError(f"{path}: {where}: {first['msg'].lower()}; correct the file") from error
    if not plan.alignment and not plan.similarity:
        raise UsageError(f'{path} names no road; add [[alignment]] with run = "DIR/runs/0001"')
    return plan


def plan_text(plan: SurveyPlan) -> str:
    """Returns the text of a SURVEY.toml file for a plan, so that users can edit it."""
    own: dict[str, Any] = plan.model_dump(mode="json", exclude={"about", "alignment", "similarity"})
    own["purpose"] = plan.said_purpose
    lines = ["# The survey. Change it and say: roadgpt study survey new SURVEY.toml --out DIR"]
    lines += [f"{name} = {_toml(value)}" for name, value in own.items()]
    for name in ("about", "alignment", "similarity"):
        for item in getattr(plan, name) or ():
            values = item.model_dump(mode="json", exclude_none=True)
            lines += ["", f"[[{name}]]", *(f"{key} = {_toml(value)}" for key, value in values.items())]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    """Returns a value as TOML, in which texts, booleans and lists are as in JSON but for one character."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
