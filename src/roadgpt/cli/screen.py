"""Prints the results of roads while a command works: lines with a progress bar on a terminal, plain lines,
JSON, or nothing; and defines ``Row``, the result of one road."""

import json
import logging
import math
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import click

from roadgpt import stopping
from roadgpt.cli.streams import apart, is_coloured, progress, shown

if TYPE_CHECKING:
    from collections.abc import Iterable

    from roadgpt.brief.scene import Event
    from roadgpt.campaign.columns import ToldNumber
    from roadgpt.campaign.gate import Gate
    from roadgpt.campaign.model import Result
    from roadgpt.chat import Spent
    from roadgpt.run.model import Outcome, Request, Run
    from roadgpt.verdict import Verdict

COLOURS = {
    "PASS": "green",
    "PASS (partly outside)": "yellow",
    "PASS (mostly outside)": "bright_red",
    "VALID": "green",
    "UNAVOIDABLE": "blue",
    "NOT TESTED": "bright_black",
    "FAIL": "red",
    "INVALID": "cyan",
    "ERROR": "magenta",
}
"""Colours of outcomes on a terminal, from the best outcome to the worst."""
WIDEST = max(len(name) for name in (*COLOURS, "FAIL (out of lane)"))
UNHAPPENED = ("it never happened that", "avoided before it began")
"""Of which descriptions a line of a result tells more than the outcome."""
MOST_TOLD = len("PASS (100 % out, 10.00 m)")
IN_JSON = (
    "file", "is_valid", "validation_message", "findings", "test_outcome", "description", "max_oob",
    "beyond_m", "margin_m", "length_m", "own_share", "handed_to", "seconds",
)  # fmt: skip


def colour_of(outcome: str) -> str:
    """Returns the colour of an outcome on a terminal."""
    return COLOURS[_kind(outcome)]


def _kind(outcome: str) -> str:
    return outcome if outcome in COLOURS else outcome.split(" ")[0]


@dataclass(frozen=True)
class Row:
    """The result of one road; the outcome VALID means that the road was checked but not driven."""

    file: str
    test_outcome: "Outcome"
    description: str  # one sentence on the result: the verdict, the broken rule or the error
    is_valid: bool = True
    validation_message: str = ""
    findings: tuple[str, ...] = ()
    """One sentence for each broken rule; the first is also ``validation_message``."""
    cause: str | None = None
    """Cause of a FAIL: out of lane, fell, stuck, timeout or collision. For an ERROR: unreadable, if the file
    cannot be read."""
    max_oob: float | None = None  # largest share of the car that was outside its lane, 0 to 1
    beyond_m: float | None = None  # largest distance of the car's body beyond the lane marking, m
    margin_m: float | None = None
    length_m: float | None = None
    at_s_m: float | None = None  # station of the failure, metres along the road; None if the car did not fail
    side: str | None = None  # the side on which the car left its lane
    own_share: float | None = None
    """Share of the way, 0 to 1, that the driver drove itself; None if it never handed over."""
    handed_to: str | None = None  # who drove where the car failed, if the driver had handed over
    scenario: str = ""
    parameters: str = ""  # of the scenario, where they are not the nominal ones
    numbers: "tuple[ToldNumber, ...]" = ()  # those of the plug-ins ``columns`` that are told
    events: "tuple[Event, ...]" = ()  # what happened in a test among others, and what did not
    at_fault: bool | None = None  # whether the first collision was the car's fault; None without one
    seconds: float = 0.0
    name: str = ""  # a shorter name, which is printed instead of ``file``; if empty, ``file`` is printed
    spent: "Spent | None" = None  # tokens, seconds and cost of the language models used for the road
    words: str = ""
    seed: int | None = None  # the seed of this road
    trace: str = ""  # the traceback, if a driver or a simulator failed
    worse: str = ""  # in what the result is worse than in the baseline
    origin: str | None = None  # how a search came to the road

    @property
    def outcome(self) -> str:
        """The outcome with cause or qualifier, such as 'FAIL (out of lane)' or 'PASS (mostly outside)'."""
        if self.cause and self.test_outcome != "UNAVOIDABLE":
            other = f", {self.handed_to} drove" if self.handed_to else ""
            fault = ", not at fault" if self.cause == "collision" and self.at_fault is False else ""
            return f"{self.test_outcome} ({self.cause}{fault}{other})"
        from roadgpt.verdict import graded

        return graded(self.test_outcome, self.max_oob)

    @property
    def told(self) -> str:
        """The outcome as commands print it; of a passed drive with how far the car was outside."""
        if self.test_outcome != "PASS" or not self.max_oob:
            return self.outcome
        return f"PASS ({outside(self.max_oob, self.beyond_m)})"

    @property
    def test(self) -> str:
        """The scenario with its parameters, as ``--scenario`` takes it."""
        return f"{self.scenario} {self.parameters}".rstrip()

    @property
    def told_numbers(self) -> dict[str, str]:
        """In words, the numbers of each plug-in ``columns``, such as how near the car came to others."""
        parts = dict.fromkeys(each.part for each in self.numbers if each.text)
        return {
            part: ", ".join(each.text for each in self.numbers if each.part == part and each.text)
            for part in parts
        }

    def to_json(self) -> str:
        """Returns the row as one line of JSON."""
        told = {name: _rounded(getattr(self, name)) for name in IN_JSON}
        if self.spent is not None:
            told |= {"tokens": self.spent.usage.total, "model_seconds": _rounded(self.spent.seconds)}
            told["cost_usd"] = self.spent.cost
        told |= {"events": [vars(each) for each in self.events]} if self.events else {}
        if self.at_fault is not None:
            told["at_fault"] = self.at_fault
        told |= {name: found for name in ("scenario", "parameters") if (found := getattr(self, name))}
        told |= {each.key: _rounded(each.value) for each in self.numbers}
        if self.worse:
            told["worse"] = self.worse
        return json.dumps(told)

    def to_line(self) -> str:
        """Returns a line with outcome, length, margin, file, and the sentence on a rule or an error."""
        length = "" if self.length_m is None else f"{self.length_m:6.1f} m"
        margin = "" if self.margin_m is None else f"margin {metres(self.margin_m)}"
        line = f"{self.told:<{MOST_TOLD}} {length:>9}  {margin:<15}  {self.name or self.file}"
        line += "".join(f"  {each}" for each in (self.test, *self.told_numbers.values()) if each)
        if self.own_share is not None:
            line += f"  drove {100 * self.own_share:.0f} % itself"
        if self.worse:
            line += f"  worse: {self.worse}"
        is_told = self.test_outcome in ("NOT TESTED", "INVALID", "ERROR") or self.at_fault is not None
        if is_told or any(each in self.description for each in UNHAPPENED):
            return f"{line}  {self.description.removeprefix(f'{self.file}: ')}"
        if not self.findings:
            return line
        rest = len(self.findings) - 1  # the road was driven in spite of them
        more = f" and {rest} more finding{'s' * (rest > 1)}" if rest else ""
        return f"{line}  finding: {self.findings[0]}{more}"


def driver_and_oracle(drivers: Sequence[str], oracle: str) -> str:
    """Returns the line of text that says who drove, and when a test fails."""
    from roadgpt.road.world import oracle_in_words

    return f"driver {' and '.join(dict.fromkeys(drivers))}, oracle {oracle_in_words(oracle)}"


def outside(share: float | None, beyond: float | None) -> str:
    """Returns how far a car was outside, such as '62 % out, 1.13 m' or 'inside'; empty without a drive."""
    if not share:
        return "" if share is None else "inside"
    from roadgpt.verdict import percent

    return f"{percent(share)} out" + ("" if beyond is None else f", {beyond:.2f} m")


def metres(margin: float) -> str:
    """Formats a margin to the millimetre, because the margins that decide a verdict are small."""
    told = f"{margin:+.3f} m"
    return "below 0 m" if told.startswith("-0.000") else told


def spending(spent: "Spent") -> str:
    """Returns a text with the number of answers from language models, and their tokens, seconds and cost."""
    money = "price unknown" if spent.cost is None else f"{spent.cost:.4f} USD"
    answers = f"{spent.calls:,} answer{'s' * (spent.calls != 1)}"
    return f"{answers}, {spent.usage.total:,} tokens, {spent.seconds:.1f} s, {money}"


def _rounded(value: Any) -> Any:
    # JSON has no infinite numbers
    if not isinstance(value, float):
        return value
    return round(value, 4) if math.isfinite(value) else None


def summary(rows: Sequence[Row]) -> list[tuple[str, int, str, str, str]]:
    """Returns for each outcome its name, number and share of roads, least margin, and how far outside."""
    table, ranks = [], [*COLOURS]
    for outcome in sorted({row.outcome for row in rows}, key=lambda name: (ranks.index(_kind(name)), name)):
        own = [row for row in rows if row.outcome == outcome]
        margins = [row.margin_m for row in own if row.margin_m is not None]
        shares = [row.max_oob for row in own if row.max_oob is not None]
        farthest = [row.beyond_m for row in own if row.beyond_m is not None]
        most = outside(max(shares, default=None), max(farthest, default=None)) or "-"
        share, least = f"{100 * len(own) / len(rows):.0f} %", metres(min(margins)) if margins else "-"
        table.append((outcome, len(own), share, least, most))
    return table


def row_of(run: "Run | Result", file: str = "", **more: Any) -> Row:
    """Returns the row of a Run, whose road file is ``file``, or of a stored result; ``more`` are further
    fields."""
    from roadgpt.campaign.columns import features_in, told_of
    from roadgpt.run.model import Run

    found: Verdict | Result | None = None
    features = features_in(run, told_alone=True) if isinstance(run, Run) else run.features
    more["numbers"] = told_of(features)
    more["at_fault"] = bool(features["AT_FAULT"]) if "AT_FAULT" in features else None
    if isinstance(run, Run):
        found, is_valid, length = run.verdict, run.is_valid, run.length if run.road else None
        findings = tuple(finding.sentence for finding in run.findings)
        more |= {"validation_message": run.validation_message, "findings": findings, "spent": run.spent}
        test = run.request.setup.scenario
        more["events"] = (run.verdict and run.verdict.events) or ()
        more |= {"words": run.words, "seed": run.seed, "trace": run.trace}
        # as tables of tests hold them
        more["seconds"] = round(run.seconds.design, 4) + round(run.seconds.drive, 4)
    else:
        found, is_valid, length = run, run.outcome not in ("INVALID", "ERROR"), run.length or None
        test = more.pop("test", "")
    if found is not None:
        more |= {"max_oob": found.max_oob, "beyond_m": found.beyond, "margin_m": found.margin}
        more |= {"own_share": found.own_share, "handed_to": found.handed_to}
        more |= {"cause": found.cause, "at_s_m": found.at_s, "side": found.side}
        if found.cause == "collision":
            more["margin_m"] = None  # how far the car was from leaving its lane is nothing to go by
    more["scenario"], _, more["parameters"] = test.partition(" ")
    return Row(file, run.outcome, run.description, is_valid, length_m=length, **more)


def unreadable(file: str, error: Exception) -> Row:
    """Returns the row of a file from which no road could be read."""
    return Row(file, "ERROR", str(error), is_valid=False, validation_message=str(error), cause="unreadable")


class Screen:
    """Prints the result of each road when it is finished, and at the end a table of outcomes. If the rows are
    JSON, other text goes to standard error. A total of 0 means that the number of roads is unknown."""

    def __init__(self, total: int, as_json: bool = False, quiet: bool = False, verbose: bool = False) -> None:
        self.total, self.as_json, self.quiet, self.verbose = total, as_json, quiet, verbose
        self.request: Request | None = None
        """That of the roads, if there is one; the table of outcomes names its driver and oracle."""
        self.gate: Gate | None = None
        self.rows: list[Row] = []
        if quiet:
            logging.getLogger("roadgpt").setLevel(logging.ERROR)
        self._begun = time.perf_counter()
        self._progress = progress("roads", total or None, quiet, has_lines=False)

    def __enter__(self) -> Self:
        self._begun = time.perf_counter()
        self._tell = self._progress.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.__exit__(None, None, None)
        # a library may raise another error in place of the KeyboardInterrupt
        if isinstance(error, KeyboardInterrupt) or (error is not None and stopping.status()):
            finished = f"{self._number()} roads are finished and complete"
            _show(f"roadgpt: stopped; {finished}", on_stderr=True)

    @property
    def seconds(self) -> float:
        """Seconds since the work began."""
        return time.perf_counter() - self._begun

    def say(self, sentence: str) -> None:
        """Prints a sentence unless output is quiet."""
        if not self.quiet:
            _show(sentence, on_stderr=self.as_json)

    def detail(self, sentence: str) -> None:
        """Prints a sentence if output is verbose."""
        if self.verbose:
            self.say(sentence)

    def spent(self, spent: "Spent") -> None:
        """Prints what language models have cost, if they were asked."""
        if spent.calls:
            self.say(f"language model: {spending(spent)}")

    def row(self, row: Row, run: "Run | None" = None) -> None:
        """Prints the result of a finished road; the gate receives its Run, if there is one."""
        if self.gate:
            row = replace(row, worse=self.gate.add(row.name or row.file, run))
        self.rows.append(row)
        if self.as_json:
            _show(row.to_json())
        elif not self.quiet:
            count = len(self.rows)
            done = f"{count:>{len(str(self.total))}}/{self.total}" if self.total else f"{count:>4}"
            line, head = row.to_line(), len(row.told)
            told = click.style(line[:head], fg=colour_of(row.outcome), bold=True)
            _show(f"{done}  {told}{line[head:]}")
        self._tell(len(self.rows), rate=f"{self._rate():.1f} roads/s")

    def runs(self, runs: "Iterable[Run]", folder: Path) -> None:
        """Prints the result of each run of a folder as soon as it is finished. What is printed while it is
        made, for example by a user's driver, goes to standard error."""
        from roadgpt.run.execution import test_name

        with self:
            for run in apart(runs):
                name = test_name(run.index)
                self.row(row_of(run, str(folder / name), name=name), run)
                self.detail(f"  {run.description}")

    def close(self) -> None:
        """Prints what the gate says, and the table of outcomes."""
        if self.gate and self.gate.remark:
            self.say(self.gate.remark)
        if self.quiet or self.as_json or not self.rows:
            return
        _show("")
        if self.request is not None and any(row.max_oob is not None for row in self.rows):
            _show(driver_and_oracle([self.request.setup.driver], self.request.world.limits.oracle))
        _show(f"{'outcome':<{WIDEST}} {'roads':>7} {'share':>7}  {'least margin':>12}  {'most outside':>18}")
        for outcome, count, share, least, most in summary(self.rows):
            told = click.style(f"{outcome:<{WIDEST}}", fg=colour_of(outcome))
            _show(f"{told} {count:>7} {share:>7}  {least:>12}  {most:>18}")
        despite = sum(bool(row.findings) and row.max_oob is not None for row in self.rows)
        if despite:
            more = "" if self.verbose else " (-v tells all of them)"
            _show(f"driven despite findings of the rules: {despite}{more}")
        _show(f"{self._number()} roads in {self.seconds:.1f} s ({self._rate():.1f} roads/s)")

    def _rate(self) -> float:
        return len(self.rows) / max(self.seconds, 1e-9)

    def _number(self) -> str:
        return f"{len(self.rows)} of {self.total}" if self.total else f"{len(self.rows)}"


def _show(line: str, on_stderr: bool = False) -> None:
    """Prints a line, in colour only on a terminal; click.echo would write into the progress bar."""
    stream = sys.stderr if on_stderr else sys.stdout
    line = shown(line)
    print(line if stream.isatty() and is_coloured() else click.unstyle(line), file=stream, flush=True)
