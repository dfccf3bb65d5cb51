"""Makes the section on validity by each rule set, and tells how far outside its lane the car was in passed
tests."""

import textwrap
from collections.abc import Sequence
from typing import NamedTuple

from roadgpt.campaign.record import Record
from roadgpt.plural import plural
from roadgpt.report.chapters.roads import named_roads
from roadgpt.report.chapters.wording import (
    SHARE_HEADS,
    decimal,
    drawn_share,
    folded,
    row,
    share_cell,
    share_cells,
    share_of,
)
from roadgpt.report.page.charts import forest
from roadgpt.report.page.model import Block, Figure, Section, Table, TableCell
from roadgpt.report.road_record import RoadGroup, RoadRecord
from roadgpt.road import World
from roadgpt.verdict import SEVERITIES, Severity, percent
from roadgpt.verdict.verdict import MOSTLY, PARTLY


class Passed(NamedTuple):
    """The passed tests that have the same grade of ``verdict.severity``, such as "partly outside": their
    number, and the largest share and distance by which the car was outside its lane."""

    severity: Severity
    tests: int
    share: float  # largest fraction of the car's bounding box outside its lane, 0 to 1
    beyond: float  # largest distance of the car beyond the lane marking, metres


def passed_tests(records: Sequence[Record]) -> list[Passed]:
    """Groups the passed tests by how far outside its lane the car was."""
    graded = (
        "SELECT (max_oob > ?) + (max_oob > ?), count(*), max(max_oob), max(beyond) FROM tests "
        "WHERE outcome = 'PASS' AND max_oob IS NOT NULL GROUP BY 1"
    )
    rows = [row for record in records for row in record.query(graded, (PARTLY, MOSTLY))]
    return [
        Passed(
            name,
            sum(count for at, count, *_ in rows if at == grade),
            max((share for at, _, share, _ in rows if at == grade), default=0.0),
            max((beyond or 0.0 for at, *_, beyond in rows if at == grade), default=0.0),
        )
        for grade, name in enumerate(SEVERITIES)
    ]


def outside_sentences(found: Sequence[Passed], world: World) -> list[str]:
    """Returns a sentence for the summary on how far the car was outside its lane, if any test passed."""
    inside, partly, mostly = found
    every = sum(each.tests for each in found)
    if not every:
        return []
    if inside.tests == every and not inside.share:
        return [f"The car was never outside its lane on the {plural(every, 'road')} that it passed."]
    beyond = f", {max(each.beyond for each in found):.2f} m beyond the marking"
    tolerance = f"the tolerance of {percent(world.limits.oob_tolerance)}"
    within = "without a lane departure" if world.limits.lane_departure else f"within {tolerance}"
    most = f"{percent(max(each.share for each in found))} of the car{beyond}"
    return [
        f"Of {plural(every, 'road')} that the car passed, it was partly outside its lane on "
        f"{share_of(partly.tests, every)} and mostly outside on {share_of(mostly.tests, every)}, {within}: "
        f"at most {most}."
    ]


def outside_table(found: Sequence[Passed]) -> list[Table]:
    """Returns a table of how far outside its lane the car was in passed tests; empty if no test passed."""
    every = sum(each.tests for each in found)
    if not every:
        return []
    rows = [
        row(
            each.severity,
            each.tests,
            share_cell(each.tests / every),
            share_cell(each.share, percent(each.share)) if each.tests else None,
            decimal(each.beyond if each.tests else None),
        )
        for each in found
    ]
    heads = ["where the car was", "passed", "share", "outside at most", "beyond the marking, m"]
    note = "Partly: more than 10 % of the car was outside its lane, up to half; mostly: more than half."
    caption = "How far outside its lane the car was where it passed"
    return [Table("outside", caption, heads, rows, note)]


MOST_DRAWN = 12  # prompts in a figure; if there are more, they are shown as one
ALL = "all prompts"
LONGEST = 66  # letters of a prompt in a figure

Parts = Sequence[RoadGroup]


class Count(NamedTuple):
    """The number of roads of one prompt that have a property, such as being valid."""

    prompt: str
    hits: int  # number of roads with the property
    total: int  # number of all roads of the prompt, with and without the property
    href: str = ""  # address of the picture or table of these roads; empty for no link


class Source(NamedTuple):
    """The counts of one designer, or of the thesis, with one Count for each prompt."""

    name: str
    counts: tuple[Count, ...]
    slug: str  # name of the designer or of the thesis, as it is used in file names

    @property
    def hits(self) -> int:
        """Number of roads that have the property, summed over all prompts."""
        return sum(count.hits for count in self.counts)

    @property
    def total(self) -> int:
        """Number of all roads, summed over all prompts."""
        return sum(count.total for count in self.counts)

    @property
    def share(self) -> str:
        """The number of roads that have the property and their share, as text."""
        return share_of(self.hits, self.total)


class Kind(NamedTuple):
    """What is counted: a property of RoadRecord, such as "is_valid", and its name in files and in reports."""

    which: str
    slug: str = ""
    name: str = ""  # name of the rule set; empty for drives
    of: str = ""  # property of the roads that are counted in the total, such as "is_driven"; empty: all roads


STRICT = Kind("is_valid", "strict", "strict rules")
SOUND = Kind("is_sound", "sound", "strict rules but for the words")
SBFT = Kind("is_sbft", "sbft", "SBFT rules")
KINDS = (STRICT, SOUND, SBFT)
LEFT = Kind("has_left", of="is_driven")


def source_of(designer: str, parts: Parts, kind: Kind) -> Source:
    """Returns, for each prompt, how many roads of one designer have the property of a Kind."""
    counts = []
    for part in parts:
        if part.designer == designer and part.roads:
            total = part.count(kind.of) if kind.of else len(part.roads)
            counts.append(Count(part.words, part.count(kind.which), total, part.overview))
    name = ", ".join(filter(None, (designer, kind.name)))
    slug = "-".join(filter(None, (designer, kind.slug)))
    return Source(name, tuple(counts), slug)


def validity(parts: Parts, every: Sequence[Source], compared: Sequence[Block] = ()) -> Section:
    """Returns the section on validity by each rule set: the shares of the sources, why roads are missing, the
    blocks that compare them, and a list of invalid roads."""
    blocks: list[Block] = [
        "Strict rules: inside the map, no overlap, radius and slope within limits, and every requirement of "
        "the words kept. But for the words: the same without these requirements, which the thesis did not "
        "check. SBFT rules: what the validator of the SBFT tool competition says, quirks included."
    ]
    blocks += [shares_forest("validity", "that are valid", every), shares_table("validity", "valid", every)]
    missing = dict.fromkeys(f"{part.designer}: {part.problem}" for part in parts if part.problem)
    blocks += [f"Roads are missing: {sentence}." for sentence in missing]
    return Section("Validity", [*blocks, *compared, *folded("Invalid roads", named_roads(parts, _why))])


def _why(road: RoadRecord) -> str:
    sbft = f"; SBFT: {road.sbft_says}" if road.sbft_says else ""
    return "" if road.is_valid else road.result.description + sbft


def shares_forest(name: str, which: str, every: Sequence[Source]) -> Figure:
    """Returns the shares of roads ``which`` are counted, such as "that are valid", by prompt."""
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
    caption = f"Share of roads {which}; dots are shares, lines Wilson's 95 % intervals."
    return Figure(name, caption, forest(groups, [source.name for source in every], caption))


def shares_table(name: str, hit: str, every: Sequence[Source]) -> Table:
    """Returns the counts of the sources by prompt, with intervals."""
    rows: list[list[TableCell]] = []
    for source in every:
        for count in source.counts:
            rows.append(row(count.prompt, source.name, *share_cells(count.hits, count.total, count.href)))
        if len(source.counts) > 1:
            rows.append(row("all of these", source.name, *share_cells(source.hits, source.total)))
    heads = ["prompt", "made by", hit, *SHARE_HEADS]
    return Table(f"{name}-shares", f"Shares: {hit}, with intervals", heads, rows)
