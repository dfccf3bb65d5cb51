"""``--junit``: writes tests as JUnit XML, for continuous integration."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.cli.result_row import Row, row_of_result

if TYPE_CHECKING:
    from roadgpt.campaign.model import Cell
    from roadgpt.report.junit import Case, Properties, Suite
    from roadgpt.run.model import Request

LONGEST = 120  # letters of a suite's name
IN_CASE = ("seed", "max_oob", "beyond_m", "margin_m", "length_m", "at_s_m", "side", "own_share", "handed_to")
UNKNOWN = "roads that were given"


def write_rows(path: Path, request: "Request", rows: Sequence[Row]) -> None:
    """Writes result rows of a request as a JUnit file; raises RoadGPTError if it cannot be written."""
    from roadgpt.report.junit import Suite, write_junit

    write_junit(path, [Suite(_named(request.words), common(request), lambda: map(_case, rows))])


def write_folder(path: Path, folder: Path, worse: Mapping[str, str]) -> None:
    """Writes the tests of a folder of runs, a campaign or a study as a JUnit file; ``worse`` says of some, by
    names such as DIR/c01/17, in what they are worse than in a baseline.

    Raises:
        UsageError: The folder is none of these, or one of its files cannot be read.
        RoadGPTError: The file cannot be written.
    """
    from roadgpt.report.junit import write_junit

    write_junit(path, _suites(folder, worse))


def _suites(folder: Path, worse: Mapping[str, str]) -> Iterator["Suite"]:
    from roadgpt.study import plan

    if not (folder / plan.CARD).is_file():
        yield from _of_folder(folder, worse)
        return
    for part in plan.read_plan(folder).parts():
        if (folder / part.name).is_dir():
            yield from _of_folder(folder / part.name, worse)


def _of_folder(folder: Path, worse: Mapping[str, str]) -> Iterator["Suite"]:
    from roadgpt.campaign.folder_record import open_record
    from roadgpt.report.junit import Suite

    with open_record(folder) as record:
        cells = record.cells()
        for cell in cells:
            name = _named(cell.request.words)
            shown = name if len(cells) == 1 else f"{cell.name}: {name}"
            of_cell = {"cell": cell.name, "generator": cell.generator, "goal": cell.goal} if cell.name else {}
            yield Suite(shown, {**common(cell.request), **of_cell}, partial(_of_cell, folder, cell, worse))


def _of_cell(folder: Path, cell: "Cell", worse: Mapping[str, str]) -> Iterator["Case"]:
    from roadgpt.campaign.folder_record import open_record
    from roadgpt.campaign.model import NumberedTest

    times = (
        "SELECT number, coalesce(design_s, 0) + coalesce(drive_s, 0) FROM tests "
        "WHERE cell = ? AND outcome IS NOT NULL"
    )
    errors = "SELECT number, error FROM details WHERE cell = ? AND error IS NOT NULL"
    with open_record(folder) as record:
        took: dict[int, float] = dict(record.query(times, (cell.name,)))
        said: dict[int, str] = dict(record.query(errors, (cell.name,)))
        for result in record.results(cell.name):
            number, file = result.number, record.file(result.number)
            test = str(NumberedTest(cell.name, number))
            row = row_of_result(result, cell.request.words, record.seed(result), Path(file).name or test)
            row = replace(row, seconds=took.get(number, 0.0), file=file, trace=str(said.get(number, "")))
            row = replace(row, worse=worse.get(f"{folder}/{test}", ""))
            yield _case(row, result.proposal.origin if cell.name else None)


def _named(words: str) -> str:
    return words[:LONGEST] or UNKNOWN


def common(request: "Request") -> "Properties":
    """Returns the settings that all tests of a request share, as JUnit properties."""
    setup, world = request.setup, request.world
    return {
        "words": request.words or None,
        "seed": request.seed,
        "designer": setup.designer,
        "driver": setup.driver,
        "simulator": setup.simulator,
        "oracle": world.limits.oracle,
        "oob_tolerance": world.limits.oob_tolerance,
        "lane_departure": str(world.limits.lane_departure).lower(),
        "speed_limit_kmh": round(world.limits.speed_limit * 3.6, 6),
        "friction": world.site.friction,
    }


def _case(row: Row, origin: str | None = None) -> "Case":
    from roadgpt.report.junit import Case

    numbers = {name: getattr(row, name) for name in IN_CASE}
    properties = {"words": row.words or None, "origin": origin, **numbers}
    outcome, says = row.test_outcome, row.description
    if row.worse:
        outcome = "ERROR" if outcome == "ERROR" else "FAIL"
        says = f"worse than in the baseline: {row.worse}; {says}"
    return Case(
        row.name or row.file, outcome, says, row.cause or "", row.seconds, row.file, row.trace, properties
    )
