"""Serves test generators that run in other Python interpreters: computes what the competition computes, and
designs roads. The client, ``names/roadgpt_client.py``, starts this module as ``python -m
roadgpt_sbft.answers``; each request and each answer is one line of JSON. A generator that runs in RoadGPT's
own interpreter is started here as well, and ``answer`` is called directly.
"""

import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

import numpy as np

from roadgpt import __version__, children
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.geometry import interpolate
from roadgpt_sbft.client import Message, received, send
from roadgpt_sbft.validator import keeps_clear, sbft_verdict

LONGEST = 50_000.0  # m of control polyline; the spline through a longer one would fill the memory

Points = list[list[float]]


def answer(asked: Message) -> Message:
    """Carries out a request; returns its result as ``answer``, or a message as ``error``."""
    values = dict(asked)
    op = values.pop("op", None)
    if op not in OPS:
        return {"error": f"RoadGPT knows no '{op}'; are client and RoadGPT of one version?"}
    try:
        return {"answer": OPS[op](**values)}
    except RoadGPTError as error:
        return {"error": str(error)}
    except Exception as error:  # report it to the other end, which may ask again
        return {"error": f"RoadGPT cannot answer '{op}': {error!r}"}


def nodes(points: Any) -> Points:
    """Returns the points that the competition interpolates through control points ``(n, 2)``, in metres."""
    table = np.asarray(points, float)[:, :2]
    if not np.isfinite(table).all():
        raise UsageError("a number of the road points is not finite; give every point as two plain numbers")
    if np.hypot(*np.diff(table, axis=0).T).sum() > LONGEST:
        raise UsageError(f"a road of more than {LONGEST / 1000:g} km; bring a shorter one")
    return list(interpolate(table).tolist())


def left_lane(points: Any, records: Any, before: float, after: float) -> Message | None:
    """Returns the fields of the Departure; None if the car did not leave its lane."""
    from roadgpt.run import execution
    from roadgpt_sbft.sparseness import departure

    found = departure(points, [execution.ExecutionRecord(*record) for record in records], before, after)
    return None if found is None else found._asdict()


def spread(segments: Any) -> tuple[float, float]:
    """Returns mean and standard deviation of the competition's sparseness of segments: points ``(n, 2)`` of
    the road around each failure."""
    from roadgpt_sbft.sparseness import Sparseness

    found = Sparseness()
    for number, points in enumerate(segments):
        found.add(number, points)
    return found.mean, found.deviation


_ASKED: list[tuple[Any, Iterator[Any]]] = []
"""The generator that was begun, and its roads."""


def begin(map_size: int | None = None, **asked: Any) -> None:
    """Starts a sequence of roads. ``asked`` are attributes of RoadGPTTestGenerator."""
    from roadgpt_sbft.generator import RoadGPTTestGenerator

    if unknown := set(asked) - {"description", "seed", "designer", "reader", "search", "oob_tolerance"}:
        raise UsageError(
            f"RoadGPT knows no {', '.join(sorted(unknown))}; are client and RoadGPT of one version?"
        )
    generator = type("Asked", (RoadGPTTestGenerator,), asked)(None, map_size)
    _ASKED[:] = [(generator, generator.roads())]


def another() -> Points:
    """Returns the control points of the next road."""
    if not _ASKED:
        raise UsageError("no description was given; begin with one")
    road = next(_ASKED[0][1], None)
    if road is None:
        raise UsageError("there are no more roads of this description; begin again")
    return [list(point) for point in road]


def tell(
    outcome: str, steering: list[float], distances: list[float], outside: list[float] | None = None
) -> None:
    """Reports the outcome of the last road to RoadGPTTestGenerator."""
    if _ASKED:
        _ASKED[0][0].tell_columns(outcome, steering, distances, outside)


def distance(one: Any, other: Any) -> float:
    """Returns the competition's edit distance between two sequences of points ``(n, 2)``."""
    from roadgpt.run import step_distance

    one, other = map(step_distance.steps_of, (one, other))
    return float(step_distance.distances(one, [other])[0])


OPS: dict[Any, Callable[..., Any]] = {
    "hello": lambda: __version__,
    "nodes": nodes,
    "verdict": lambda points, map_size: sbft_verdict(np.asarray(points, float), map_size),
    "clear": lambda left, right: keeps_clear(np.asarray(left, float), np.asarray(right, float)),
    "distance": distance,
    "left_lane": left_lane,
    "spread": spread,
    "begin": begin,
    "next": another,
    "tell": tell,
}


def main() -> None:
    """Answers requests until standard input is closed. Output of plug-ins goes to standard error. If the
    folder of the competition's names is given, runs a generator instead, which is answered here."""
    if sys.argv[1:]:
        sys.path.insert(0, sys.argv[1])
        import_module("roadgpt_inside").Answering.here = answer
        import_module("roadgpt_task").main()
    hears, tells = children.private_streams()
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
