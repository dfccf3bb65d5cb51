"""Tells, as lines of text or as JSON, of a Run, a folder of runs or a campaign; runs a campaign."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path

import click
import numpy as np

from roadgpt import plugins
from roadgpt.brief.scene import Event
from roadgpt.campaign.csv_tables import RESULTS
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.gate import Gate
from roadgpt.campaign.model import NumberedTest, no_failure
from roadgpt.campaign.selection import Selection, selection_of
from roadgpt.campaign.status import CellStatus, Status, status_of
from roadgpt.chat import Spent
from roadgpt.chat.answer import plain
from roadgpt.check.measures import ups_and_downs
from roadgpt.cli.options import Remarks
from roadgpt.cli.repeat_commands import replay_lines, to_resume
from roadgpt.cli.roads import NamedRoad, roads_named
from roadgpt.cli.screen import COLOURS, WIDEST, Row, driver_and_oracle, metres, row_of, spending
from roadgpt.cli.streams import aligned, apart, duration, progress, resumable
from roadgpt.errors import UsageError, command_line
from roadgpt.plural import plural
from roadgpt.road.world import oracle_in_words
from roadgpt.run.folder import is_run, read_run, run_folder
from roadgpt.run.model import Run, permissions
from roadgpt.verdict import JUDGEMENT, percent

MOST_CELLS = 40  # largest number of cells that are shown one by one
MOST_TESTS = 40  # of a cell, one by one
HEAD, SIDES = ("cell", "done", "pass", "fail", "other", "least margin", "what"), "<>>>>><"
LONGEST, WIDEST_TEXT = 60, 300  # letters of a description, and of other texts, in a line of a table


def watch(folder: Path, steps: Iterator[Counter[str]], as_json: bool, quiet: bool, gate: Gate) -> None:
    """Runs a campaign, shows its progress and prints its results; after Ctrl-C, prints how to resume it."""
    advice = f"finished tests are kept; continue with: {to_resume(folder)}"
    with open_record(folder) as record:
        total, keeps_runs = record.total(), record.keeps_runs
    with resumable(advice), progress("tests", None, quiet, has_lines=False) as tell:
        for outcomes in apart(steps):
            tell(outcomes.total(), total=total, rate=outcomes_line(outcomes))
    status = status_of(folder)
    gate.add_folder(folder)
    if as_json:
        click.echo(_as_json(status, gate))
    elif not quiet:
        click.echo("\n".join(_told(status)))
        tables = f"tables: {folder / 'results.csv'} and {folder / 'cells.csv'}"
        click.echo(f"tests and tables: {folder}" if keeps_runs else tables)
    if gate.remark and not quiet:
        click.echo(gate.remark, err=as_json)


def _remarks(status: Status) -> list[Remarks]:
    return [plugins.find("analyses", name).told(status) for name in plugins.names("analyses")]


def _as_json(status: Status, gate: Gate | None = None) -> str:
    fields = {name: told for each in _remarks(status) for name, told in each.fields.items()}
    judged = {"gate": gate.sentence, "worse": gate.worse} if gate else {}
    return json.dumps({**status.to_json(), **fields, **judged})


def outcomes_line(outcomes: Mapping[str, int]) -> str:
    """Returns the number of tests with each outcome as text, such as '120 PASS, 31 FAIL'."""
    names = [*COLOURS, *sorted(outcomes.keys() - COLOURS.keys())]
    return ", ".join(f"{outcomes[name]:,} {name}" for name in names if outcomes.get(name)) or "nothing yet"


def _told(status: Status) -> Iterator[str]:
    """Yields a campaign's progress, outcomes and what analyses tell, and what to do next."""
    remarks, cells = _remarks(status), status.cells
    yield _headline(status)
    yield from (f"  {each.headline}" for each in remarks if each.headline)
    yield f"  {outcomes_line(status.outcomes)}"
    if other := sum(cell.handed_over for cell in cells):
        yield f"  in {other:,} FAIL the driver had handed over: they are not its failures"
    if {"PASS", "FAIL"} & status.outcomes.keys():
        yield f"  {driver_and_oracle([cell.driver for cell in cells], cells[0].oracle)}"
    yield from (f"  {each.advice}" for each in remarks if each.advice)
    if status.tokens:
        yield f"  language model: {status.tokens:,} tokens, {status.cost_usd:.4f} USD"
    if not status.is_finished and not status.is_running:
        yield f"  continue with: {to_resume(Path(status.folder))}"
    yield from cell_lines(cells[:MOST_CELLS])
    if len(cells) > MOST_CELLS:
        yield f"and {len(cells) - MOST_CELLS:,} more cells; --json tells of all"
    if status.scenarios:
        heads, *counted = status.scenario_table
        rows = ((name, *map("{:,}".format, counts)) for name, *counts in counted)
        yield from aligned([heads, *rows], "<" + ">" * (len(heads) - 1))
    partly = sum(cell.partly_outside for cell in cells)
    mostly = sum(cell.mostly_outside for cell in cells)
    if partly + mostly:
        share, beyond = max(cell.max_oob or 0.0 for cell in cells), max(cell.beyond or 0.0 for cell in cells)
        yield (
            f"of {status.outcomes.get('PASS', 0):,} PASS, {partly:,} were partly and {mostly:,} mostly "
            f"outside their lane, within the tolerance: at most {percent(share)} of the car, {beyond:.2f} m "
            "beyond the marking"
        )
    yield from () if status.is_running else no_failure(status.outcomes)
    yield from [cell.remark for cell in cells[:MOST_CELLS] if cell.remark]


def _headline(status: Status) -> str:
    """Returns the state of a campaign as one line: its folder, number of tests, running time and time
    left."""
    state = "finished" if status.is_finished else "at work" if status.is_running else "interrupted"
    of = "" if status.total is None else f" of {status.total:,}"
    pace = f", {status.rate:.1f} tests/s" if status.rate else ""
    left = status.seconds_left if status.rate and status.is_running else None
    more = f", {duration(left)} to go" if left else ""
    return f"{status.folder}: {state}, {status.done:,}{of} tests in {duration(status.seconds)}{pace}{more}"


def cell_lines(cells: Sequence[CellStatus]) -> list[str]:
    """Returns a table with a line for each cell: one combination of the campaign's descriptions, designers,
    drivers and other settings."""
    rows: list[Sequence[str]] = [HEAD]
    for cell in cells:
        passed, failed = cell.outcomes.get("PASS", 0), cell.outcomes.get("FAIL", 0)
        margin = "-" if cell.least_margin is None else metres(cell.least_margin)
        by = f"({plain(cell.driver, WIDEST_TEXT)}, {cell.generator}, seed {cell.seed})"
        why = f"; {plain(cell.closed, WIDEST_TEXT)}" if cell.closed else ""
        counts = (cell.done, passed, failed, cell.done - passed - failed)
        what = f"{plain(cell.about, LONGEST)} {by}{why}"
        rows.append((cell.name or "-", *(f"{count:,}" for count in counts), margin, what))
    return aligned(rows, SIDES)


def json_lines(path: Path | str, choice: str | None = None) -> Iterator[str]:
    """Yields one JSON object for a whole campaign, or one for each named road."""
    place = selection_of(str(path))
    if place is not None and not (place.cell or choice or _keeps_runs(place)):
        yield _as_json(status_of(place.folder))
        return
    for named in roads_named([str(path)], choice, takes_all=True):
        if named.run is None:
            raise UsageError(f"{path} is a road file, not a run; use 'roadgpt check'")
        yield row_of(named.run(), named.said).to_json()


def _keeps_runs(place: Selection) -> bool:
    with open_record(place.folder) as record:
        return record.keeps_runs


def text_lines(path: Path | str, choice: str | None = None) -> Iterator[str]:
    """Yields the summary of a Run with the commands that repeat the Run, or an overview of the tests in a
    folder, a campaign or a cell. If ``choice`` selects one road of a folder, yields the summary of this road;
    if it selects several, a line for each."""
    place = selection_of(str(path))
    if choice is not None or (place is not None and place.number is not None):
        named = [*roads_named([str(path)], choice)]
        if len(named) == 1:
            yield from _run_of(named[0])
        else:
            yield from (_line_of(row_of(each.run(), each.said)) for each in named if each.run)
    elif place is None:
        run = read_run(path)
        folder = Path(path) if Path(path).is_dir() else run_folder(Path(path).parent, run.index)
        yield from _run_lines(run, replay_lines(run, folder))
    elif place.cell:
        yield from _cell_lines(place)
    elif not _keeps_runs(place):
        status = status_of(place.folder)
        yield from _told(status)
        if "FAIL" in status.outcomes:
            yield f"all failures: {command_line('show', place.folder, '--failures')}"
        elif status.cells[0].done:
            yield f"one test: {command_line('show', f'{place.folder}/{status.cells[0].name}/1')}"
    else:
        yield from _folder_lines(place.folder)


def _cell_lines(place: Selection) -> Iterator[str]:
    (cell,) = [cell for cell in status_of(place.folder).cells if cell.name == place.cell]
    yield from cell_lines([cell])
    yield driver_and_oracle([cell.driver], cell.oracle)
    with open_record(place.folder) as record:
        own = record.cell(place.cell)
        for result in islice(record.results(place.cell), MOST_TESTS):
            name = place.of(NumberedTest(place.cell, result.number)).said
            yield _line_of(row_of(result, name=name, test=own.scenario_of(result.proposal.origin)))
    if not cell.done:
        yield "no test has ended yet"
    elif cell.done > MOST_TESTS:
        yield f"and {cell.done - MOST_TESTS:,} more tests; all: {place.folder / RESULTS}"


def _line_of(row: Row) -> str:
    margin = "" if row.margin_m is None else metres(row.margin_m)
    measured = f"{row.outcome:<{WIDEST}} {row.length_m or 0:>5.0f} m {margin:>9}"
    what = "; ".join(each for each in (row.test, *row.told_numbers.values()) if each)
    return f"{row.file or row.name}  {measured}  {what}{': ' * bool(what)}{row.description}"


def _run_of(named: NamedRoad) -> Iterator[str]:
    assert named.run is not None
    run = named.run()
    if isinstance(named.key, Path):
        return _run_lines(run, replay_lines(run, named.key))
    again = command_line("drive", "--again", named.said, *permissions([run.request.setup], replays=True))
    return _run_lines(run, [again, command_line("view", named.said)])


def _run_lines(run: Run, again: Sequence[str]) -> Iterator[str]:
    yield f"{run.outcome}: {run.description}"
    if run.words:
        yield f"  words     {run.words}"
    if run.brief is not None:
        from roadgpt.brief import remarks, sentence

        yield f"  brief     {sentence(run.brief)}"
        site = run.world.site
        for remark in remarks(run.brief, site.map_size, site.friction, run.world.scene.surfaces):
            yield f"  note      {remark}"
    if run.road is not None:
        yield f"  road      {_road_line(run)}"
        drafts = f", {run.rounds} draft{'s' * (run.rounds != 1)}" if run.rounds else ""
        objections = "; ".join(finding.sentence for finding in run.findings) or "no objection"
        yield f"  check     {run.request.setup.rules}: {objections}{drafts}"
    if run.drive is not None:
        fastest = run.drive["speed"].max() * 3.6
        yield (
            f"  drive     {run.drive.driver} in {run.drive.simulator}: {run.drive.duration:.1f} s, "
            f"up to {fastest:.0f} km/h"
        )
    if run.verdict is not None:
        verdict, limits, row = run.verdict, run.world.limits, row_of(run)
        margin = "" if row.margin_m is None else f", margin {metres(row.margin_m)}"
        yield (
            f"  verdict   at most {percent(verdict.max_oob)} of the car outside its lane, "
            f"{verdict.beyond:.2f} m beyond the marking{margin}"
        )
        if row.test:
            yield f"  scenario  {row.test}"
        yield from (f"  {part:<8}  {text}" for part, text in row.told_numbers.items())
        for number, event in enumerate(verdict.events or ()):
            yield f"  {'events' if number == 0 else '':<8}  {_event_line(event)}"
        if verdict.law is not None:
            other = next(str(each.other) for each in verdict.incidents or () if each.contact)
            told = verdict.law.said(other) or "nobody's offence"
            yield f"  law       {told}; at fault: {verdict.at_fault}"
        yield f"  oracle    {oracle_in_words(limits.oracle)}"
    designing = run.designing
    if run.spent is not None:  # on language models
        rounds = designing and f"{designing.rounds} round{'s' * (designing.rounds != 1)}"
        yield f"  model     {f'{designing.model}, {rounds}: ' if designing else ''}{spending(run.spent)}"
    for number, change in enumerate(designing.changes if designing else ()):
        yield f"  {'changed' if number == 0 else '':<8}  {change}"
    yield f"  seed      {run.seed}" + (f" (road {run.index} of seed {run.request.seed})" if run.words else "")
    yield f"  versions  {', '.join(f'{name} {number}' for name, number in run.versions.items())}"
    if run.seconds.total:
        yield f"  took      {run.seconds.design * 1000:.1f} ms to design, {run.seconds.drive:.2f} s to drive"
    for number, line in enumerate(again):
        yield f"  {'again' if number == 0 else 'or':<8}  {line}"


def _event_line(event: Event) -> str:
    """Returns when and where something happened, and what it was."""
    when = "never" if event.time is None else f"{event.time:.1f} s"
    where = "" if event.s is None else f"{event.s:.0f} m"
    until = "" if event.until is None else f", until {event.until:.1f} s"
    why = f": {event.why}" if event.why else ""
    return f"{when:>7} {where:>7}  {event.who}: {event.what}{until}{why}"


def _road_line(run: Run) -> str:
    assert run.road is not None
    samples = run.road.sample()
    bend = float(np.abs(samples.curvature).max())
    tightest = f"tightest radius {1 / bend:.0f} m" if bend > 1e-6 else "straight"
    steep = float(samples.grade[np.abs(samples.grade).argmax()])
    return f"{run.length:.0f} m, {tightest}, {ups_and_downs(samples.z)} m in height, steepest {steep:+.1%}"


def rejudged_lines(folders: Sequence[str], as_json: bool) -> Iterator[str]:
    """Yields a line for each stored outcome of folders that would be another one today, or cannot be judged
    again, and how many there are of each kind; or one JSON object for each test."""
    from roadgpt.campaign.rejudging import rejudge

    kinds, versions, lost, of_catalogue = Counter[str](), Counter[int](), 0, 0
    for folder in folders:
        for each in rejudge(Path(folder)):
            name = str(folder) if is_run(Path(folder)) else f"{folder}/{each.name}"
            if as_json:
                yield json.dumps({**each._asdict(), "name": name, "rules": JUDGEMENT})
                continue
            lost, of_catalogue = lost + (not each.today), of_catalogue + (not each.has_scene)
            if not each.today:
                yield f"{name}  cannot be judged again: {each.why}"
                continue
            versions[each.version] += 1
            if each.today != each.stored:
                kinds[kind := f"{each.stored} -> {each.today}"] += 1
                yield f"{name}  {kind}  {each.why}"
    if as_json:
        return
    drives, others = plural(versions.total(), "drive"), plural(kinds.total(), "outcome")
    rules = " and ".join(f"{count:,} of version {version}" for version, count in sorted(versions.items()))
    yield f"{drives} judged again by version {JUDGEMENT} of the rules" + f": {rules}" * bool(rules)
    yield f"{others} would be others today" + f", {lost:,} cannot be judged again" * bool(lost)
    yield from (f"  {count:>5,}  {kind}" for kind, count in kinds.most_common())
    if of_catalogue:
        yield f"{of_catalogue:,} by scenes of today's catalogue: a campaign of scenarios stores none"


def _folder_lines(folder: Path) -> Iterator[str]:
    counts: Counter[str] = Counter()
    spent = Spent()
    with open_record(folder) as record:
        (cell,) = record.cells()
        yield f"{cell.request.words or 'roads that were given'} (seed {cell.request.seed})"
        yield f"{'road':>6}  {'outcome':<{WIDEST}} {'length':>7} {'margin':>9}  description"
        for name in record.tests():
            try:
                run = record.run(*name)
            except UsageError as error:
                counts["unreadable"] += 1
                yield f"{name!s:>6}  cannot be read: {error}"
                continue
            counts[run.outcome] += 1
            spent = spent + (run.spent or Spent())
            yield _line_of(row_of(run, f"{name!s:>6}"))
    if spent.calls:
        yield f"language model: {spending(spent)}"
    roads = cell.budget.most
    rest = f"; {roads - counts.total()} of {roads} still to be made" if counts.total() < roads else ""
    if cell.request.setup.drives:
        yield driver_and_oracle([cell.request.setup.driver], cell.request.world.limits.oracle)
    yield outcomes_line(counts) + rest
