"""Answers what other interpreters ask of RoadGPT, one JSON value per line: sums for generators, and roads.

Started as ``python -m roadgpt.sbft.answers`` by ``names/roadgpt_client.py``, which is the other end. Where
RoadGPT is installed in the generator's own interpreter, ``answer`` is called there, and nothing is started.
"""

import os
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from roadgpt.check import sbft_verdict
from roadgpt.check.ribbon import quads_of
from roadgpt.check.sbft import keeps_clear
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.geometry import interpolate
from roadgpt.sbft.line import Message, received, send

LONGEST = 50_000.0  # m of control polyline; the spline through more would fill the memory

Points = list[list[float]]


def answer(asked: Message) -> Message:
    """The answer under ``answer``; or a sentence under ``error``."""
    values = dict(asked)
    op = values.pop("op", None)
    if op not in OPS:
        return {"error": f"RoadGPT knows no '{op}'; are client and RoadGPT of one version?"}
    try:
        return {"answer": OPS[op](**values)}
    except RoadGPTError as error:
        return {"error": str(error)}
    except Exception as error:  # whoever asked is told, and may ask again
        return {"error": f"RoadGPT cannot answer '{op}': {error!r}"}


def hello() -> str:
    """The version."""
    from roadgpt import __version__

    return __version__


def nodes(points: Any) -> Points:
    """The competition's interpolated points ``(m, 2)`` of control points ``(n, 2)``, metres.

    Raises:
        UsageError: no spline goes through them.
    """
    table = np.asarray(points, float)[:, :2]
    if not np.isfinite(table).all():
        raise UsageError("a number of the road points is not finite; give every point as two plain numbers")
    if np.hypot(*np.diff(table, axis=0).T).sum() > LONGEST:
        raise UsageError(f"a road of more than {LONGEST / 1000:g} km; bring a shorter one")
    return list(interpolate(table).tolist())


def verdict(points: Any, map_size: float) -> tuple[bool, str]:
    """What the competition's validator says of control points."""
    return sbft_verdict(np.asarray(points, float), map_size)


def clear(left: Any, right: Any) -> bool:
    """Does a road between edge points ``(n, 2)`` keep clear of itself?"""
    return keeps_clear(quads_of(np.asarray(left, float), np.asarray(right, float)))


def distance(one: Any, other: Any) -> float:
    """The competition's edit distance of two rows of points ``(n, 2)``."""
    from roadgpt.run.sparseness import distances, steps_of

    return float(distances(steps_of(one), [steps_of(other)])[0])


def left_lane(points: Any, records: Any, before: float, after: float) -> Message | None:
    """Where a car left its lane, as the competition's analysis finds it."""
    from roadgpt.run.execution import ExecutionRecord
    from roadgpt.run.sparseness import departure

    found = departure(points, [ExecutionRecord(*record) for record in records], before, after)
    if found is None:
        return None
    parts = {"before": found.before, "after": found.after}
    listed = {name: None if part is None else part.tolist() for name, part in parts.items()}
    return {"side": found.side, "first": found.first, "number": found.number, **listed}


def spread(segments: Any) -> tuple[float, float]:
    """Mean and deviation of how much failures differ: segments ``(n, 2)`` in the order of their tests."""
    from roadgpt.run.sparseness import Sparseness

    found = Sparseness()
    for number, points in enumerate(segments):
        found.add(number, points)
    return found.mean, found.deviation


_ROADS: list[Iterator[Any]] = []


def begin(map_size: int | None = None, **asked: Any) -> None:
    """Bring roads of a description from now on; the environment is heeded before what is asked.

    Raises:
        UsageError: a setting cannot be.
    """
    from roadgpt.sbft.generator import RoadGPTTestGenerator

    if unknown := set(asked) - {"description", "seed", "designer", "reader"}:
        raise UsageError(
            f"RoadGPT knows no {', '.join(sorted(unknown))}; are client and RoadGPT of one version?"
        )
    made = type("Asked", (RoadGPTTestGenerator,), asked)
    _ROADS[:] = [made(None, map_size).roads()]


def another() -> Points:
    """Control points of the next road.

    Raises:
        UsageError: none was begun.
        BriefError, DesignError: as RoadGPTTestGenerator says.
    """
    if not _ROADS:
        raise UsageError("no description was given; begin with one")
    road = next(_ROADS[0], None)
    if road is None:
        raise UsageError("there are no more roads of this description; begin again")
    return [list(point) for point in road]


OPS: dict[Any, Callable[..., Any]] = {
    "hello": hello,
    "nodes": nodes,
    "verdict": verdict,
    "clear": clear,
    "distance": distance,
    "left_lane": left_lane,
    "spread": spread,
    "begin": begin,
    "next": another,
}


def main() -> None:
    """Answer until nobody asks any more. Whatever parts print goes to standard error."""
    hears, tells = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    for line in hears:
        asked = received(line)
        if asked is not None:
            try:
                send(tells, answer(asked))
            except OSError:
                return


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)
