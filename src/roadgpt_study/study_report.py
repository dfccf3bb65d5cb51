"""Writes the report of a study, from the files in its folder."""

from collections.abc import Mapping, Sequence
from itertools import combinations, product
from pathlib import Path

import numpy as np

from roadgpt.plural import plural
from roadgpt.reading import read_json
from roadgpt.report.chapters.alignment import alignment
from roadgpt.report.chapters.roads import overview
from roadgpt.report.chapters.wording import decimal, row
from roadgpt.report.page import write
from roadgpt.report.page.model import Page, Table, TableCell
from roadgpt.report.road_record import RoadGroup, read_group
from roadgpt.report.run_report import card_of, comparisons_of, sentences_of
from roadgpt.report.similarity import similarity
from roadgpt.run.atomic import json_text, write_whole
from roadgpt_study.execution import Problem
from roadgpt_study.plan import StudyPlan, read_plan
from roadgpt_study.statistics import bootstrap
from roadgpt_study.validity import NAME, THESIS_LEFT, THESIS_VALID, departures, of_thesis, validity

PROBLEMS = "problems.json"
MOST_BETWEEN = 40  # roads of a study part that are compared with those of another part
BESIDE = (
    f"; {NAME} had {THESIS_VALID.share} by its own checks",
    f"; in the thesis on {THESIS_LEFT.share}",
)


def keep_problems(folder: Path, problems: Sequence[Problem]) -> None:
    """Writes the reasons for missing roads into the study's folder, so that later reports can show them."""
    sentences = {problem.part: problem.sentence for problem in problems}
    write_whole(folder / PROBLEMS, json_text(sentences))


def write_study(folder: Path) -> Path:
    """Writes the report of a study into its folder and returns the path of the HTML page."""
    plan = read_plan(folder)
    problems = _problems(folder)
    parts = [
        read_group(
            folder / part.name,
            part.designer,
            part.prompt.prompt,
            part.prompt.truth,
            number=part.number,
            id=part.prompt.id,
            home=part.name,
            problem=problems.get(part.name, ""),
            wanted=plan.roads,
        )
        for part in plan.parts()
    ]
    return write(page_of(plan, parts), folder)


def _problems(folder: Path) -> Mapping[str, str]:
    try:
        found = read_json(folder / PROBLEMS)
    except (OSError, ValueError):
        return {}
    return {str(key): str(value) for key, value in found.items()} if isinstance(found, dict) else {}


def page_of(plan: StudyPlan, parts: Sequence[RoadGroup]) -> Page:
    """Returns the page with the report of a study."""
    is_thesis = plan.kind == "thesis"
    valid, left = (make(parts, plan.designers, has_baseline=is_thesis) for make in (validity, departures))
    kept = alignment(parts, plan.designers, lambda asking: bootstrap(asking)[1])
    first = overview(parts, plan.world.site.map_size)
    own = [valid, left, kept] if is_thesis else [kept, valid, *([left] if plan.setup.drives else [])]
    title = "The evaluation of RoadGPT's thesis, done again" if is_thesis else "Do roads keep the words?"
    lead = f"{plural(len(plan.prompts), 'description')}, {plural(plan.roads, 'road')} each"
    return Page(
        title,
        _summary(plan, parts),
        [*([first] if first else []), *own, *comparisons_of(parts, plan.world, [_between(parts)])],
        card_of(plan.command, plan.roads, plan.seed, plan.setup, plan.world, parts),
        f"{lead}, seed {plan.seed}" + (f", from {plan.source}" if plan.source else ""),
    )


def _summary(plan: StudyPlan, parts: Sequence[RoadGroup]) -> list[str]:
    lines = []
    for designer in plan.designers:
        own = [part for part in parts if part.designer == designer]
        if not any(part.roads for part in own):
            problem = next((part.problem for part in own if part.problem), "nothing was made")
            lines.append(f"{designer} was not run: {problem}.")
            continue
        if plan.kind == "thesis":
            said = sentences_of(own, plan.world, counted=of_thesis(own), beside=BESIDE)
        else:
            said = sentences_of(own, plan.world)
        lines += said if len(plan.designers) == 1 else [f"{designer}: {sentence}" for sentence in said]
    return lines


def _between(parts: Sequence[RoadGroup]) -> Table:
    rows: list[list[TableCell]] = []
    for designer in dict.fromkeys(part.designer for part in parts):
        own = [part for part in parts if part.designer == designer and part.roads][:6]
        for one, other in combinations(own, 2):
            compared = product(one.likenesses[:MOST_BETWEEN], other.likenesses[:MOST_BETWEEN])
            found = [similarity(*pair, mirror=True) for pair in compared]
            general = decimal(float(np.mean([each.general for each in found])) if found else None)
            nearest = decimal(min((each.metres for each in found), default=None), 1)
            duplicates = sum(each.is_duplicate for each in found)
            rows.append(row(one.words, other.words, designer, general, nearest, duplicates))
    heads = ["prompt", "and", "made by", "mean similarity", "nearest pair, m", "near duplicates"]
    note = f"The first {MOST_BETWEEN} roads of either, each with each."
    return Table("diversity-between", "Roads of different descriptions", heads, rows, note)
