"""Makes the sections of a report with the numbers of valid roads, and of roads on which the car left its
lane, for each prompt.
"""

import textwrap
from collections.abc import Callable, Sequence
from typing import NamedTuple

from roadgpt.report.page import Block, Details, Figure, Section, Table, TableCell, linked
from roadgpt.report.page.forest import forest
from roadgpt.study.baseline import NAME, ROADS, THESIS
from roadgpt.study.chapters.out_of_lane import outside_table, passed_roads
from roadgpt.study.chapters.significance import Count, Source, chi_squared_blocks
from roadgpt.study.chapters.wording import (
    SHARE_HEADS,
    drawn_share,
    folded,
    p_value,
    row,
    share_cells,
    share_of,
)
from roadgpt.study.road_record import RoadRecord, StudyPartRecord
from roadgpt.study.statistics import exact

MOST_DRAWN = 12  # prompts in a figure; if there are more, they are shown as one
ALL = "all prompts"
LONGEST = 66  # letters of a prompt in a figure

Parts = Sequence[StudyPartRecord]


class Kind(NamedTuple):
    """A rule set for valid roads: its name in files, its name in reports, and the RoadRecord property that is
    True for valid roads."""

    slug: str
    name: str
    which: str
    """Name of the RoadRecord property, such as "is_valid"."""


STRICT = Kind("strict", "strict rules", "is_valid")
SOUND = Kind("sound", "strict rules but for the words", "is_sound")
SBFT = Kind("sbft", "SBFT rules", "is_sbft")
KINDS = (STRICT, SOUND, SBFT)


def of_thesis(parts: Parts) -> list[StudyPartRecord]:
    """Returns the study parts with prompts for which the thesis gives results (``baseline.THESIS``)."""
    return [part for part in parts if part.words in THESIS]


def _source(parts: Parts, designer: str, which: str, of: str, name: str, slug: str) -> Source:
    """Counts, for each prompt, a designer's roads with the property ``which``, and in total those with the
    property ``of`` (all roads if ``of`` is empty)."""
    counts = (
        Count(part.words, part.count(which), part.count(of) if of else len(part.roads), part.overview)
        for part in parts
        if part.designer == designer and part.roads
    )
    return Source(name, tuple(counts), slug)


def valid_source(designer: str, parts: Parts, kind: Kind) -> Source:
    """Returns, for each prompt, how many roads of one designer are valid by one rule set."""
    return _source(parts, designer, kind.which, "", f"{designer}, {kind.name}", f"{designer}-{kind.slug}")


def left_source(designer: str, parts: Parts) -> Source:
    """Returns, for each prompt, on how many driven roads of one designer the car left its lane."""
    return _source(parts, designer, "has_left", "is_driven", designer, designer)


THESIS_VALID = Source(
    f"{NAME}, its own checks",
    tuple(Count(prompt, own.valid, ROADS) for prompt, own in THESIS.items()),
    "thesis",
)
"""The counts of valid roads from the thesis' table 6.1."""
THESIS_LEFT = Source(
    NAME, tuple(Count(prompt, own.left, own.valid) for prompt, own in THESIS.items()), "thesis"
)
"""The counts of valid roads on which the car left its lane, from the thesis."""


def validity(parts: Parts, designers: Sequence[str], has_baseline: bool = False) -> Section:
    """Returns the section on validity by each rule set.

    If ``has_baseline`` is True, only prompts of the thesis are counted, and the thesis' numbers are added.
    """
    told = of_thesis(parts) if has_baseline else list(parts)
    every = [valid_source(designer, told, kind) for designer in designers for kind in KINDS]
    every = [source for source in every if source.counts] + ([THESIS_VALID] if has_baseline else [])
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
    return Section("Validity", [*blocks, *folded("Invalid roads", _named(parts, _why))])


def departures(parts: Parts, designers: Sequence[str], has_baseline: bool = False) -> Section:
    """Returns the section on lane departures on valid roads; ``has_baseline`` is as in ``validity``."""
    told = of_thesis(parts) if has_baseline else list(parts)
    every = [left_source(designer, told) for designer in designers]
    every = [source for source in every if source.total]
    blocks: list[Block] = []
    if not every:
        blocks.append("These roads were not driven.")
    every += [THESIS_LEFT] if has_baseline else []
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
    left = _named(parts, lambda road: road.says if road.has_left else "")
    return Section("Leaving the lane", [*blocks, *folded("Drives that left", left)])


def _why(road: RoadRecord) -> str:
    """Returns why a road is invalid; empty if it is valid."""
    sbft = f"; SBFT: {road.sbft_says}" if road.sbft_says else ""
    return "" if road.is_valid else road.says + sbft


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
    groups = [
        (
            textwrap.shorten(prompt, LONGEST, placeholder=" …"),
            [
                drawn_share(series, count.hits, count.total)
                for series, source in enumerate(every)
                for count in source.counts
                if count.prompt == prompt and count.total
            ],
        )
        for prompt in prompts
    ]
    caption = f"Share of roads {'that are valid' if hit == 'valid' else 'on which the car left its lane'}"
    caption += ", by prompt; dots are shares, lines Wilson's 95 % intervals."
    return Figure(name, caption, forest(groups, [source.name for source in every], caption))


def _shares(name: str, hit: str, every: Sequence[Source]) -> Table:
    rows: list[list[TableCell]] = []
    for source in every:
        for count in source.counts:
            rows.append(row(count.prompt, source.name, *share_cells(count.hits, count.total, count.href)))
        if len(source.counts) > 1:
            rows.append(row("all of these", source.name, *share_cells(source.hits, source.total)))
    heads = ["prompt", "made by", hit, *SHARE_HEADS]
    return Table(f"{name}-shares", f"Shares: {hit}, with intervals", heads, rows)


def _silent(parts: Parts) -> list[Block]:
    """Lists designers that could not be run and roads that could not be made."""
    sentences = dict.fromkeys(f"{part.designer}: {part.problem}" for part in parts if part.problem)
    return [f"Roads are missing: {sentence}." for sentence in sentences]


def _named(parts: Parts, says: Callable[[RoadRecord], str]) -> list[Block]:
    """Returns a line with a link for each road for which ``says`` returns a sentence."""
    return [
        [linked(f"{part.part.name}, road {road.index}", part.href(road)), f": {sentence}"]
        for part in parts
        for road in part.roads
        if (sentence := says(road))
    ]
