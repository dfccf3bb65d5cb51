"""Writes tests as JUnit XML, which continuous integration systems read.

    PASS, VALID    a test that passed
    FAIL           <failure>: the car failed on a road that the rules allow
    INVALID        <skipped>: the road breaks a rule, so it was not driven
    ERROR          <error>: a driver or simulator failed, or no road could be designed

JUnit XML has no standard; the file has the elements that Jenkins, GitLab, GitHub, Azure and CircleCI read:
suites with counts, cases with ``name``, ``classname``, ``time`` and ``file``, and properties of suites and
cases. Source: the documentation of the common format, https://github.com/testmoapp/junitxml.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from roadgpt.errors import RoadGPTError, explained
from roadgpt.export.markup import DECLARATION, escaped
from roadgpt.run.atomic import write_lines

Properties = Mapping[str, str | float | int | None]

MARKS = {"FAIL": "failure", "INVALID": "skipped", "ERROR": "error"}
COUNTED = {"FAIL": "failures", "ERROR": "errors", "INVALID": "skipped"}


@dataclass(frozen=True)
class Case:
    """One test: a road and its outcome."""

    name: str
    outcome: str
    says: str
    """A sentence that describes the outcome."""
    kind: str = ""
    """Kind of failure or error, such as 'out of lane' or 'fell'."""
    seconds: float = 0.0
    """Wall-clock time of the test in seconds."""
    file: str = ""
    trace: str = ""
    properties: Properties = field(default_factory=dict)


@dataclass(frozen=True)
class Suite:
    """A group of tests with the same description and settings."""

    name: str
    properties: Properties
    cases: Callable[[], Iterable[Case]]
    """A function that returns all cases. It is called twice: to count the cases, and to write them."""


def write_junit(path: Path, suites: Iterable[Suite], name: str = "roadgpt") -> Path:
    """Writes the suites into one file and returns its path; the file appears only when it is complete.

    Raises:
        RoadGPTError: the file cannot be written.
    """
    listed = [(suite, _counted(suite)) for suite in suites]
    with explained(RoadGPTError, f"cannot write {path}", "name another file with --junit"):
        write_lines(path, _document(listed, name))
    return path


def _document(listed: Sequence[tuple[Suite, Counter[str]]], name: str) -> Iterator[str]:
    every = sum((counts for _, counts in listed), Counter[str]())
    yield f'{DECLARATION}\n<testsuites name="{escaped(name)}"{_attributes(every)}>\n'
    for suite, counts in listed:
        yield from _suite(suite, counts)
    yield "</testsuites>\n"


def _counted(suite: Suite) -> Counter[str]:
    """Returns the number of cases by the names of attributes, and the milliseconds that they took."""
    counts: Counter[str] = Counter()
    for case in suite.cases():
        counts.update({"tests": 1, COUNTED.get(case.outcome, ""): 1, "ms": round(1000 * case.seconds)})
    return counts


def _attributes(counts: Counter[str]) -> str:
    numbers = "".join(f' {name}="{counts[name]}"' for name in ("tests", *COUNTED.values()))
    return f'{numbers} time="{counts["ms"] / 1000:.3f}"'


def _suite(suite: Suite, counts: Counter[str]) -> Iterator[str]:
    yield f'  <testsuite name="{escaped(suite.name)}"{_attributes(counts)}>\n'
    yield from _properties(suite.properties, "    ")
    for case in suite.cases():
        yield from _case(case, suite.name)
    yield "  </testsuite>\n"


def _case(case: Case, suite: str) -> Iterator[str]:
    file = f' file="{escaped(case.file)}"' if case.file else ""
    head = f'name="{escaped(case.name)}" classname="{escaped(suite)}" time="{case.seconds:.3f}"{file}'
    yield f"    <testcase {head}>\n"
    yield from _properties(case.properties, "      ")
    mark = MARKS.get(case.outcome)
    if mark == "skipped":
        yield f'      <skipped message="{escaped(case.says)}"/>\n'
    elif mark is not None:
        text = "\n".join(filter(None, (case.says, case.file, case.trace)))
        kind = escaped(case.kind or case.outcome)
        yield f'      <{mark} message="{escaped(case.says)}" type="{kind}">{escaped(text)}</{mark}>\n'
    yield "    </testcase>\n"


def _properties(properties: Properties, indent: str) -> Iterator[str]:
    known = {name: value for name, value in properties.items() if value is not None}
    if not known:
        return
    yield f"{indent}<properties>\n"
    for name, value in known.items():
        text = f"{value:.6g}" if isinstance(value, float) else str(value)
        yield f'{indent}  <property name="{escaped(name)}" value="{escaped(text)}"/>\n'
    yield f"{indent}</properties>\n"
