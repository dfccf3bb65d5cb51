"""Writes one page about tests, to print (A4): what was tested, the outcomes, and the worst test."""

from pathlib import Path

from roadgpt.campaign.columns import told_of
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.record import Record
from roadgpt.campaign.status import Status, status_of
from roadgpt.errors import command_line
from roadgpt.report.birds_eye import birds_eye
from roadgpt.report.canvas import encoded, in_our_style
from roadgpt.report.chapters.wording import driver_names, row
from roadgpt.report.page import BRIEF, html_of
from roadgpt.report.page.maps import embedded_png
from roadgpt.report.page.model import Block, Figure, Page, Section, ShellCommand, Table
from roadgpt.report.report import card_of_tests, refuse_empty, summary_of, titles
from roadgpt.report.road_record import named
from roadgpt.run.atomic import write_whole
from roadgpt.run.folder import is_run
from roadgpt.run.model import permissions

CELLS, SENTENCES = 6, 5  # that fit
LONG, SHORT = 240, 24  # letters of a text that fit: of a paragraph, and of a cell of the table
LONGEST = {"command": 400, "versions": 400}  # letters of what stands in small print
TOLD = 6  # numbers of a test


def write_brief(folder: Path, command: str = "") -> Path:
    """Writes the page into the folder of the tests, and returns its path. It shows ``command``, which repeats
    the tests."""
    status = refuse_empty(status_of(folder), command)
    with open_record(folder) as record:
        title, lead = titles(status, record.cells()[0].request)
        summary = [_cut(each) for each in summary_of(record, status)[:SENTENCES]]
        sections = [_counts(status), _worst(record)]
        card = card_of_tests(command, record, status)
    card = {name: _cut(text, LONGEST.get(name, LONG)) for name, text in card.items() if name != "tests"}
    page = Page(_cut(title, LONG // 2), summary, sections, card, lead)
    write_whole(folder / BRIEF, html_of(page, is_brief=True))
    return folder / BRIEF


def _cut(text: str, letters: int = LONG) -> str:
    return text if len(text) <= letters else f"{text[: letters - 2].rstrip()} …"


def _counts(status: Status) -> Section:
    kinds, cells = sorted(status.outcomes), status.cells
    names = driver_names(each.driver for each in cells)
    words = ["description"] * (len({each.about for each in cells}) > 1)
    rows = [
        row(
            each.name or "all", *(_cut(each.about, SHORT) for _ in words), _cut(names[each.driver], SHORT),
            each.oracle, each.done, *(each.outcomes.get(kind, 0) for kind in kinds),
        )
        for each in cells[:CELLS]
    ]  # fmt: skip
    if has_total := len(cells) > 1:
        blank = ("" for _ in (*words, "driver", "oracle"))
        rows.append(row("all", *blank, status.done, *(status.outcomes[kind] for kind in kinds)))
    note = f"The first {CELLS} of {len(cells)} cells." if len(cells) > CELLS else ""
    heads = ["cell", *words, "driver", "oracle", "tests", *kinds]
    return Section("What was tested", [Table("counts", "", heads, rows, note, has_total)])


@in_our_style
def _worst(record: Record) -> Section:
    """Returns the section on the test that failed by most or, if none did, came nearest to it."""
    worst = record.tests(which="worst")
    if not worst:
        return Section("The worst case", ["No test was driven."])
    run, its = record.run(*worst[0]), record.result(*worst[0])
    figure = birds_eye(run)
    place = run.verdict and run.verdict.at_xy
    at = "" if its.at_s is None else f", at {its.at_s:.0f} m along the road"
    at += f" (x = {place[0]:.1f} m, y = {place[1]:.1f} m)" if place else ""
    cause = f"Cause: {its.cause}{f', {its.side}' if its.side else ''}{at}." if its.cause else ""
    has_margin = its.margin is not None and its.cause != "collision"
    has_margin &= its.outcome == "PASS" or run.request.setup.keep_driving  # else the drive ended at the edge
    margin = f"Margin: {its.margin:.2f} m." if has_margin else ""
    told_numbers = told_of(its.features)[:TOLD]
    numbers = ", ".join(each.text or f"{each.key} {each.value:.4g}" for each in told_numbers)
    test = named(record.folder, worst[0])
    drive = command_line("drive", "--again", test, *permissions([run.request.setup], replays=True))
    scenario = record.cell(worst[0].cell).scenario_of(its.proposal.origin)
    told = f"Test {worst[0]}{f' ({scenario})' * bool(scenario)}, {its.outcome}: {its.description}."
    said = " ".join(filter(None, (told, cause, margin, numbers and f"{numbers[:1].upper()}{numbers[1:]}.")))
    wide, high = figure.get_size_inches().tolist()
    picture = embedded_png(encoded(figure, "png"), wide, high, told)
    view = ShellCommand(command_line("view", test))
    again = ["To drive it again: ", ShellCommand(drive), " "] * (not is_run(record.folder))
    blocks: list[Block] = [
        _cut(said, 2 * LONG),
        Figure("worst", "", picture),
        [*again, "To see it in 3-D: ", view],
    ]
    return Section("The worst case" if its.failed else "The case that came nearest to failing", blocks)
