"""``--junit``: writes tests as JUnit XML, which continuous integration systems read.

    PASS, VALID    a test that passed
    FAIL           <failure>: the car failed on a road that the rules allow
    INVALID        <skipped>: the road breaks a rule, so it was not driven
    ERROR          <error>: a driver or simulator failed, or no road could be designed

JUnit XML has no standard; the file has the elements that Jenkins, GitLab, GitHub, Azure and CircleCI read:
suites with counts, cases with ``name``, ``classname``, ``time`` and ``file``, and properties of suites and
cases. Source: the documentation of the common format, https://github.com/testmoapp/junitxml."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from roadgpt.campaign.folder_record import has_tests, open_record
from roadgpt.campaign.model import Cell, NumberedTest
from roadgpt.cli.result_row import Row, row_of_result
from roadgpt.errors import RoadGPTError, explained
from roadgpt.export.markup import DECLARATION, escaped
from roadgpt.run.atomic import write_lines
from roadgpt.run.folder import is_run
from roadgpt.run.model import Request

Properties = Mapping[str, str | float | int | None]
Suite = tuple[str, Properties, Callable[[], Iterable[Row]]]
"""Tests with the same description and settings: a name, the settings, and a function that returns the rows of
all tests. It is called twice: to count the tests, and to write them."""

MARKS = {"FAIL": "failure", "INVALID": "skipped", "ERROR": "error"}
COUNTED = {"FAIL": "failures", "ERROR": "errors", "INVALID": "skipped"}
LONGEST = 120  # letters of a suite's name
IN_CASE = (
    "words", "origin", "seed", "max_oob", "beyond_m", "margin_m", "length_m", "at_s_m", "side", "own_share",
    "handed_to",
)  # fmt: skip
UNKNOWN = "roads that were given"


def write_rows(path: Path, request: Request, rows: Sequence[Row]) -> None:
    """Writes result rows of a request as a JUnit file; raises RoadGPTError if it cannot be written."""
    write_junit(path, [(request.words[:LONGEST] or UNKNOWN, _common(request), lambda: rows)])


def write_folder(path: Path, folder: Path, worse: Mapping[str, str]) -> None:
    """Writes the tests of a folder of runs, a campaign or a study as a JUnit file; ``worse`` says of some, by
    names such as DIR/c01/17, in what they are worse than in a baseline."""
    is_one = has_tests(folder) or is_run(folder)
    inside = [] if is_one else [place for place in sorted(folder.glob("*/*")) if has_tests(place)]
    write_junit(path, (suite for place in inside or [folder] for suite in _of_folder(place, worse)))


def _of_folder(folder: Path, worse: Mapping[str, str]) -> Iterator[Suite]:
    with open_record(folder) as record:
        cells = record.cells()
        for cell in cells:
            name = cell.request.words[:LONGEST] or UNKNOWN
            shown = name if len(cells) == 1 else f"{cell.name}: {name}"
            of_cell = {"cell": cell.name, "generator": cell.generator, "goal": cell.goal} if cell.name else {}
            yield shown, {**_common(cell.request), **of_cell}, partial(_of_cell, folder, cell, worse)


def _of_cell(folder: Path, cell: Cell, worse: Mapping[str, str]) -> Iterator[Row]:
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
            origin = result.proposal.origin if cell.name else None
            yield replace(row, worse=worse.get(f"{folder}/{test}", ""), origin=origin)


def _common(request: Request) -> Properties:
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


def write_junit(path: Path, suites: Iterable[Suite]) -> None:
    """Writes the suites into one file, which appears only when it is complete."""
    with explained(RoadGPTError, f"cannot write {path}", "name another file with --junit"):
        write_lines(path, _document([*suites]))


def _document(suites: Sequence[Suite]) -> Iterator[str]:
    counts = [_counted(rows()) for _, _, rows in suites]
    yield f'{DECLARATION}\n<testsuites name="roadgpt"{_attributes(sum(counts, Counter[str]()))}>\n'
    for (name, properties, rows), counted in zip(suites, counts, strict=True):
        yield f'  <testsuite name="{escaped(name)}"{_attributes(counted)}>\n'
        yield from _properties(properties, "    ")
        for row in rows():
            yield from _case(row, name)
        yield "  </testsuite>\n"
    yield "</testsuites>\n"


def _outcome(row: Row) -> str:
    return "FAIL" if row.worse and row.test_outcome != "ERROR" else row.test_outcome


def _counted(rows: Iterable[Row]) -> Counter[str]:
    """Returns the number of tests by the names of attributes, and the milliseconds that they took."""
    counts: Counter[str] = Counter()
    for row in rows:
        counts.update({"tests": 1, COUNTED.get(_outcome(row), ""): 1, "ms": round(1000 * row.seconds)})
    return counts


def _attributes(counts: Counter[str]) -> str:
    numbers = "".join(f' {name}="{counts[name]}"' for name in ("tests", *COUNTED.values()))
    return f'{numbers} time="{counts["ms"] / 1000:.3f}"'


def _case(row: Row, suite: str) -> Iterator[str]:
    outcome, says = _outcome(row), row.description
    if row.worse:
        says = f"worse than in the baseline: {row.worse}; {says}"
    file = f' file="{escaped(row.file)}"' if row.file else ""
    name = escaped(row.name or row.file)
    yield f'    <testcase name="{name}" classname="{escaped(suite)}" time="{row.seconds:.3f}"{file}>\n'
    yield from _properties({name: getattr(row, name) for name in IN_CASE}, "      ")
    mark = MARKS.get(outcome)
    if mark == "skipped":
        yield f'      <skipped message="{escaped(says)}"/>\n'
    elif mark is not None:
        text = "\n".join(filter(None, (says, row.file, row.trace)))
        kind = escaped(row.cause or outcome)
        yield f'      <{mark} message="{escaped(says)}" type="{kind}">{escaped(text)}</{mark}>\n'
    yield "    </testcase>\n"


def _properties(properties: Properties, indent: str) -> Iterator[str]:
    known = {name: value for name, value in properties.items() if value not in (None, "")}
    if not known:
        return
    yield f"{indent}<properties>\n"
    for name, value in known.items():
        text = f"{value:.6g}" if isinstance(value, float) else str(value)
        yield f'{indent}  <property name="{escaped(name)}" value="{escaped(text)}"/>\n'
    yield f"{indent}</properties>\n"
