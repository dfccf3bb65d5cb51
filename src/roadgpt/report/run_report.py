"""Writes the report of a folder of runs, from the files in it."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.status import no_failure
from roadgpt.errors import UsageError
from roadgpt.plural import plural
from roadgpt.report.chapters import with_chapters
from roadgpt.report.chapters.alignment import alignment
from roadgpt.report.chapters.roads import coverage, every_road, overview
from roadgpt.report.chapters.validity import (
    KINDS,
    LEFT,
    SBFT,
    STRICT,
    departures,
    outside_sentences,
    passed_roads,
    source_of,
    validity,
)
from roadgpt.report.chapters.wording import decimal, near_and_far, percent, row, share_of
from roadgpt.report.page import write
from roadgpt.report.page.charts import AxisRange, heat, is_map
from roadgpt.report.page.model import Block, Details, Figure, Page, Section, Table, cell, linked
from roadgpt.report.road_record import RoadGroup, RoadRecord, read_group
from roadgpt.road import World
from roadgpt.road.world import oracle_in_words
from roadgpt.run import Setup
from roadgpt.run.folder import read_card

UNITS = {
    "speed_limit": (3.6, " km/h"),
    "max_grade": (100.0, " %"),
    "bank": (100.0, " %"),
    "friction": (1.0, ""),
    "oob_tolerance": (1.0, ""),
}
"""Factor and unit with which a field of the World is shown; fields that are not listed are in metres."""


def write_run_report(folder: Path, command: str = "") -> Path:
    """Writes the report of runs made by ``roadgpt run`` into their folder; returns the path of the HTML page.
    It shows ``command``, which repeats the runs."""
    card = read_card(folder)
    request, setup = card.request, card.request.setup
    words, world = request.words or "roads that were given", request.world
    part = read_group(folder, setup.designer, words)
    if not part.roads:
        raise UsageError(f"{folder} holds no finished road yet; say first: {command}")
    parts = [part]
    kinds = [source_of(setup.designer, parts, kind) for kind in KINDS]
    sections = [validity(parts, kinds)]
    if setup.drives:
        left = source_of(setup.designer, parts, LEFT)
        sections += [departures(parts, [left] if left.total else [])]
    sections += [alignment(parts, [setup.designer])] if request.words else []
    sections += comparisons_of(parts, world)
    outcomes = Counter(road.outcome for road in part.roads)
    far = _least(part.roads, "FAIL") if setup.keep_driving else None
    sentences = sentences_of(parts, world, near_and_far(_least(part.roads, "PASS"), far))
    sections += numbers(part.roads)
    with open_record(folder) as record:
        sections, sentences = with_chapters(record, sections, [*no_failure(outcomes), *sentences])
    sections[:0] = filter(None, [overview(parts, world.site.map_size)])
    page = Page(
        words,
        sentences,
        sections,
        card_of(command, card.roads, request.seed, setup, world, parts),
        f"{plural(len(part.roads), 'road')} of {card.roads:,}, seed {request.seed}",
    )
    return write(page, folder)


def _least(roads: Sequence[RoadRecord], outcome: str) -> tuple[float, str] | None:
    found = [(road.verdict.margin, road.index) for road in roads if road.outcome == outcome and road.verdict]
    return (min(found)[0], f"road {min(found)[1]}") if found else None


def card_of(
    command: str, roads: int, seed: int, setup: Setup, world: World, parts: Sequence[RoadGroup]
) -> dict[str, str]:
    """Returns how a report can be reproduced, as labels with texts in the order of the page."""
    out = {"command": command} if command else {}
    out |= {
        "seed": str(seed),
        "roads of each": f"{roads:,}",
        "made by": ", ".join(dict.fromkeys(part.designer for part in parts)),
        "reader": setup.reader,
    }
    if setup.drives:
        out["driven by"] = f"{setup.driver} in {setup.simulator}"
        out["oracle"] = oracle_in_words(world.limits.oracle)
    if setup.chat is not None and setup.chat.model:
        out["language model"] = setup.chat.model
    out["world"] = ", ".join(_said(name, value) for name, value in world.model_dump().items())
    surfaces = {f"{road.friction:g}" for part in parts for road in part.roads if road.friction is not None}
    if surfaces - {f"{world.site.friction:g}"}:
        out["friction of the roads"] = f"{' and '.join(sorted(surfaces))}, by what the words say"
    found: dict[str, dict[str, None]] = {}
    for name, number in (each for part in parts for road in part.roads for each in road.versions.items()):
        found.setdefault(name, {})[number] = None
    versions = ", ".join(f"{name} {' and '.join(numbers)}" for name, numbers in found.items())
    return out | {"versions": versions or "–"}


def _said(name: str, value: float | str) -> str:
    factor, unit = UNITS.get(name, (1.0, " m"))
    shown = value if isinstance(value, str) else f"{value * factor:.4g}{unit}"
    if isinstance(value, bool):
        shown = "counted" if value else "not counted"
    return f"{name.replace('_', ' ')} {shown}"


def sentences_of(
    parts: Sequence[RoadGroup],
    world: World,
    near: Sequence[str] = (),
    counted: Sequence[RoadGroup] | None = None,
    beside: tuple[str, str] = ("", ""),
) -> list[str]:
    """Returns sentences on the roads of one designer, among them the given ones on the drives that came
    ``near`` to failing. If ``counted`` are given, only of them the valid roads and the lane departures are
    told, each with its text of ``beside``."""
    designer = parts[0].designer
    strict, sbft, left = (
        source_of(designer, parts if counted is None else counted, kind) for kind in (STRICT, SBFT, LEFT)
    )
    lines = list[str]()
    if strict.total:
        lines.append(
            f"{strict.share} roads are valid by strict rules, words included, "
            f"and {sbft.share} by the SBFT competition's{beside[0]}."
        )
    if left.total:
        lines.append(f"The car left its lane on {left.share} driven roads{beside[1]}.")
    lines += [*outside_sentences(passed_roads([road for part in parts for road in part.roads]), world), *near]
    good, turns = ([kept for part in parts for kept in part.kept(name)] for name in ("general", "turns"))
    if good:
        right = f"; the number of turns is right on {percent(sum(turns) / len(turns))}" if turns else ""
        lines.append(f"{share_of(sum(good), len(good))} roads keep every word{right}.")
    nearest = [float(part.spread.nearest.min()) for part in parts if len(part.compared) > 1]
    twins = sum(len(part.spread.duplicates) for part in parts)
    if not nearest:
        return [*lines, "There is one road of each description, so there is nothing to compare."]
    said = "No near duplicates" if not twins else plural(twins, "pair") + " of near duplicates"
    said += f" among roads of one description; the nearest two plans are {min(nearest):.1f} m "
    return [*lines, said + "apart (root mean square, however shifted, turned or mirrored)."]


def comparisons_of(parts: Sequence[RoadGroup], world: World, between: Sequence[Table] = ()) -> list[Section]:
    """Returns the sections in which roads of one description are compared, and that with every road. The
    tables ``between`` compare roads of different descriptions."""
    covered = coverage(parts)
    return [
        diversity(parts, between),
        *([covered] if covered else []),
        every_road(parts, world.site.map_size),
    ]


def numbers(roads: Sequence[RoadRecord]) -> list[Section]:
    """Returns the section on the numbers of tests that plug-ins ``columns`` tell, if there are any."""
    told = [{its.key: its.value for its in road.numbers} for road in roads[:MOST_NAMED]]
    keys = [*dict.fromkeys(key for own in told for key in own)]
    rows = [
        row(road.index, road.outcome, *(decimal(own.get(key)) for key in keys))
        for road, own in zip(roads, told, strict=False)
    ]
    table = Table("numbers", f"The first {plural(len(rows), 'road')}", ["road", "outcome", *keys], rows)
    return [Section("Numbers of the tests", [table])] if keys else []


MOST_NAMED = 50
MOST_DRAWN = 30  # parts whose distances are drawn


def diversity(parts: Sequence[RoadGroup], between: Sequence[Table] = ()) -> Section:
    """Returns the section on diversity: how much the roads of one description differ, which of them are
    near duplicates, and the tables ``between`` descriptions."""
    blocks: list[Block] = [
        "Two plans are superimposed by the best shift, turn and mirroring and compared at equal "
        "shares of their lengths. Their distance is the root mean square in metres. Near duplicates are "
        "pairs less than 5.5 m and 2 percentage points of grade apart with the same number of turns. "
        "Similarity, from 0 to 1, is the mean of number, sequence and direction of turns, length, incline "
        "and shape."
    ]
    blocks += [table for table in (_within(parts), *between) if table.rows]
    twins: list[Block] = [
        [
            f"{part.name}: roads ",
            linked(str(part.compared[i].index), part.href(part.compared[i])),
            " and ",
            linked(str(part.compared[j].index), part.href(part.compared[j])),
            f", {part.spread.metres[i, j]:.1f} m apart",
        ]
        for part in parts
        for i, j in part.spread.duplicates
    ]
    if twins:
        blocks.append(Details(f"Near duplicates ({plural(len(twins), 'pair')})", twins[:MOST_NAMED]))
    else:
        blocks.append("There are no near duplicates.")
    shown: list[Block] = [picture for part in parts[:MOST_DRAWN] if (picture := _matrix(part)) is not None]
    blocks += shown[:1]
    if shown[1:]:
        blocks.append(Details(f"Distances of the other prompts ({len(shown) - 1})", shown[1:]))
    return Section("Diversity", blocks)


def _within(parts: Sequence[RoadGroup]) -> Table:
    rows = []
    for part in parts:
        roads, own = part.compared, part.spread
        if len(roads) < 2:
            continue
        nearest = own.nearest
        i = int(np.argmin(nearest))
        j = int(np.nanargmin(own.metres[i]))
        rows.append(
            row(
                cell(part.words, href=part.overview),
                part.designer,
                len(roads),
                decimal(float(nearest.min()), 1, part.href(roads[i])),
                cell(f"{roads[i].index} and {roads[j].index}", href=part.href(roads[j])),
                decimal(float(np.median(nearest)), 1),
                len(own.duplicates),
                decimal(own.general),
                decimal(own.sparseness, 1),
            )
        )
    heads = [
        "prompt", "made by", "roads", "nearest pair, m", "which", "nearest, median, m", "near duplicates",
        "mean similarity", "sparseness",
    ]  # fmt: skip
    note = (
        "Sparseness is the SBFT competition's weighted Levenshtein distance to the road that differs most, "
        "computed for whole roads in steps of 5 m; theirs is for 60 m around failures, in steps of 1 m."
    )
    return Table("diversity", "Roads of the same description", heads, rows, note)


def _matrix(part: RoadGroup) -> Figure | None:
    n = len(part.compared)
    lower = np.where(np.tri(n, k=-1, dtype=bool), part.spread.metres, np.nan)
    if n < 3 or not is_map(lower):
        return None
    axis = AxisRange("road", 0.5, n + 0.5, is_count=True)
    caption = (
        f"{part.designer}, “{part.words}”: distance between every two roads, metres; "
        "the fainter, the more similar."
    )
    return Figure(f"distances-{part.number}", caption, heat(lower, axis, axis, "metres", caption, True))
