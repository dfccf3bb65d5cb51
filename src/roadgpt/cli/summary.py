"""Summarises a Run, a folder of runs or a campaign, as lines of text or as JSON."""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from roadgpt.campaign.csv_tables import RESULTS
from roadgpt.campaign.folder_record import is_store, open_record
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.selection import Choice, Selection, selection_of
from roadgpt.campaign.status import status_of
from roadgpt.chat import Spent
from roadgpt.check.measures import ups_and_downs
from roadgpt.cli.campaigns import as_line, cell_lines, faults_of, outcomes_line, told
from roadgpt.cli.repeat_commands import replay_lines
from roadgpt.cli.result_row import WIDEST, Row, driver_and_oracle, metres, row_of, row_of_result, spending
from roadgpt.cli.roads import NamedRoad, roads_named
from roadgpt.errors import UsageError, command_line
from roadgpt.road.oracles import oracle_in_words
from roadgpt.run.folder import read_run, run_folder
from roadgpt.run.model import Run, permissions
from roadgpt.verdict.severity import percent

MOST_TESTS = 40  # of a cell, one by one


def show(path: Path | str, choice: Choice | None = None) -> str:
    """Returns the summary of a Run with the commands that repeat the Run, or an overview of the tests in a
    folder, a campaign or a cell. If ``choice`` selects one road of a folder, returns the summary of this
    road. If ``choice`` selects several roads, returns a list with one line per road.

    Raises:
        UsageError: No run, folder, campaign, cell or test has that name.
    """
    return "\n".join(_lines(path, choice))


def progress_lines(campaign: Path, as_json: bool = False) -> Iterator[str]:
    """Yields the progress of a campaign as lines of text, or as one JSON object.

    Raises:
        UsageError: The folder holds no campaign.
    """
    status = status_of(campaign)
    found = faults_of(status)
    yield from [as_line(status, found)] if as_json else told(status, found)


def json_lines(path: Path | str, choice: Choice | None = None) -> Iterator[str]:
    """Yields one JSON object for a whole campaign, or one for each named road.

    Raises:
        UsageError: No run, folder, campaign, cell or test has that name.
    """
    place = selection_of(str(path))
    if place is not None and is_store(place.folder) and not place.cell and choice is None:
        yield from progress_lines(place.folder, as_json=True)
        return
    for named in roads_named([str(path)], choice, takes_all=True):
        if named.run is None:
            raise UsageError(f"{path} is a road file, not a run; use 'roadgpt check'")
        yield row_of(named.run(), named.said).to_json()


def _lines(path: Path | str, choice: Choice | None) -> Iterator[str]:
    place = selection_of(str(path))
    if choice is not None or (place is not None and place.number is not None):
        named = [*roads_named([str(path)], choice)]
        yield from _run_of(named[0]) if len(named) == 1 else map(_one_line, named)
    elif place is None:
        run = read_run(path)
        folder = Path(path) if Path(path).is_dir() else run_folder(Path(path).parent, run.index)
        yield from _run_lines(run, replay_lines(run, folder))
    elif place.cell:
        yield from _cell_lines(place)
    elif is_store(place.folder):
        status = status_of(place.folder)
        yield from told(status, faults_of(status))
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
        for result in islice(record.results(place.cell), MOST_TESTS):
            name = place.of(NumberedTest(place.cell, result.number)).said
            yield _line_of(row_of_result(result, cell.words, record.seed(result), name))
    if not cell.done:
        yield "no test has ended yet"
    elif cell.done > MOST_TESTS:
        yield f"and {cell.done - MOST_TESTS:,} more tests; all: {place.folder / RESULTS}"


def _one_line(named: NamedRoad) -> str:
    assert named.run is not None
    return _line_of(row_of(named.run(), named.said))


def _line_of(row: Row) -> str:
    margin = "" if row.margin_m is None else metres(row.margin_m)
    measured = f"{row.outcome:<{WIDEST}} {row.length_m or 0:>5.0f} m {margin:>9}"
    return f"{row.file or row.name}  {measured}  {row.description}"


def _run_of(named: NamedRoad) -> Iterator[str]:
    assert named.run is not None
    run = named.run()
    if isinstance(named.key, Path):
        return _run_lines(run, replay_lines(run, named.key))
    again = command_line("drive", "--again", named.said, *permissions([run.request.setup]))
    return _run_lines(run, [again, command_line("view", named.said)])


def _run_lines(run: Run, again: Sequence[str]) -> Iterator[str]:
    yield f"{run.outcome}: {run.description}"
    if run.words:
        yield f"  words     {run.words}"
    if run.brief is not None:
        from roadgpt.brief import remarks, sentence

        yield f"  brief     {sentence(run.brief)}"
        site = run.world.site
        for remark in remarks(run.brief, site.map_size, site.friction):
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
        verdict, limits = run.verdict, run.world.limits
        beyond = "an unknown distance" if verdict.beyond is None else f"{verdict.beyond:.2f} m"
        yield (
            f"  verdict   at most {percent(verdict.max_oob)} of the car outside its lane, {beyond} "
            f"beyond the marking, margin {metres(verdict.margin)}"
        )
        yield f"  oracle    {oracle_in_words(limits.oracle)}"
    yield from _asked_lines(run)
    yield f"  seed      {run.seed}" + (f" (road {run.index} of seed {run.request.seed})" if run.words else "")
    yield f"  versions  {', '.join(f'{name} {number}' for name, number in run.versions.items())}"
    if run.seconds.total:
        yield f"  took      {run.seconds.design * 1000:.1f} ms to design, {run.seconds.drive:.2f} s to drive"
    for number, line in enumerate(again):
        yield f"  {'again' if number == 0 else 'or':<8}  {line}"


def _asked_lines(run: Run) -> Iterator[str]:
    """Yields what the language models cost, and what was changed in their answers."""
    told = run.designing
    if run.spent is not None:
        by = f"{told.model}, {told.rounds} round{'s' * (told.rounds != 1)}: " if told else ""
        yield f"  model     {by}{spending(run.spent)}"
    for number, change in enumerate(told.changes if told else ()):
        yield f"  {'changed' if number == 0 else '':<8}  {change}"


def _road_line(run: Run) -> str:
    assert run.road is not None
    samples = run.road.sample()
    bend = float(np.abs(samples.curvature).max())
    tightest = f"tightest radius {1 / bend:.0f} m" if bend > 1e-6 else "straight"
    steep = float(samples.grade[np.abs(samples.grade).argmax()])
    return f"{run.length:.0f} m, {tightest}, {ups_and_downs(samples.z)} m in height, steepest {steep:+.1%}"


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
