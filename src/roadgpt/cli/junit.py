"""``--junit``: writes tests as JUnit XML, which continuous integration systems read.

    PASS, VALID    a test that passed
    FAIL           <failure>: the car failed on a road that the rules allow
    INVALID        <skipped>: the road breaks a rule, so it was not driven, or its scene cannot happen
    NOT TESTED     <skipped>: what the scene prescribes did not happen, for the driver's speed
    UNAVOIDABLE    <skipped>: a collision that no careful driver could have avoided
    ERROR          <error>: a driver or simulator failed, or no road could be designed

JUnit XML has no standard; the file has the elements that Jenkins, GitLab, GitHub, Azure and CircleCI read:
suites with counts, cases with ``name``, ``classname``, ``time`` and ``file``, and properties of suites and
cases. Source: the documentation of the common format, https://github.com/testmoapp/junitxml."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from roadgpt.campaign.folder_record import has_tests, open_record
from roadgpt.campaign.model import GIVEN, NO_WORDS, NumberedTest
from roadgpt.cli.screen import Row, row_of
from roadgpt.errors import RoadGPTError, explained
from roadgpt.export.markup import XmlElement, escaped
from roadgpt.run.atomic import write_whole
from roadgpt.run.execution import test_name
from roadgpt.run.folder import is_run
from roadgpt.run.model import Request

Properties = Mapping[str, str | float | int | None]
Suite = tuple[str, Properties, Sequence[Row]]
"""Tests with the same description and settings: a name, the settings, and the rows of all tests."""

MARKS = {"FAIL": "failure", "ERROR": "error"}
SKIPPED = ("INVALID", "NOT TESTED", "UNAVOIDABLE")
COUNTED = {"FAIL": "failures", "ERROR": "errors", **dict.fromkeys(SKIPPED, "skipped")}
LONGEST = 120  # letters of a suite's name
OF_TEST = ("words", "origin", "scenario", "parameters")
OF_DRIVE = ("seed", "max_oob", "beyond_m", "margin_m", "length_m", "at_s_m", "side", "own_share", "handed_to")
"""The properties of a case before and after the numbers of the plug-ins ``columns``."""
TIMES = (
    "SELECT number, coalesce(design_s, 0) + coalesce(drive_s, 0) FROM tests "
    "WHERE cell = ? AND outcome IS NOT NULL"
)
ERRORS = "SELECT number, error FROM details WHERE cell = ? AND error IS NOT NULL"


def suites_of(folder: Path, worse: Mapping[str, str]) -> Iterator[Suite]:
    """Yields the tests of a folder of runs, a campaign or a study; ``worse`` says of some, by names such as
    DIR/c01/17, in what they are worse than in a baseline."""
    is_one = has_tests(folder) or is_run(folder)
    inside = [] if is_one else [place for place in sorted(folder.glob("*/*")) if has_tests(place)]
    for place in inside or [folder]:
        with open_record(place) as record:
            cells = record.cells()
            for cell in cells:
                rows = list[Row]()
                times = dict(record.query(TIMES, (cell.name,)))
                errors = dict(record.query(ERRORS, (cell.name,)))
                for result in record.results(cell.name):
                    number = result.number
                    file = str(place / test_name(number)) if record.keeps_runs else ""
                    test = str(NumberedTest(cell.name, number))
                    own = {"words": cell.request.words, "seed": record.seed(result)}
                    own |= {"seconds": times.get(number, 0.0), "trace": str(errors.get(number, ""))}
                    own |= {"origin": result.proposal.origin if cell.name else None}
                    own |= {"test": cell.scenario_of(result.proposal.origin)}
                    own |= {"name": Path(file).name or test, "worse": worse.get(f"{place}/{test}", "")}
                    rows.append(row_of(result, file, **own))
                name, properties, _ = suite_of(cell.request, rows, cell.generator)
                if cell.name:
                    of_cell = {"cell": cell.name, "generator": cell.generator, "goal": cell.goal}
                    properties = {**properties, **of_cell}
                yield name if len(cells) == 1 else f"{cell.name}: {name}", properties, rows


def suite_of(request: Request, rows: Sequence[Row], generator: str = GIVEN) -> Suite:
    """Returns the tests of one request, with its settings."""
    setup, world = request.setup, request.world
    properties: Properties = {
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
    return request.words[:LONGEST] or NO_WORDS.get(generator, "any road"), properties, rows


def write_junit(path: Path, suites: Sequence[Suite]) -> None:
    """Writes the suites into one file, which appears only when it is complete."""
    counts = [_counted(rows) for _, _, rows in suites]
    root = XmlElement("testsuites", {"name": "roadgpt", **_attributes(sum(counts, Counter[str]()))})
    for (name, properties, rows), counted in zip(suites, counts, strict=True):
        suite = root.add("testsuite", {"name": name, **_attributes(counted)})
        _add_properties(suite, properties)
        for row in rows:
            _add_case(suite, row, name)
    with explained(RoadGPTError, f"cannot write {path}", "name another file with --junit"):
        write_whole(path, root.to_text())


def _outcome(row: Row) -> str:
    return "FAIL" if row.worse and row.test_outcome != "ERROR" else row.test_outcome


def _counted(rows: Sequence[Row]) -> Counter[str]:
    """Returns the number of tests by the names of attributes, and the milliseconds that they took."""
    counts: Counter[str] = Counter()
    for row in rows:
        counts.update({"tests": 1, COUNTED.get(_outcome(row), ""): 1, "ms": round(1000 * row.seconds)})
    return counts


def _attributes(counts: Counter[str]) -> dict[str, str]:
    numbers = {name: str(counts[name]) for name in ("tests", *COUNTED.values())}
    return {**numbers, "time": f"{counts['ms'] / 1000:.3f}"}


def _add_case(suite: XmlElement, row: Row, classname: str) -> None:
    outcome, says = _outcome(row), row.description
    if row.worse:
        says = f"worse than in the baseline: {row.worse}; {says}"
    case = {"name": row.name or row.file, "classname": classname, "time": f"{row.seconds:.3f}"}
    element = suite.add("testcase", {**case, **({"file": row.file} if row.file else {})})
    numbers = {each.key: each.value for each in row.numbers}
    of_test, of_drive = ({name: getattr(row, name) for name in names} for names in (OF_TEST, OF_DRIVE))
    _add_properties(element, {**of_test, **numbers, **of_drive})
    if COUNTED.get(outcome) == "skipped":
        element.add("skipped", {"message": says})
    elif outcome in MARKS:
        text = "\n".join(filter(None, (says, row.file, row.trace)))
        element.add(MARKS[outcome], {"message": says, "type": row.cause or outcome}, escaped(text))


def _add_properties(element: XmlElement, properties: Properties) -> None:
    known = {name: value for name, value in properties.items() if value not in (None, "")}
    if known:
        below = element.add("properties")
        for name, value in known.items():
            text = f"{value:.6g}" if isinstance(value, float) else str(value)
            below.add("property", {"name": name, "value": text})
