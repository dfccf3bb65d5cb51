"""Makes the sections that count roads by prompt: which are valid, and on which the car left its lane."""

import textwrap
from collections.abc import Callable, Sequence
from typing import NamedTuple

from roadgpt.report.page import Block, Details, Figure, Section, Table, TableCell, cell, linked
from roadgpt.report.page.forest import Share, forest
from roadgpt.study.baseline import NAME, ROADS, THESIS
from roadgpt.study.chapters.out_of_lane import outside_table, passed_roads
from roadgpt.study.chapters.significance import Count, Source, chi_squared_blocks
from roadgpt.study.chapters.wording import SHARE_HEADS, p_value, plural, share_cells, share_of
from roadgpt.study.road_record import RoadRecord, StudyPartRecord
from roadgpt.study.statistics import exact, wilson

MOST_NAMED = 100  # roads in a list
MOST_DRAWN = 12  # prompts in a figure; of more, all together
ALL = "all prompts"
LONGEST = 66  # letters of a prompt in a figure


class Kind(NamedTuple):
    """A set of rules by which roads are counted as valid."""

    slug: str
    name: str
    which: str
    """Name of the property of a RoadRecord."""


STRICT = Kind("strict", "strict rules", "is_valid")
SOUND = Kind("sound", "strict rules but for the words", "is_sound")
SBFT = Kind("sbft", "SBFT rules", "is_sbft")
KINDS = (STRICT, SOUND, SBFT)


def of_thesis(parts: Sequence[StudyPartRecord]) -> list[StudyPartRecord]:
    """Returns the parts whose prompts are in the thesis' table."""
    return [part for part in parts if part.part.prompt.prompt in THESIS]


def valid_source(designer: str, parts: Sequence[StudyPartRecord], kind: Kind) -> Source:
    """Counts the roads of a designer that are valid by one set of rules."""
    counts = tuple(
        Count(part.part.prompt.prompt, part.count(kind.which), len(part.roads), part.overview)
        for part in parts
        if part.part.designer == designer and part.roads
    )
    return Source(f"{designer}, {kind.name}", counts, f"{designer}-{kind.slug}")


def left_source(designer: str, parts: Sequence[StudyPartRecord]) -> Source:
    """Counts the drives on valid roads of a designer on which the car left its lane."""
    counts = tuple(
        Count(part.part.prompt.prompt, part.count("has_left"), part.count("is_driven"), part.overview)
        for part in parts
        if part.part.designer == designer and part.roads
    )
    return Source(designer, counts, designer)


def thesis_valid() -> Source:
    """Returns the counts of valid roads from the thesis' table 6.1."""
    counts = tuple(Count(prompt, counted.valid, ROADS) for prompt, counted in THESIS.items())
    return Source(f"{NAME}, its own checks", counts, "thesis")


def thesis_left() -> Source:
    """Returns the counts of lane departures on valid roads from the thesis."""
    counts = tuple(Count(prompt, counted.left, counted.valid) for prompt, counted in THESIS.items())
    return Source(NAME, counts, "thesis")


def validity(parts: Sequence[StudyPartRecord], designers: Sequence[str], has_baseline: bool) -> Section:
    """Returns the section on validity by every set of rules, beside the thesis' counts if asked for."""
    told = of_thesis(parts) if has_baseline else list(parts)
    every = [valid_source(designer, told, kind) for designer in designers for kind in KINDS]
    every = [source for source in every if source.counts] + ([thesis_valid()] if has_baseline else [])
    blocks: list[Block] = [
        "Strict rules: inside the map, no overlap, radius and slope within limits, and every requirement of "
        "the words kept. But for the words: the same without these requirements, which the thesis did not "
        "check. SBFT rules: what the validator of the SBFT tool competition says, quirks included."
    ]
    blocks += [_forest("validity", "valid", every), _shares("validity", "valid", every)]
    blocks += _silent(parts)
    if has_baseline:
        blocks += [_beside(source, every[-1]) for source in every if source.slug.endswith("-strict")]
    for source in every:
        if (source.slug.endswith("-strict") or source.slug == "thesis") and len(source.counts) > 1:
            blocks += chi_squared_blocks(source, "valid", "invalid", f"validity-{source.slug}")
    others = [s for s in every if s.slug.endswith(("-sound", "-sbft")) and len(s.counts) > 1]
    if others:
        inside: list[Block] = []
        for source in others:
            inside += chi_squared_blocks(source, "valid", "invalid", f"validity-{source.slug}")
        blocks.append(Details("The same by the other rules", inside))
    return Section(
        "Validity", [*blocks, *_named(parts, "Invalid roads", lambda road: not road.is_valid, _why)]
    )


def departures(parts: Sequence[StudyPartRecord], designers: Sequence[str], has_baseline: bool) -> Section:
    """Returns the section on lane departures on valid roads."""
    told = of_thesis(parts) if has_baseline else list(parts)
    every = [left_source(designer, told) for designer in designers]
    every = [source for source in every if source.total]
    blocks: list[Block] = []
    if not every:
        blocks.append("These roads were not driven.")
    every += [thesis_left()] if has_baseline else []
    if every:
        blocks += [
            "Drives on which the car left its lane, on roads that are valid by the strict rules"
            f"{' (in the thesis: by its own checks)' if has_baseline else ''}.",
            _forest("departures", "left", every),
            _shares("departures", "left", every),
        ]
    for source in every:
        if len(source.counts) > 1:
            blocks += chi_squared_blocks(source, "left", "kept", f"departures-{source.slug}")
    blocks += outside_table(passed_roads([road for part in parts for road in part.roads]))
    return Section("Leaving the lane", [*blocks, *_named(parts, "Drives that left", _has_left, _says)])


def _has_left(road: RoadRecord) -> bool:
    return road.has_left


def _says(road: RoadRecord) -> str:
    return road.says


def _why(road: RoadRecord) -> str:
    sbft = f"; SBFT: {road.sbft_says}" if road.sbft_says else ""
    return road.says + sbft


def _beside(source: Source, thesis: Source) -> str:
    """Compares our counts with the thesis', all prompts together."""
    table = [[each.hits, each.total - each.hits] for each in (source, thesis)]
    return (
        f"{source.name}: {share_of(source.hits, source.total)} against {share_of(thesis.hits, thesis.total)} "
        f"of {NAME}; Fisher's exact test {p_value(exact(table).p)}. The rules differ, and ours are stricter."
    )


def _forest(name: str, hit: str, every: Sequence[Source]) -> Figure:
    prompts = list(dict.fromkeys(count.prompt for source in every for count in source.counts))
    if len(prompts) > MOST_DRAWN:
        prompts = [ALL]
        every = [s._replace(counts=(Count(ALL, s.hits, s.total),)) for s in every]
    groups = []
    for prompt in prompts:
        rows = []
        for series, source in enumerate(every):
            for count in source.counts:
                if count.prompt == prompt and count.total:
                    rows.append(
                        Share(
                            series,
                            count.hits / count.total,
                            *wilson(count.hits, count.total),
                            f"{count.hits} of {count.total}",
                        )
                    )
        groups.append((_short(prompt), rows))
    caption = f"Share of roads {'that are valid' if hit == 'valid' else 'on which the car left its lane'}"
    caption += ", by prompt; dots are shares, lines Wilson's 95 % intervals."
    return Figure(name, caption, forest(groups, [source.name for source in every], caption))


def _short(prompt: str) -> str:
    return textwrap.shorten(prompt, LONGEST, placeholder=" …")


def _shares(name: str, hit: str, every: Sequence[Source]) -> Table:
    rows: list[list[TableCell]] = []
    for source in every:
        for count in source.counts:
            rows.append(
                [cell(count.prompt), cell(source.name), *share_cells(count.hits, count.total, count.href)]
            )
        if len(source.counts) > 1:
            rows.append([cell("all of these"), cell(source.name), *share_cells(source.hits, source.total)])
    return Table(
        f"{name}-shares", f"Shares: {hit}, with intervals", ["prompt", "made by", hit, *SHARE_HEADS], rows
    )


def _silent(parts: Sequence[StudyPartRecord]) -> list[Block]:
    """Lists designers that could not be run and roads that could not be made."""
    out: list[Block] = []
    for sentence in dict.fromkeys(f"{p.part.designer}: {p.problem}" for p in parts if p.problem):
        out.append(f"Roads are missing: {sentence}.")
    return out


def _named(
    parts: Sequence[StudyPartRecord],
    title: str,
    which: Callable[[RoadRecord], bool],
    says: Callable[[RoadRecord], str],
) -> list[Block]:
    """Lists roads with a property, each with a link; empty if there are none."""
    lines: list[Block] = []
    for part in parts:
        for road in part.roads:
            if which(road):
                where = linked(f"{part.part.name}, road {road.index}", part.href(road))
                lines.append([where, f": {says(road)}"])
    if not lines:
        return []
    more: list[Block] = [f"… and {len(lines) - MOST_NAMED} more."] if len(lines) > MOST_NAMED else []
    return [Details(f"{title} ({plural(len(lines), 'road')})", lines[:MOST_NAMED] + more)]
