"""Reads and writes SURVEY.toml, which contains the texts of a survey and names the roads that people rate."""

import json
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from roadgpt.brief.model import Brief, Clause, Frozen
from roadgpt.brief.normal import BUMPS, STRAIGHT
from roadgpt.brief.sentence import WAVY
from roadgpt.errors import UsageError
from roadgpt.reading import read_text, toml_of
from roadgpt.run import Run, read_run, seed_of
from roadgpt.run.folder import RUNS, finished, run_folder
from roadgpt_study.survey.survey import ABOUT, PAIR_CRITERIA, TABLE, Question

Words = Annotated[str, Field(min_length=1, max_length=4000)]
PER_PAGE = 1.5  # minutes that a page takes, roughly: plots, films, a handful of questions
DEEPEST = 4  # folders below the study's in which campaigns are looked for


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
    keeps: Words = TABLE["keeps"]
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
        return str(TABLE["purpose"]).format(minutes=minutes)

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
    """Returns the contents of a SURVEY.toml."""
    path = Path(path)
    try:
        data = toml_of(read_text(path, 4_000_000, "the plan of a survey"))
    except OSError as error:
        raise UsageError(
            f"{path} cannot be read ({error.strerror or error}); name the file of a survey"
        ) from error
    except ValueError as error:
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
    lines = ["# The survey. After a change, make it anew with 'roadgpt study survey new'."]
    lines += [f"{name} = {_toml(value)}" for name, value in own.items()]
    for name in ("about", "alignment", "similarity"):
        for item in getattr(plan, name) or ():
            values = item.model_dump(mode="json", exclude_none=True)
            lines += ["", f"[[{name}]]", *(f"{key} = {_toml(value)}" for key, value in values.items())]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    """Returns a value as TOML, in which texts, booleans and lists are as in JSON but for one character."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def criteria_of(brief: Brief | None) -> tuple[str, ...]:
    """Returns the criteria that a description mentions: "turns", "incline", "order". Roads of a description
    that mentions none, such as "a road", are rated only as a whole, as in the thesis."""
    if brief is None:
        return ()
    clauses = [*brief.clauses, *filter(None, (brief.starts, brief.ends))]
    # "at least one turn" says nothing, since every road has one
    amounts = [(each.lo, each.hi) for each in (brief.turns, brief.left, brief.right) if each]
    slopes = (brief.slope, brief.incline, brief.steepest, brief.climb, brief.hills)
    rises = [each for each in clauses if each.slope or each.incline or each.kind in BUMPS]
    mentioned = {
        "turns": any(amount != (1, None) for amount in amounts) or any(map(_has_a_number, clauses)),
        "incline": any(slopes) or rises,
        "order": len(clauses) > 1,
    }
    return tuple(name for name, is_mentioned in mentioned.items() if is_mentioned)


def _has_a_number(clause: Clause) -> bool:
    if clause.kind in STRAIGHT:
        return False
    return clause.kind not in WAVY or clause.count.lo != 1 or clause.count.hi != 1


def plan_from_runs(study: Path | str, asks: str, contact: str, seed: int = 0, pairs: int = 2) -> SurveyPlan:
    """Returns the plan of a survey, with valid roads selected at random from each folder of runs in
    ``study``. For up to ``pairs`` descriptions, two roads are also compared with each other; one of them is
    also the one that is compared with the description, if there are no more."""
    study = Path(study).resolve()
    alignment, similarity = list[RoadPlan](), list[PairPlan]()
    campaigns = {runs.parent for depth in range(DEEPEST) for runs in study.glob(f"{'*/' * depth}{RUNS}")}
    for number, campaign in enumerate(sorted(campaigns), 1):
        drawn = _drawn(campaign, seed_of(seed, number), 3 if len(similarity) < pairs else 1)
        if not drawn:
            continue
        (first, run), *others = drawn
        alignment.append(RoadPlan(run=first, prompt=run.words, criteria=criteria_of(run.brief)))
        two = others if len(others) == 2 else drawn
        if len(similarity) < pairs and len(two) == 2:
            similarity.append(PairPlan(runs=(two[0][0], two[1][0]), prompt=run.words))
    if not alignment:
        raise UsageError(f"{study} holds no runs with a valid road; make some with 'roadgpt run'")
    return SurveyPlan(asks=asks, contact=contact, alignment=tuple(alignment), similarity=tuple(similarity))


def _drawn(campaign: Path, seed: int, most: int) -> list[tuple[str, Run]]:
    """Selects different runs at random: valid roads that were made from words, driven roads first."""
    indices = np.random.default_rng(seed).permutation(finished(campaign))
    valid, driven = list[tuple[str, Run]](), list[tuple[str, Run]]()
    for index in indices:
        folder = run_folder(campaign, int(index))
        run = read_run(folder)
        if run.is_valid and run.words:
            (valid if run.drive is None else driven).append((str(folder), run))
        if len(driven) == most:
            break
    return (driven + valid)[:most]
