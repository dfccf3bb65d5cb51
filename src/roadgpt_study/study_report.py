"""Writes the report of a study, from the files in its folder."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from itertools import combinations, product
from pathlib import Path

import numpy as np

from roadgpt.campaign.folder_record import has_tests, open_record
from roadgpt.campaign.record import Record
from roadgpt.plural import plural
from roadgpt.reading import read_json
from roadgpt.report.chapters.alignment import alignment
from roadgpt.report.chapters.roads import overview
from roadgpt.report.chapters.validity import LEFT, outside_sentences, passed_tests, source_of
from roadgpt.report.chapters.wording import decimal, row
from roadgpt.report.page import write
from roadgpt.report.page.model import Page, Table, TableCell, cell
from roadgpt.report.report import card_of, comparisons_of, kept_and_alike, valid_sentence
from roadgpt.report.road_record import RoadGroup, read_group
from roadgpt.report.similarity import similarity
from roadgpt.run import Request
from roadgpt.run.atomic import json_text, write_whole
from roadgpt_study.execution import Problem
from roadgpt_study.plan import StudyPlan, read_plan
from roadgpt_study.statistics import bootstrap
from roadgpt_study.validity import NAME, THESIS_LEFT, THESIS_VALID, departures, of_thesis, validity

PROBLEMS = "problems.json"
MOST_BETWEEN = 40  # roads of a study part that are compared with those of another part
BESIDE = (f"; {NAME} had {THESIS_VALID.share} by its own checks", f"; in the thesis on {THESIS_LEFT.share}")


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
            id=part.prompt.id,
            name=part.name,
            problem=problems.get(part.name, ""),
            wanted=plan.roads,
        )
        for part in plan.parts()
    ]
    with ExitStack() as stack:
        records = {
            part.name: stack.enter_context(open_record(folder / part.name))
            for part in parts
            if has_tests(folder / part.name)
        }
        return write(page_of(plan, parts, records), folder)


def _problems(folder: Path) -> Mapping[str, str]:
    try:
        found = read_json(folder / PROBLEMS)
    except (OSError, ValueError):
        return {}
    return {str(key): str(value) for key, value in found.items()} if isinstance(found, dict) else {}


def page_of(plan: StudyPlan, parts: Sequence[RoadGroup], records: Mapping[str, Record]) -> Page:
    """Returns the page with the report of a study; ``records`` are those of its parts, by name."""
    is_thesis, passed = plan.kind == "thesis", passed_tests([*records.values()])
    valid = validity(parts, plan.designers, has_baseline=is_thesis)
    left = departures(parts, plan.designers, passed, has_baseline=is_thesis)
    kept = alignment(parts, plan.designers, lambda asking: bootstrap(asking)[1])
    own = [valid, left, kept] if is_thesis else [kept, valid, *([left] if plan.setup.drives else [])]
    first = _glance(parts)
    own += comparisons_of(parts, [*records.values()], [_between(parts)])
    requests = [
        Request(setup=plan.setup_of(name), world=plan.world, seed=plan.seed) for name in plan.designers
    ]
    title = "The evaluation of RoadGPT's thesis, done again" if is_thesis else "Do roads keep the words?"
    lead = f"{plural(len(plan.prompts), 'description')}, {plural(plan.roads, 'road')} each"
    versions = [part.versions for part in parts]
    return Page(
        title,
        _summary(plan, parts, records),
        [*([overview(parts, first)] if first.rows else []), *own],
        card_of(plan.command, requests, versions, parts, f"{plan.roads:,} of each"),
        f"{lead}, seed {plan.seed}" + (f", from {plan.source}" if plan.source else ""),
    )


def _glance(parts: Sequence[RoadGroup]) -> Table:
    heads = [
        "description", "made by", "roads", "valid", "keep every word", "driven", "left the lane",
        "nearest two plans, m", "near duplicates",
    ]  # fmt: skip
    note = (
        "Nearest two plans: root mean square distance of the two most similar roads, after the best shift, "
        "turn and mirroring. The sections below contain intervals, tests and every road."
    )
    rows = []
    for part in (each for each in parts if each.roads):
        good, driven, several = part.kept("general"), part.count("is_driven"), len(part.compared) > 1
        rows.append(
            row(
                cell(part.words, href=part.overview),
                part.designer,
                len(part.roads),
                part.count("is_valid"),
                sum(good) if good else None,
                driven or None,
                part.count("has_left") if driven else None,
                decimal(float(np.min(part.spread.nearest)) if several else None, 1),
                len(part.spread.duplicates) if several else None,
            )
        )
    return Table("glance", "Roads by description", heads, rows, note)


def _summary(plan: StudyPlan, parts: Sequence[RoadGroup], records: Mapping[str, Record]) -> list[str]:
    lines, is_thesis = [], plan.kind == "thesis"
    for designer in plan.designers:
        own = [part for part in parts if part.designer == designer]
        if not any(part.roads for part in own):
            problem = next((part.problem for part in own if part.problem), "nothing was made")
            lines.append(f"{designer} was not run: {problem}.")
            continue
        counted, beside = (of_thesis(own), BESIDE) if is_thesis else (own, ("", ""))
        left = source_of(designer, counted, LEFT)
        passed = passed_tests([records[part.name] for part in own if part.name in records])
        said = [
            *valid_sentence(designer, counted, beside[0]),
            *([f"The car left its lane on {left.share} driven roads{beside[1]}."] if left.total else []),
            *outside_sentences(passed, plan.world),
            *kept_and_alike(own),
        ]
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
