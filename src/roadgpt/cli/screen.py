"""Prints the output of a command while it works: lines with a progress bar on a terminal, plain lines, JSON,
or nothing."""

import logging
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

import click

from roadgpt import stopping
from roadgpt.cli.result_row import WIDEST, Row, colour_of, driver_and_oracle, row_of, summary
from roadgpt.cli.streams import apart, is_coloured, progress

if TYPE_CHECKING:
    from collections.abc import Iterable

    from roadgpt.campaign.gate import Gate
    from roadgpt.run import Request, Run


class Screen:
    """Prints the result of each road when it is finished, and at the end a table of outcomes. If the rows are
    JSON, other text goes to standard error. A total of 0 means that the number of roads is unknown."""

    def __init__(self, total: int, as_json: bool = False, quiet: bool = False, verbose: bool = False) -> None:
        self.total, self.as_json, self.quiet, self.verbose = total, as_json, quiet, verbose
        self.request: Request | None = None
        """That of the roads, if there is one; the table of outcomes names its driver and oracle."""
        self.junit: Path | None = None
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
                self.row(row_of(run, str(folder / name), name), run)
                self.detail(f"  {run.description}")

    def close(self) -> None:
        """Prints the table of outcomes, and writes the JUnit file if one was requested."""
        if self.junit is not None and self.request is not None:
            from roadgpt.cli.junit import write_rows

            write_rows(self.junit, self.request, self.rows)
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
        despite = sum(bool(row.findings) for row in self.rows if row.test_outcome in ("PASS", "FAIL"))
        if despite:
            _show(f"driven despite findings of the rules: {despite} (-v tells all of them)")
        _show(f"{self._number()} roads in {self.seconds:.1f} s ({self._rate():.1f} roads/s)")

    def _rate(self) -> float:
        return len(self.rows) / max(self.seconds, 1e-9)

    def _number(self) -> str:
        return f"{len(self.rows)} of {self.total}" if self.total else f"{len(self.rows)}"


def _show(line: str, on_stderr: bool = False) -> None:
    """Prints a line, in colour only on a terminal; click.echo would write into the progress bar."""
    stream = sys.stderr if on_stderr else sys.stdout
    print(line if stream.isatty() and is_coloured() else click.unstyle(line), file=stream, flush=True)
