"""Writes the report of a study, or of a folder of ``roadgpt run``, from the files in its folder."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from roadgpt.campaign.faults import faults_in
from roadgpt.errors import UsageError
from roadgpt.reading import read_json
from roadgpt.report.page import Page, Section, write
from roadgpt.road import World
from roadgpt.run import Setup
from roadgpt.run.atomic import json_text, write_whole
from roadgpt.run.card import read_card
from roadgpt.study.baseline import NAME
from roadgpt.study.chapters.alignment import alignment
from roadgpt.study.chapters.card import card_of
from roadgpt.study.chapters.diversity import diversity, spread_of
from roadgpt.study.chapters.faults import Steps, fault_summaries, faults, headline, what_to_try
from roadgpt.study.chapters.out_of_lane import outside_sentences, passed_roads
from roadgpt.study.chapters.roads import Compared, coverage, every_road, overview
from roadgpt.study.chapters.validity import (
    SBFT,
    STRICT,
    THESIS_LEFT,
    THESIS_VALID,
    departures,
    left_source,
    of_thesis,
    valid_source,
    validity,
)
from roadgpt.study.chapters.wording import near_and_far, percent, plural, share_of
from roadgpt.study.execution import Problem
from roadgpt.study.plan import StudyPart, StudyPlan, read_plan
from roadgpt.study.prompts import Prompt
from roadgpt.study.road_record import RoadRecord, StudyPartRecord, read_part

PROBLEMS = "problems.json"

Found = Sequence[Compared]


def keep_problems(folder: Path, problems: Sequence[Problem]) -> None:
    """Writes down why roads are missing, so that later reports can say it."""
    sentences = {problem.part: problem.sentence for problem in problems}
    write_whole(folder / PROBLEMS, json_text(sentences))


def write_study(folder: Path) -> Path:
    """Writes the report of a study and returns the path of its HTML page.

    Raises:
        UsageError: there is no study, or one of its runs cannot be read.
        RoadGPTError: a file cannot be written.
    """
    plan = read_plan(folder)
    problems = _problems(folder)
    parts = [
        read_part(folder / part.name, part, part.name, problems.get(part.name, ""), plan.roads)
        for part in plan.parts()
    ]
    found = [spread_of(part) for part in parts]
    return write(page_of(plan, parts, found), folder)


def _problems(folder: Path) -> Mapping[str, str]:
    try:
        found = read_json(folder / PROBLEMS)
    except (OSError, ValueError):
        return {}
    return {str(key): str(value) for key, value in found.items()} if isinstance(found, dict) else {}


def page_of(plan: StudyPlan, parts: Sequence[StudyPartRecord], found: Found) -> Page:
    """Returns the page with the report of a study."""
    is_thesis = plan.kind == "thesis"
    sections = [
        validity(parts, plan.designers, is_thesis),
        departures(parts, plan.designers, is_thesis),
        alignment(parts, plan.designers),
    ]
    if not is_thesis:
        sections = [sections[2], sections[0], *([sections[1]] if plan.setup.drives else [])]
    first = overview(parts, found, plan.world.map_size)
    sections = [*([first] if first else []), *sections, diversity(parts, found)]
    sections += _pictures(parts, plan.world.map_size)
    summary = [*_summary(plan, parts, found)]
    title = "The evaluation of RoadGPT's thesis, done again" if is_thesis else "Do roads keep the words?"
    lead = f"{plural(len(plan.prompts), 'description')}, {plural(plan.roads, 'road')} each"
    lead += f", seed {plan.seed}" + (f", from {plan.source}" if plan.source else "")
    card = card_of(plan.command, plan.roads, plan.seed, plan.setup, plan.world, parts)
    return Page(title, summary, sections, card, lead)


def _pictures(parts: Sequence[StudyPartRecord], size: float) -> list[Section]:
    covered = coverage(parts)
    return [*([covered] if covered else []), every_road(parts, size)]


def _summary(plan: StudyPlan, parts: Sequence[StudyPartRecord], found: Found) -> list[str]:
    """Returns the sentences of the summary, designer by designer."""
    is_thesis = plan.kind == "thesis"
    lines = []
    for designer in plan.designers:
        own = [part for part in parts if part.designer == designer]
        if not any(part.roads for part in own):
            problem = next((part.problem for part in own if part.problem), "nothing was made")
            lines.append(f"{designer} was not run: {problem}.")
            continue
        counted = of_thesis(own) if is_thesis else own
        said = [*_valid_lines(designer, counted, is_thesis), *_left_lines(designer, counted, is_thesis)]
        passed = passed_roads([road for part in own for road in part.roads])
        said += [*outside_sentences(passed, plan.world), _kept_line(own)]
        pairs = [(p, f) for p, f in zip(parts, found, strict=True) if p.designer == designer]
        said.append(_different_line([f for _, f in pairs]))
        lines += said if len(plan.designers) == 1 else [f"{designer}: {sentence}" for sentence in said]
    return lines


def _valid_lines(designer: str, parts: Sequence[StudyPartRecord], is_thesis: bool) -> list[str]:
    strict, sbft = (valid_source(designer, parts, kind) for kind in (STRICT, SBFT))
    if not strict.total:
        return []
    text = (
        f"{share_of(strict.hits, strict.total)} roads are valid by strict rules, words included, "
        f"and {share_of(sbft.hits, sbft.total)} by the SBFT competition's"
    )
    if not is_thesis:
        return [f"{text}."]
    theirs = THESIS_VALID
    return [f"{text}; {NAME} had {share_of(theirs.hits, theirs.total)} by its own checks."]


def _left_lines(designer: str, parts: Sequence[StudyPartRecord], is_thesis: bool) -> list[str]:
    ours = left_source(designer, parts)
    if not ours.total:
        return []
    theirs = THESIS_LEFT
    beside = f"; in the thesis on {share_of(theirs.hits, theirs.total)}" if is_thesis else ""
    return [f"The car left its lane on {share_of(ours.hits, ours.total)} driven roads{beside}."]


def _kept_line(parts: Sequence[StudyPartRecord]) -> str:
    good = [value for part in parts for value in part.kept("general")]
    counts = [value for part in parts for value in part.kept("turns")]
    text = f"{share_of(sum(good), len(good))} roads keep every word"
    return text + (
        f"; the number of turns is right on {percent(sum(counts) / len(counts))}." if counts else "."
    )


def _different_line(found: Found) -> str:
    nearest = [float(own.nearest.min()) for roads, own in found if len(roads) > 1]
    twins = sum(len(own.duplicates) for _, own in found)
    if not nearest:
        return "There is one road of each description, so there is nothing to compare."
    said = "No near duplicates" if not twins else plural(twins, "pair") + " of near duplicates"
    return (
        f"{said} among roads of one description; the nearest two plans are {min(nearest):.1f} m "
        "apart (root mean square, however shifted, turned or mirrored)."
    )


def write_run_report(folder: Path, command: str = "", next_steps: Steps = ()) -> Path:
    """Writes the report of a folder of ``roadgpt run`` into it and returns the path of its HTML page.

    Args:
        folder: the folder of runs.
        command: the command that makes the runs again, for the report's card.
        next_steps: what to try if nothing failed, as pairs of a description and a command.

    Raises:
        UsageError: there are no runs, or one of them cannot be read.
        RoadGPTError: a file cannot be written.
    """
    card = read_card(folder)
    request, setup = card.request, card.request.setup
    words = request.words or "roads that were given"
    part = read_part(folder, StudyPart(setup.designer, 1, Prompt(id="1", prompt=words)))
    if not part.roads:
        raise UsageError(f"{folder} holds no finished road yet; go on with the same roadgpt run first")
    found = [spread_of(part)]
    first = overview([part], found, request.world.map_size)
    failed = faults_in(folder)
    summaries = fault_summaries(folder, failed)
    opening = [each for each in (first, faults(folder, failed, summaries)) if each is not None]
    sections = [*opening, *what_to_try(next_steps)]
    sections.append(validity([part], [setup.designer], has_baseline=False))
    if setup.drives:
        sections.append(departures([part], [setup.designer], has_baseline=False))
    if request.words:
        sections.append(alignment([part], [setup.designer]))
    sections += [diversity([part], found), *_pictures([part], request.world.map_size)]
    page = Page(
        words,
        [
            *(headline(failed, summaries) if summaries else []),
            *_campaign_summary(part, setup, request.world, found),
        ],
        sections,
        card_of(command, card.roads, request.seed, setup, request.world, [part]),
        f"{plural(len(part.roads), 'road')} of {card.roads:,}, seed {request.seed}",
    )
    return write(page, folder)


def _campaign_summary(part: StudyPartRecord, setup: Setup, world: World, found: Found) -> list[str]:
    own = setup.designer
    lines = [*_valid_lines(own, [part], is_thesis=False), *_left_lines(own, [part], is_thesis=False)]
    near, far = (_least(part.roads, outcome) for outcome in ("PASS", "FAIL"))
    lines += outside_sentences(passed_roads(part.roads), world)
    lines += near_and_far(near, far if setup.keep_driving else None)
    if any(road.kept for road in part.roads):
        lines.append(_kept_line([part]))
    return [*lines, _different_line(found)]


def _least(roads: Sequence[RoadRecord], outcome: str) -> tuple[float, str] | None:
    """Returns the least margin of the roads with an outcome, in metres, and the name of that road."""
    found = [
        (road.margin, road.index) for road in roads if road.outcome == outcome and road.margin is not None
    ]
    return (min(found)[0], f"road {min(found)[1]}") if found else None
