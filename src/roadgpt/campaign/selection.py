"""Finds the tests that a command's argument selects in a folder: all tests, those of one cell, or one test.

hard            all tests of the campaign in the folder ``hard``, or all runs of a folder of runs
hard/c01        the tests of a cell
hard/c01/17     one test; hard/17 if there is only one cell, or if ``hard`` is a folder of runs
"""

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

from roadgpt.campaign.faults import faults_in, kept_analysis
from roadgpt.campaign.numbered_test import NumberedTest
from roadgpt.campaign.record import STORE, Record
from roadgpt.campaign.rerun import kept_run
from roadgpt.errors import UsageError
from roadgpt.run import Run, read_run
from roadgpt.run.folder import RUNS, is_run, run_folder

Choice = Literal["failures", "faults", "worst"]
"""Which of the selected tests: "failures", all failures; "faults", a typical failure of each distinct
fault; "worst", the failure with the smallest margin, or if no test failed, the test nearest to a failure.
"""
LONGEST = 255  # bytes of one name, in every file system of today
DIGITS = 18  # of a number that a store can look for
WORST = "outcome != 'FAIL', margin IS NULL, margin, max_oob DESC,"  # first
MOST_NEAR = 3  # names that are offered for a wrong one


@dataclass(frozen=True)
class Selection:
    """The tests that the text of a command's argument selects."""

    said: str
    folder: Path
    cell: str = ""
    """Name of the cell; empty: all cells."""
    number: int | None = None
    """Number of the test; None: all tests."""

    @property
    def is_campaign(self) -> bool:
        """True if the tests are in the store of a campaign."""
        return (self.folder / STORE).is_file()

    def of(self, name: NumberedTest) -> "Selection":
        """Returns the Selection of one test of this folder, with the text by which a user would name that
        test.
        """
        return Selection(f"{self.folder}/{name}", self.folder, name.cell, name.number)

    @property
    def stem(self) -> str:
        """The beginning of the names of files made from the selected test, such as 'hard-c01-0017'."""
        parts = (self.folder.resolve().name, self.cell, f"{self.number or 0:04d}")
        return "-".join(part for part in parts if part)

    def run(self) -> Run:
        """Returns the stored Run of the selected test; nothing is driven.

        Raises:
            UsageError: the Run cannot be read, or it has no road.
        """
        assert self.number is not None
        return kept_run(self.folder, self.cell, self.number)


def selection_of(text: str) -> Selection | None:
    """Returns the Selection for the text of a command's argument; None if the text is anything else, such as
    the path of a single run or of a road file.

    Raises:
        UsageError: the text names a test or a cell that does not exist.
    """
    path = Path(text)
    if any(len(part.encode()) > LONGEST for part in path.parts):
        raise UsageError(f"there is no test or file called {text[:100]}...: the name is too long")
    if path.exists():
        is_many = path.is_dir() and not is_run(path) and (_is_store(path) or (path / RUNS).is_dir())
        return Selection(text, path) if is_many else None
    last, number = path.name, _number(path.name)
    above, two_above = path.parent, path.parent.parent
    if _is_store(above):
        with Record.opened(above) as record:
            if number is None:
                return Selection(text, above, _cell(record, last))
            return _test(record, text, _only_cell(record, number), number)
    if number is not None and above.name and _is_store(two_above):
        with Record.opened(two_above) as record:
            return _test(record, text, _cell(record, above.name), number)
    if number is not None and (above / RUNS).is_dir() and _runs(above):
        return _run_of(text, above, number)
    return None


def _is_store(path: Path) -> bool:
    return (path / STORE).is_file()


def _number(text: str) -> int | None:
    return int(text) if text.isascii() and text.isdecimal() and len(text) <= DIGITS else None


def _only_cell(record: Record, number: int) -> str:
    names = record.names()
    if len(names) > 1:
        raise UsageError(
            f"{record.folder} has several cells; say of which one test {number} is, "
            f"as {record.folder}/{names[0]}/{number}"
        )
    return names[0]


def _cell(record: Record, name: str) -> str:
    names = record.names()
    if name in names:
        return name
    near = get_close_matches(name, names, MOST_NEAR, 0.3) or names[:MOST_NEAR]
    raise UsageError(
        f"there is no cell '{name}' in {record.folder}; "
        f"{'its cells are' if len(names) <= MOST_NEAR else 'it has'} {', '.join(near)}"
        + (f" and {len(names) - len(near)} more" if len(names) > len(near) else "")
    )


def _test(record: Record, text: str, cell: str, number: int) -> Selection:
    found = record.query("SELECT outcome FROM tests WHERE cell = ? AND number = ?", (cell, number))
    if found and found[0][0] is not None:
        return Selection(text, record.folder, cell, number)
    if found:
        raise UsageError(f"test {number} of {cell} in {record.folder} has not ended yet")
    ((low, high),) = record.query("SELECT min(number), max(number) FROM tests WHERE cell = ?", (cell,))
    there = "it has no tests yet" if low is None else f"its tests are {low} to {high}"
    raise UsageError(f"{record.folder} holds no result of test {number} of {cell}; {there}")


def _run_of(text: str, folder: Path, number: int) -> Selection:
    if is_run(run_folder(folder, number)):
        return Selection(text, folder, "", number)
    there = _runs(folder)
    raise UsageError(f"there is no run {number} in {folder}; its runs are {there[0]} to {there[-1]}")


def _runs(folder: Path) -> list[int]:
    """Returns the numbers of the runs in a folder of runs."""
    paths = (path for path in (folder / RUNS).iterdir() if is_run(path))
    return sorted(number for path in paths if (number := _number(path.name)) is not None)


def chosen(place: Selection, choice: Choice | None) -> list[Selection]:
    """Splits a Selection into Selections of one test each, in order.

    Args:
        place: the Selection to split.
        choice: which tests of the selection to return; None: all tests that have a road.

    Raises:
        UsageError: a file cannot be read.
    """
    if place.number is not None:
        return [place]
    if choice == "faults":
        found = faults_in(place.folder, cell=place.cell)
        looked = [(fault, kept_analysis(place.folder, fault)) for fault in found.them]
        return [place.of(its.name if its else fault.names[0]) for fault, its in looked]
    names = _of_campaign(place, choice) if place.is_campaign else _of_runs(place, choice)
    return [place.of(name) for name in names]


def _of_campaign(place: Selection, choice: Choice | None) -> list[NumberedTest]:
    which = {"failures": "outcome = 'FAIL'", "worst": "outcome IN ('FAIL', 'PASS')"}
    order = f"{WORST} tests.cell, tests.number" if choice == "worst" else "tests.cell, tests.number"
    sql = (
        "SELECT tests.cell, tests.number FROM tests JOIN details USING (cell, number) "  # noqa: S608 - our words
        f"WHERE outcome IS NOT NULL AND design IS NOT NULL AND {which.get(choice or '', '1')} "
        f"AND (? = '' OR tests.cell = ?) ORDER BY {order}"
    )
    with Record.opened(place.folder) as record:
        names = [NumberedTest(*row) for row in record.query(sql, (place.cell, place.cell))]
    return names[:1] if choice == "worst" else names


def _of_runs(place: Selection, choice: Choice | None) -> list[NumberedTest]:
    numbers = _runs(place.folder)
    if choice is None:
        return [NumberedTest("", number) for number in numbers]
    runs = [read_run(run_folder(place.folder, number)) for number in numbers]
    if choice == "failures":
        return [NumberedTest("", run.index) for run in runs if run.outcome == "FAIL"]
    driven = [(run, run.verdict) for run in runs if run.verdict is not None]
    order = sorted(
        driven,
        key=lambda pair: (pair[0].outcome != "FAIL", pair[1].margin, -pair[1].max_oob, pair[0].index),
    )
    return [NumberedTest("", run.index) for run, _ in order[:1]]


def near(text: str) -> Sequence[str]:
    """Suggests existing paths whose names resemble a path that does not exist."""
    path = Path(text)
    while path.parent != path and not path.parent.exists():
        path = path.parent
    try:
        rest = Path(text).parts[len(path.parts) :]
        there = [each for each in sorted(path.parent.iterdir()) if not rest or each.is_dir()]
    except OSError:
        return []
    beside = {each.stem: each.name for each in there}
    alike = get_close_matches(path.stem, beside, MOST_NEAR)
    return [str(path.parent.joinpath(beside[stem], *rest)) for stem in alike]
