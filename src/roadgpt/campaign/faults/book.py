"""The failures of a campaign, one by one, and which of them are the same fault.

DIR/faults/  (of a campaign of several cells: DIR/faults/c01/ and so on)
  0017.json    why, and every disturbed drive; where it is, the failure has been looked into
  0017.png     what happened, from above
  faults.csv   one line per failure, those of one fault together, the most stable first
"""

import csv
import io
import json
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from roadgpt.campaign.faults.distinct import Surroundings, faults_of, surroundings
from roadgpt.campaign.faults.disturbed import Disturbance
from roadgpt.campaign.faults.stability import STABLE, Repeated, Stability, repeated
from roadgpt.campaign.faults.why import Why, why
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.run import Run
from roadgpt.run.atomic import json_text, write_whole

FOLDER = "faults"
TABLE = "faults.csv"
HEAD = (
    "fault", "failures_of_it", "road", "failed_again", "drives", "share", "way", "side", "radius_m",
    "entered_kmh", "needed_g", "grade", "station_m", "reason",
)  # fmt: skip


class Draws(Protocol):
    """Whoever draws a failure; the room ``report`` does."""

    def __call__(self, run: Run, reason: Why, more: str, path: Path) -> object:
        """Write a picture."""
        ...


@dataclass(frozen=True, eq=False)
class Failure:
    """One failure, looked into."""

    number: int
    why: Why
    stability: Stability
    around: Surroundings


@dataclass(frozen=True)
class Line:
    """A failure as the table has it."""

    fault: int
    """From 1, in the order of the table."""
    of_it: int
    """Failures of the same fault."""
    failure: Failure


def look_into(
    runs: Iterable[Run],
    place: Path,
    times: int,
    draw: Draws | None = None,
    spread: Callable[..., Iterable[Repeated]] = map,
) -> Iterator[Failure]:
    """Why each failed Run failed and how often it does, written into the folder ``place`` as it goes.

    What is there already, with as many drives of the same road, is read and not driven again.

    Args:
        runs: those that did not fail are passed over.
        place: ``DIR/faults``; made where it is not there.
        times: disturbed drives of each.
        draw: makes the picture; None makes none.
        spread: as for ``repeated``.

    Raises:
        RoadGPTError: a file cannot be written.
    """
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RoadGPTError(f"cannot make {place}: {error.strerror}; make room there") from error
    for run in runs:
        if run.outcome != "FAIL" or run.verdict is None or run.road is None or run.drive is None:
            continue
        reason = why(run)
        around = surroundings(run.road, run.world, reason.station, f"{run.verdict.cause} {run.verdict.side}")
        path = place / f"{run.index:04d}.json"
        stability = _read(path, run, times)
        is_new = stability is None
        stability = stability or repeated(run, times, spread)
        picture = path.with_suffix(".png")
        if draw is not None and (is_new or not picture.is_file()):
            draw(run, reason, stability.sentence, picture)
        if is_new:
            write_whole(path, json_text(_written(run, reason, stability)))
        yield Failure(run.index, reason, stability, around)


def table(failures: Sequence[Failure]) -> list[Line]:
    """Faults with most failures first; within one the most stable failure first."""
    clusters = faults_of([failure.around for failure in failures])
    members: dict[int, list[Failure]] = {}
    for cluster, failure in zip(clusters, failures, strict=True):
        members.setdefault(cluster, []).append(failure)
    ordered = sorted(members.values(), key=lambda its: (-len(its), its[0].number))
    return [
        Line(number, len(its), failure)
        for number, its in enumerate(ordered, 1)
        for failure in sorted(its, key=lambda failure: (-failure.stability.share, failure.number))
    ]


def write_table(lines: Sequence[Line], place: Path) -> Path:
    """``faults.csv``; the same failures give the same bytes."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEAD)
    for line in lines:
        its, reason = line.failure.stability, line.failure.why
        writer.writerow(
            [
                line.fault, line.of_it, line.failure.number, its.failed, len(its.drives), f"{its.share:.3f}",
                reason.way, reason.side or "", "" if reason.radius is None else f"{reason.radius:.1f}",
                f"{reason.entered * 3.6:.1f}", f"{reason.needed:.3f}", f"{reason.grade:.3f}",
                f"{reason.station:.1f}", reason.sentence,
            ]
        )  # fmt: skip
    path = place / TABLE
    write_whole(path, text.getvalue())
    return path


class Counted(NamedTuple):
    """What ``faults.csv`` comes to."""

    failures: int
    stable: int
    """Of them, that fail every second time or oftener."""
    faults: int


def counted(place: Path) -> Counted | None:
    """What ``place/faults.csv`` comes to; None where there is none.

    Raises:
        UsageError: it cannot be read.
    """
    try:
        with (place / TABLE).open(encoding="utf-8", newline="") as file:
            rows = [(int(row["fault"]), float(row["share"])) for row in csv.DictReader(file)]
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(
            f"{place / TABLE} cannot be read ({error}); remove it, and make it again with roadgpt faults"
        ) from error
    return Counted(len(rows), sum(share >= STABLE for _, share in rows), len({fault for fault, _ in rows}))


def _written(run: Run, reason: Why, stability: Stability) -> dict[str, Any]:
    return {
        "road": run.index,
        "seed": run.seed,
        "description": run.description,
        "why": asdict(reason),
        "stability": stability.sentence,
        "drives": [_drive(drive) for drive in stability.drives],
    }


def _drive(drive: Repeated) -> dict[str, Any]:
    # a driver that broke down has no margin, and JSON has no NaN
    return {**asdict(drive), "margin": drive.margin if math.isfinite(drive.margin) else None}


def _read(path: Path, run: Run, times: int) -> Stability | None:
    """The drives that were made before, where they are of this Run and as many."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data["seed"] != run.seed or data["description"] != run.description or len(data["drives"]) != times:
            return None
        return Stability(tuple(_drive_of(drive) for drive in data["drives"]))
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(f"{path} cannot be read ({error}); remove it, and it is made again") from error


def _drive_of(data: dict[str, Any]) -> Repeated:
    margin = math.nan if data["margin"] is None else float(data["margin"])
    return Repeated(**{**data, "disturbance": Disturbance(**data["disturbance"]), "margin": margin})
