"""Writes the report of a campaign, a folder of runs or a single run."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from roadgpt.campaign.folder_record import is_store, open_record
from roadgpt.campaign.model import NumberedTest, no_failure
from roadgpt.campaign.record import Record
from roadgpt.campaign.status import Status, status_of
from roadgpt.errors import UsageError
from roadgpt.plural import plural
from roadgpt.report.chapters import with_chapters
from roadgpt.report.chapters.alignment import alignment
from roadgpt.report.chapters.diversity import diversity
from roadgpt.report.chapters.outcomes import driven, failures, outcomes
from roadgpt.report.chapters.roads import coverage, every_road, overview
from roadgpt.report.chapters.same_roads import same_roads
from roadgpt.report.chapters.score import score
from roadgpt.report.chapters.validity import (
    KINDS,
    SBFT,
    STRICT,
    outside_sentences,
    passed_tests,
    source_of,
    validity,
)
from roadgpt.report.chapters.wording import driver_names, percent, share_of
from roadgpt.report.page import write
from roadgpt.report.page.model import Page, Section, Table
from roadgpt.report.road_record import MOST_COMPARED, RoadGroup, group_of
from roadgpt.road import World
from roadgpt.road.world import oracle_in_words
from roadgpt.run import Request
from roadgpt.run.versions import Versions

MOST_READ = 500  # tests of all cells whose roads are measured
MOST_GROUPS = 12  # cells whose roads are measured
SEEDS = 20  # that are named
UNITS = {
    "speed_limit": (3.6, " km/h"),
    "max_grade": (100.0, " %"),
    "bank": (100.0, " %"),
    "friction": (1.0, ""),
    "oob_tolerance": (1.0, ""),
}
"""Factor and unit with which a field of the World is shown; fields that are not listed are in metres."""


def write_report(folder: Path, command: str = "") -> Path:
    """Writes the report of a folder's tests into the folder, and returns the path of the HTML page. It shows
    ``command``, which repeats the tests."""
    status = refuse_empty(status_of(folder), command)
    with open_record(folder) as record:
        page = _page(record, status, command)
    return write(page, folder)


def refuse_empty(status: Status, command: str) -> Status:
    """Returns the status; raises UsageError if no test has ended, with the command that makes some."""
    if not status.done:
        raise UsageError(f"{status.folder} holds no finished test yet; say first: {command}")
    return status


def _page(record: Record, status: Status, command: str) -> Page:
    cells = record.cells()
    first, is_paired = cells[0].request, is_store(record.folder) and record.plan().paired
    drives_on = first.setup.keep_driving  # whether cars drive on after they have left their lane
    groups = groups_of(record, status, is_paired)
    designers = [*dict.fromkeys(group.designer for group in groups)]
    sources = [source_of(name, groups, kind) for kind in KINDS for name in designers]
    sources = [source for source in sources if source.total]
    said = [group for group in groups if any(road.kept for road in group.roads)]
    sections = [
        *([overview(groups)] if any(len(group.roads) > 1 for group in groups) else []),
        outcomes(record, status, is_paired),
        *failures(record, status, drives_on),
        *([validity(groups, sources)] if sources else []),
        *([alignment(said, [*dict.fromkeys(group.designer for group in said)])] if said else []),
        *comparisons_of(groups, [record]),
    ]
    summary = summary_of(record, status, groups)
    if (measured := sum(len(group.roads) for group in groups)) < status.done:
        whose = " of the first driver" * is_paired
        summary.append(f"Roads are measured and shown of the first {plural(measured, 'test')}{whose}.")
    sections, summary = with_chapters(record, sections, summary)
    if is_paired:
        chapter = same_roads(record)
        sections, summary = [chapter.section, *sections], [*chapter.sentences, *summary]
    if scores := score(record):
        sections = [scores, *sections]
    title, lead = titles(status, first)
    return Page(title, summary, sections, card_of_tests(command, record, status, groups), lead)


def comparisons_of(
    parts: Sequence[RoadGroup], records: Sequence[Record], between: Sequence[Table] = ()
) -> list[Section]:
    """Returns the sections in which roads are compared and shown, as far as there are some. The tables
    ``between`` compare roads of different descriptions."""
    features = coverage(records)
    return [
        *([diversity(parts, between)] if any(len(part.compared) > 1 for part in parts) else []),
        *([features] if features else []),
        *([every_road(parts)] if any(part.roads for part in parts) else []),
    ]


def titles(status: Status, first: Request) -> tuple[str, str]:
    """Returns the title of a report, and the line under it."""
    words, cells = list(dict.fromkeys(each.about for each in status.cells)), len(status.cells)
    title = words[0] if len(words) == 1 else f"A campaign of {plural(cells, 'cell')}"
    of = "" if status.total in (None, status.done) else f"{status.done:,} of "
    where = f" in {plural(cells, 'cell')}" if cells > 1 else f", seed {first.seed}"
    tests = plural((of and status.total) or status.done, "test")
    return title, of + tests + where + ("" if status.is_finished else "; unfinished")


def groups_of(record: Record, status: Status, is_paired: bool = False) -> list[RoadGroup]:
    """Returns the roads of the first tests of the first cells, those of one driver if all have
    the same roads."""
    cells = record.cells()
    if is_paired:
        cells = [each for each in cells if each.request.setup.driver == cells[0].request.setup.driver]
    several, cells = len(cells) > 1, cells[:MOST_GROUPS]
    abouts = {each.name: each.about for each in status.cells}
    return [
        group_of(
            record, each, f"{each.name}: {abouts[each.name]}" if several else abouts[each.name],
            most=MOST_READ // len(cells), id=each.name, name=each.name if several else "",
            compared=round(MOST_COMPARED / len(cells) ** 0.5),
        )
        for each in cells
    ]  # fmt: skip


def summary_of(record: Record, status: Status, groups: Sequence[RoadGroup] = ()) -> list[str]:
    """Returns sentences on the outcomes of tests, and on their roads as far as these are known."""
    counts, (failed, of) = status.outcomes, driven(status)
    out = no_failure(counts) or (["No road failed."] if of and not failed else [])
    told = ", ".join(f"{number:,} {outcome}" for outcome, number in sorted(counts.items()))
    out.append(f"{plural(status.done, 'test')}: {told}.")
    if apart := counts.get("UNAVOIDABLE", 0):
        out.append(f"{plural(apart, 'collision')} no careful driver could have avoided: counted apart.")
    if untested := counts.get("NOT TESTED", 0):
        out.append(
            f"{plural(untested, 'test')} NOT TESTED: the driver was not as fast as the scene prescribes."
        )
    first = record.cells()[0].request
    if of:
        out.append(f"The car failed on {share_of(failed, of)} of the roads that were driven.")
        if other := sum(each.handed_over for each in status.cells):
            out.append(f"On {other:,} of them the driver had handed over: they are not its failures.")
        shares = {each.name: failed / of for each in status.cells for failed, of in [driven(each)] if of}
        if failed and len(shares) > 1:
            most = max(shares, key=lambda name: shares[name])
            out.append(f"Most fail in {most}: {percent(shares[most])} of its driven roads.")
        out += outside_sentences(passed_tests([record]), first.world)
        for test, by in _least(record, "PASS"):
            out.append(f"Of the drives that kept their lane, {test} came nearest to failing: {by}.")
        for test, by in _least(record, "FAIL") if first.setup.keep_driving else ():
            out.append(f"Farthest out went {test}: {by} beyond what is allowed.")
    for name in dict.fromkeys(group.designer for group in groups):
        own = [group for group in groups if group.designer == name]
        out += [*valid_sentence(name, own), *kept_and_alike(own)]
    out += [sentence for each in status.cells if (sentence := each.remark)]
    if is_store(record.folder):
        out += [f"Left out: {each}." for each in record.plan().left_out.values()]
    wrong = counts.get("INVALID", 0) + counts.get("ERROR", 0)
    out.append(f"Of all tests {share_of(wrong, status.done)} were invalid or ended in an error.")
    if status.seconds:
        out.append(f"It took {status.seconds:,.0f} s, {status.done / status.seconds:.1f} tests a second.")
    return out


def _least(record: Record, outcome: str) -> Iterator[tuple[str, str]]:
    """Yields the test with this outcome that has the smallest margin, if any, and how far that is from 0."""
    found = record.query(
        "SELECT cell, number, abs(margin) FROM tests WHERE outcome = ? AND margin IS NOT NULL "
        "AND (outcome != 'FAIL' OR margin < 0) ORDER BY margin, cell, number LIMIT 1",
        (outcome,),
    )
    for *name, metres in found:
        yield f"test {NumberedTest(*name)}", f"{metres:.2f} m" if metres >= 0.01 else "less than 1 cm"


def valid_sentence(designer: str, parts: Sequence[RoadGroup], beside: str = "") -> list[str]:
    """Returns a sentence on the valid roads of one designer, which ``beside`` ends."""
    strict, sbft = (source_of(designer, parts, kind) for kind in (STRICT, SBFT))
    return [
        f"{strict.share} roads are valid by strict rules, words included, "
        f"and {sbft.share} by the SBFT competition's{beside}."
    ] * bool(strict.total)


def kept_and_alike(parts: Sequence[RoadGroup]) -> list[str]:
    """Returns sentences on how many roads keep the words, and how alike the roads of one description are."""
    lines = list[str]()
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


def card_of_tests(
    command: str, record: Record, status: Status, groups: Sequence[RoadGroup] = ()
) -> dict[str, str]:
    """Returns how the report of a Record can be reproduced; see ``card_of``."""
    requests, drivers = (
        [each.request for each in record.cells()],
        {each.driver: None for each in status.cells},
    )
    spent = f"{status.tokens:,} tokens, {status.cost_usd:.4f} USD" if status.tokens else ""
    return card_of(command, requests, map(record.versions, drivers), groups, f"{status.done:,}", spent)


def card_of(
    command: str, requests: Sequence[Request], versions: Iterable[Versions], groups: Sequence[RoadGroup],
    tests: str, spent: str = "",
) -> dict[str, str]:  # fmt: skip
    """Returns how a report can be reproduced, as labels with texts in the order of the page."""
    setups = [*dict.fromkeys(each.setup for each in requests)]
    drives, seeds = [each for each in setups if each.drives], sorted({each.seed for each in requests})
    names = driver_names({each.driver: None for each in drives})
    values: dict[str, Iterable[str]] = {
        "command": [command],
        "tests": [tests],
        "seed" if len(seeds) == 1 else "seeds": [
            ", ".join(map(str, seeds[:SEEDS])) + " …" * (len(seeds) > SEEDS)
        ],
        "made by": [each.designer for each in setups],
        "reader": [each.reader for each in setups],
        "driven by": [f"{names[each.driver]} in {each.simulator}" for each in drives],
        "oracle": [oracle_in_words(each.world.limits.oracle) for each in requests if each.setup.drives],
        "language model": [*(each.chat.model for each in setups if each.chat and each.chat.model), spent],
        "world": [_worlds([each.world for each in requests])],
    }
    own = {f"{each.world.site.friction:g}" for each in requests}
    surfaces = {f"{road.world.site.friction:g}" for part in groups for road in part.roads if road.world}
    if surfaces - own:
        values["friction of the roads"] = [f"{' and '.join(sorted(surfaces))}, by what the words say"]
    found: dict[str, dict[str, None]] = {}
    for name, number in (each for its in versions for each in its.items()):
        found.setdefault(name, {})[number] = None
    values["versions"] = [", ".join(f"{name} {' and '.join(numbers)}" for name, numbers in found.items())]
    told = {name: ", ".join(filter(None, dict.fromkeys(its))) for name, its in values.items()}
    return {name: text for name, text in told.items() if text}


def _worlds(worlds: Sequence[World]) -> str:
    first, *others = [each.model_dump() for each in worlds]
    said = []
    for name, value in first.items():
        factor, unit = UNITS.get(name, (1.0, " m"))
        shown = value if isinstance(value, str) else f"{value * factor:.4g}{unit}"
        if isinstance(value, bool):
            shown = "counted" if value else "not counted"
        is_same = all(other.get(name) == value for other in others)
        said.append(f"{name.replace('_', ' ')} {shown if is_same else 'of each cell'}")
    return ", ".join(said)
