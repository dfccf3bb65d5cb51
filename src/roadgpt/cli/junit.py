"""``--junit``: writes tests as JUnit XML, for continuous integration."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.cli.result_row import Row, row_of

if TYPE_CHECKING:
    from roadgpt.report.junit import Case, Properties, Suite
    from roadgpt.run.model import Request

LONGEST = 120  # letters of a suite's name
UNKNOWN = "roads that were given"


def junit_writer(path: Path | None, request: "Request") -> "Callable[[Sequence[Row]], object] | None":
    """Returns a function that writes result rows as a JUnit file, a test case for each; None if no path is
    given.

    Args:
        path: The JUnit file to write.
        request: The request from which all the roads are made.

    The returned function raises RoadGPTError if the file cannot be written.
    """
    if path is None:
        return None
    from roadgpt.report.junit import Suite, write_junit

    name, shared = _named(request.words), common(request)
    return lambda rows: write_junit(path, [Suite(name, shared, lambda: map(_case, rows))])


def write_folder(path: Path, folder: Path) -> None:
    """Writes the tests of a folder of runs, a campaign or a study as a JUnit file.

    Raises:
        UsageError: The folder is none of these, or one of its files cannot be read.
        RoadGPTError: The file cannot be written.
    """
    from roadgpt.report.junit import write_junit

    write_junit(path, _suites(folder))


def _suites(folder: Path) -> Iterator["Suite"]:
    from roadgpt.campaign.record import STORE
    from roadgpt.study import plan

    if (folder / plan.CARD).is_file():
        for part in plan.read_plan(folder).parts():
            if (folder / part.name).is_dir():
                yield _of_runs(folder / part.name)
    elif (folder / STORE).is_file():
        yield from _of_campaign(folder)
    else:
        yield _of_runs(folder)


def _of_runs(folder: Path) -> "Suite":
    from roadgpt.report.junit import Suite
    from roadgpt.run import read_run
    from roadgpt.run.card import read_card
    from roadgpt.run.folder import finished, run_folder
    from roadgpt.run.sbft_json import test_name

    request = read_card(folder).request
    names = [(test_name(index), run_folder(folder, index)) for index in finished(folder)]
    return Suite(
        _named(request.words),
        common(request),
        lambda: (_case(row_of(read_run(place), str(folder / name), name)) for name, place in names),
    )


def _of_campaign(folder: Path) -> Iterator["Suite"]:
    """Yields a suite for each cell; reads the rows of the store one at a time."""
    from roadgpt.campaign.record import Record
    from roadgpt.report.junit import Suite

    with Record.opened(folder) as record:
        cells = record.cells()
        for cell in cells:
            name = _named(cell.request.words)
            shown = name if len(cells) == 1 else f"{cell.name}: {name}"
            told = {"cell": cell.name, "generator": cell.generator, "goal": cell.goal}
            cases = partial(_of_cell, folder, cell.name, cell.request.words)
            yield Suite(shown, {**common(cell.request), **told}, cases)


def _of_cell(folder: Path, cell: str, words: str) -> Iterator["Case"]:
    from roadgpt.campaign.record import Record
    from roadgpt.campaign.single_test import seed_of_driver
    from roadgpt.report.junit import Case

    with Record.opened(folder) as record:
        took: dict[int, float] = dict(
            record.query("SELECT number, coalesce(design_s, 0) + coalesce(drive_s, 0) FROM tests "
                         "WHERE cell = ? AND outcome IS NOT NULL", (cell,))
        )  # fmt: skip
        for result in record.results(cell):
            yield Case(
                name=f"{cell}/{result.number}",
                outcome=result.outcome,
                says=result.description,
                kind=result.cause or "",
                seconds=took.get(result.number, 0.0),
                properties={
                    "words": words or None,
                    "seed": seed_of_driver(result.number, result.proposal),
                    "origin": result.proposal.origin,
                    "max_oob": result.max_oob,
                    "beyond_m": result.beyond,
                    "margin_m": result.margin,
                    "length_m": result.length,
                    "at_s_m": result.at_s,
                    "side": result.side,
                },
            )


def _named(words: str) -> str:
    return words[:LONGEST] or UNKNOWN


def common(request: "Request") -> "Properties":
    """Returns the settings of a request as JUnit properties, which hold for all its tests."""
    setup, world = request.setup, request.world
    return {
        "words": request.words or None,
        "seed": request.seed,
        "designer": setup.designer,
        "driver": setup.driver,
        "simulator": setup.simulator,
        "oob_tolerance": world.limits.oob_tolerance,
        "lane_departure": str(world.limits.lane_departure).lower(),
        "speed_limit_kmh": round(world.limits.speed_limit * 3.6, 6),
        "friction": world.site.friction,
    }


def _case(row: Row) -> "Case":
    from roadgpt.report.junit import Case

    numbers = {name: getattr(row, name) for name in ("seed", "max_oob", "beyond_m", "margin_m", "length_m")}
    return Case(
        row.name or row.file, row.test_outcome, row.description, row.cause or "", row.seconds, row.file,
        row.trace, {"words": row.words or None, **numbers},
    )  # fmt: skip
