"""Finds the tests that a command's argument selects in a folder: all tests, those of one cell, or one test.

hard            all tests of the campaign in the folder ``hard``, or all runs of a folder of runs
hard/c01        the tests of a cell
hard/c01/17     one test; hard/17 if there is only one cell, or if ``hard`` is a folder of runs"""

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from roadgpt import plugins
from roadgpt.campaign.folder_record import has_tests, kept_run, open_record
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.record import Record
from roadgpt.errors import UsageError
from roadgpt.run import Run

LONGEST = 255  # bytes of one name, in every file system of today
DIGITS = 18  # of a number that a store can look for
MOST_NEAR = 3  # names that are offered for a wrong one


@dataclass(frozen=True)
class Selection:
    """The tests that the text of a command's argument selects."""

    said: str
    folder: Path
    cell: str = ""  # name of the cell; empty: all cells
    number: int | None = None  # number of the test; None: all tests

    def of(self, name: NumberedTest) -> "Selection":
        """Returns the Selection of one test in the same folder, as 'hard/c01/17' selects it."""
        return Selection(f"{self.folder}/{name}", self.folder, name.cell, name.number)

    @property
    def stem(self) -> str:
        """The beginning of the names of files made from the selected test, such as 'hard-c01-0017'."""
        parts = (self.folder.resolve().name, self.cell, f"{self.number or 0:04d}")
        return "-".join(part for part in parts if part)

    def run(self) -> Run:
        """Returns the stored Run of the selected test; no road is driven."""
        assert self.number is not None
        return kept_run(self.folder, self.cell, self.number)


def selection_of(text: str) -> Selection | None:
    """Returns what the text of a command's argument selects; None if it names a single run or a road file."""
    path = Path(text)
    if any(len(part.encode()) > LONGEST for part in path.parts):
        raise UsageError(f"there is no test or file called {text[:100]}...: the name is too long")
    if path.exists():
        return Selection(text, path) if has_tests(path) else None
    last, number = path.name, _number(path.name)
    above, two_above = path.parent, path.parent.parent
    if has_tests(above):
        with open_record(above) as record:
            if number is not None:
                record.check_ended(cell := _only_cell(record, number), number)
                return Selection(text, above, cell, number)
            if cell := _cell(record, last):
                return Selection(text, above, cell)
    if number is not None and above.name and has_tests(two_above):
        with open_record(two_above) as record:
            if cell := _cell(record, above.name):
                record.check_ended(cell, number)
                return Selection(text, two_above, cell, number)
    return None


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
    """Returns the name if there is such a cell; an empty text in a folder of runs, which has no cells."""
    names = record.names()
    if name in names or not any(names):
        return name if name in names else ""
    near = get_close_matches(name, names, MOST_NEAR, 0.3) or names[:MOST_NEAR]
    raise UsageError(
        f"there is no cell '{name}' in {record.folder}; "
        f"{'its cells are' if len(names) <= MOST_NEAR else 'it has'} {', '.join(near)}"
        + (f" and {len(names) - len(near)} more" if len(names) > len(near) else "")
    )


def chosen(place: Selection, choice: str | None) -> list[Selection]:
    """Returns a Selection of each of the selected tests that a choice selects, in order: "failures", all
    failures; "worst", the failure with the smallest margin or, if no test failed, the passed test with the
    smallest margin; or those that a plug-in ``analyses`` of this name chooses. Without a choice, returns
    those that can be read."""
    if place.number is not None:
        return [place]
    if choice in plugins.names("analyses"):
        return [place.of(name) for name in plugins.find("analyses", choice).chosen(place.folder, place.cell)]
    with open_record(place.folder) as record:
        names = record.tests(place.cell, choice)
    return [place.of(name) for name in (names[:1] if choice == "worst" else names)]


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
