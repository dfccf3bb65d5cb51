"""Makes a Run from a test's road points: applies the competition's validator, then drives the road."""

from dataclasses import replace
from typing import Any

import numpy as np

from roadgpt.check import Finding, sbft_verdict
from roadgpt.check.sbft import TOO_FEW
from roadgpt.errors import PartError, RoadGPTError
from roadgpt.geometry.curve import Array
from roadgpt.road import Road
from roadgpt.run import Request, Run, Seconds, prove
from roadgpt.run.execution import ExecutionRecord, records_of

SUCCESS = "Successful test"
WRONG_TYPE = "Wrong type"
HEIGHT = -28.0  # m, of the competition's flat level


def run_test(points: Any, index: int, request: Request, generating: float, is_test: bool = True) -> Run:
    """Validates and drives one test, and returns its Run.

    Args:
        points: control points ``(n, 2)`` in metres; any value if ``is_test`` is False.
        index: number of the test.
        request: world, setup and seed; the rules must be the competition's.
        generating: seconds that the generator took to make the test.
        is_test: False if the generator submitted something that is not a test; the Run is then invalid and
            has no road.

    Raises:
        PartError: a plug-in is not installed.
    """
    if not is_test:
        return _invalid(WRONG_TYPE, None, index, request, generating)
    table = np.asarray(points, float).reshape(-1, 2)
    if len(table) < 2:
        return _invalid(TOO_FEW, None, index, request, generating)
    try:
        road = Road.through(table)
        is_valid, message = sbft_verdict(table, request.world.map_size)
    except RoadGPTError as error:
        return _invalid(str(error), None, index, request, generating)
    if not is_valid:
        return _invalid(message, road, index, request, generating)
    try:
        run = prove(road, request.seed, request.world, request.setup, index)
    except PartError:
        raise
    except Exception as error:  # an error costs only the road on which it happens
        said = str(error) if isinstance(error, RoadGPTError) else f"the test failed: {error!r}"
        run = Run(request, index, request.seed, outcome="ERROR", description=said, road=road)
    return replace(run, request=request, seconds=Seconds(generating, run.seconds.drive))


def _invalid(message: str, road: Road | None, index: int, request: Request, generating: float) -> Run:
    finding = (Finding("sbft", message),)
    seconds = Seconds(generating)
    return Run(request, index, request.seed, "INVALID", message, road=road, findings=finding, seconds=seconds)


def sbft_description(run: Run) -> str:
    """Returns the outcome of a Run in the competition's wording, which mentions the drive if the drive
    failed."""
    if run.verdict is None:
        return run.description
    said = run.verdict.sbft_description
    return said if said == SUCCESS else f"{said} {run.request.setup.simulator}/{run.index:04d}"


def records_at_their_height(run: Run) -> list[ExecutionRecord]:
    """Returns the execution data with heights shifted to the competition's level, whose ground is at -28
    m."""
    if run.road is None or run.drive is None:
        return []
    return [_lowered(record) for record in records_of(run.road, run.drive, run.world)]


def _lowered(record: ExecutionRecord) -> ExecutionRecord:
    x, y, z = record.pos
    return record._replace(pos=[x, y, round(z + HEIGHT, 4)])


def interpolated_points(run: Run) -> Array:
    """Returns the competition's interpolated points ``(n, 2)``; an empty array for a test without a road."""
    from roadgpt.geometry import interpolate

    return np.empty((0, 2)) if run.road is None else interpolate(run.road.control_points())
