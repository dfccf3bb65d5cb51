"""Makes a Run from a test's road points: applies the competition's validator, then drives the road."""

from dataclasses import replace
from typing import Any

import numpy as np

from roadgpt.check import Finding, sbft_verdict
from roadgpt.check.sbft import TOO_FEW
from roadgpt.errors import PartError, RoadGPTError
from roadgpt.road import Road
from roadgpt.run import Request, Run, Seconds, prove

WRONG_TYPE = "Wrong type"


def run_test(points: Any, index: int, request: Request, generating: float, is_test: bool = True) -> Run:
    """Validates and drives one test, and returns its Run.

    Args:
        points: control points ``(n, 2)`` in metres; ignored if ``is_test`` is False.
        index: number of the test.
        request: the world, setup and seed of the test; the rules in the setup must be the competition's.
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
        is_valid, message = sbft_verdict(table, request.world.site.map_size)
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
