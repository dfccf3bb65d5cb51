"""One test again: its drive as it was kept, or the whole Run anew, from its stored design and its seed."""

from dataclasses import replace
from pathlib import Path

from roadgpt.campaign.model import Proposal, Result
from roadgpt.campaign.record import Record
from roadgpt.campaign.traces import TRACES, read_traces
from roadgpt.campaign.worker import run_of, seed_of_driver
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.run import Run


def read_trace(folder: Path, cell: str, number: int) -> Drive:
    """The drive of a test as the campaign kept it: every column at 50 Hz, to half a millimetre.

    Raises:
        UsageError: there is no campaign or no such test, or nobody drove it.
    """
    with Record.opened(folder) as record:
        record.result(cell, number)
        name = record.trace_file(cell, number)
    if name is None:
        raise UsageError(f"test {number} of {cell} in {folder} was not driven")
    return read_traces(folder / TRACES / name, cell, number)


def run_again(folder: Path, cell: str, number: int) -> tuple[Run, Result]:
    """A test of a campaign, checked and driven again; and what came of it then.

    The same design, seed and setup give the same Run, bit for bit, on one machine.

    Raises:
        UsageError: there is no campaign or no such test, or there is no road in it.
    """
    with Record.opened(folder) as record:
        found, result = record.cell(cell), record.result(cell, number)
    if result.design is None:
        raise UsageError(f"test {number} of {cell} in {folder} has no road: {result.description}")
    seed = seed_of_driver(number, result.proposal)
    run = run_of(found, number, Proposal(result.design, seed, result.proposal.origin))
    return replace(run, request=found.request), result


def is_same(run: Run, result: Result) -> bool:
    """Did a test come to the very same end again?"""
    return run.outcome == result.outcome and (run.verdict and run.verdict.margin) == result.margin
