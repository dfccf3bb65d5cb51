"""What a reader makes of the fresh sentences in data/fresh: five roads of each, judged by their truths.

    python benchmarks/bench_fresh.py --json judged.json

Whoever writes training text for a reader does not look at the rows that it misses, and does not run this.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from roadgpt.brief import SURE
from roadgpt.check.measures import RoadMeasures, measure
from roadgpt.check.truth import Truth, holds
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.errors import RoadGPTError
from roadgpt.road import World, build
from roadgpt.run import Setup, brief_of

ROOT = Path(__file__).resolve().parents[1]
FRESH = ROOT / "data" / "fresh"
SHARED = ROOT.parents[1] / "shared"
WORLD = World()
ROADS = 5
RESAMPLES = 2000
REFUSED, HONEST, BUILT = "rightly refused", "refused though it can be built", "built though it cannot be"
RIGHT, WARNED, SILENT, INVERTED = "right", "wrong, warned", "silently wrong", "inverted"


CAUSES = {
    "number of turns": ("number of turns", "12 turns"), "left and right": ("left and right",),
    "slope": ("uphill, downhill", "steep", "heights", "grades above"),
    "heights": ("heights", "uphill, downhill"),
    "length": ("length", "1500 m", "long"), "radius": ("radi",), "grade": ("grades above", "steep"),
    "angle": ("angles", "240 degrees", "degrees"), "order": ("order", "number of turns"),
    "straight or bend": ("number of turns", "order"), "bridge": ("bridge", "tunnel", "crosses itself"),
    "crossing itself": ("crosses itself", "240 degrees"), "loop": ("crosses itself", "240 degrees"),
    "junction": ("junction", "crossroads", "merge"), "fork": ("junction", "crossroads", "merge"),
    "merging": ("merge", "junction"), "roundabout": ("roundabout",),
    "nothing said": ("what is wanted is not said",),
}  # fmt: skip
"""Parts of our refusals, one of which names the cause that a writer gave; for other causes, which are no
roads at all, it is 'does not describe a road'."""
NO_ROAD = ("does not describe a road",)


class Judged(NamedTuple):
    """What became of one sentence."""

    verdict: str
    confidence: float | None = None
    is_flagged: bool = False
    """Whether the answer said that it was not sure, or that something is not built."""
    names_cause: bool = False
    """Of a refusal: whether its sentence names what the writer gave as the cause."""


def rows(path: Path) -> list[dict[str, Any]]:
    """The lines of one file of fresh sentences."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def is_met(truth: dict[str, Any], roads: Sequence[RoadMeasures]) -> bool:
    """Does every road meet the truth, or each road one of several?"""
    some = [
        {key: value for key, value in way.items() if key != "beside"} for way in truth.get("either", [truth])
    ]
    ways = [Truth.model_validate(way) for way in some]
    return all(any(all(holds(road, way).values()) for way in ways) for road in roads)


def judged(row: dict[str, Any], reader: str) -> Judged:
    """Reads a description, builds its roads and compares them with what its writer meant."""
    cannot = "refuse" in row["truth"]
    try:
        brief = brief_of(row["text"], WORLD, Setup(reader=reader))
        world = world_for(brief, WORLD)
        roads = [measure(build(draft(brief, world, seed=seed)).sample().points) for seed in range(ROADS)]
    except RoadGPTError as error:
        parts = CAUSES.get(row.get("cause", ""), NO_ROAD)
        return Judged(REFUSED if cannot else HONEST, names_cause=any(part in str(error) for part in parts))
    flagged = brief.confidence < SURE or bool(brief.beside)
    if cannot:
        return Judged(BUILT, brief.confidence, flagged)
    if is_met(row["truth"], roads):
        return Judged(RIGHT, brief.confidence, flagged)
    if "trap" in row and not flagged and is_met(row["trap"], roads):
        return Judged(INVERTED, brief.confidence, flagged)
    return Judged(WARNED if flagged else SILENT, brief.confidence, flagged)


def area(found: Sequence[Judged]) -> tuple[float, float, float]:
    """Area under the curve of the confidence, of right against wrong readings, with a 95 % interval."""
    read_ = [(one.confidence, one.verdict == RIGHT) for one in found if one.confidence is not None]
    sure, good = np.array([row[0] for row in read_]), np.array([row[1] for row in read_])
    rng = np.random.default_rng(0)

    def of(picked: Any) -> float:
        yes, no = sure[picked][good[picked]], sure[picked][~good[picked]]
        if not (len(yes) and len(no)):
            return float("nan")
        return float(np.mean((yes[:, None] > no) + 0.5 * (yes[:, None] == no)))

    samples = [of(rng.integers(0, len(sure), len(sure))) for _ in range(RESAMPLES)]
    low, high = np.nanquantile(samples, [0.025, 0.975])
    return of(np.arange(len(sure))), float(low), float(high)


def changes(fresh: Path, folder: Path) -> dict[str, str] | None:
    """The verdicts of the outside judge of changes by id; None where the judge is not at hand."""
    judge = SHARED / "edits" / "judge_edits.py"
    if not judge.is_file():
        return None
    out = folder / "changes.json"
    words = [sys.executable, str(judge), str(fresh / "changes.jsonl"), "--json", str(out)]
    subprocess.run(words, env={**os.environ, "REFEREE": str(SHARED)}, check=True, stdout=subprocess.DEVNULL)
    found = json.loads(out.read_text(encoding="utf-8"))
    return {row["id"]: row["verdict"] for row in (found["rows"] if isinstance(found, dict) else found)}


def lines(title: str, verdicts: Sequence[str]) -> Iterator[str]:
    """The counts of one set."""
    yield f"{title}, {len(verdicts)}:"
    for verdict, number in Counter(verdicts).most_common():
        yield f"    {number:4}  {verdict}"


def main() -> None:
    """Judge all sets and print the counts; no sentence is shown."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--reader", default="model")
    parser.add_argument("--json", type=Path, help="where the verdict on each row is kept, by its id")
    parser.add_argument(
        "--retired", choices=("first", "second", "third"), help="an older set, whose misses have been read"
    )
    given = parser.parse_args()
    fresh = FRESH / "retired" / given.retired if given.retired else FRESH
    found = {
        name: {row["id"]: judged(row, given.reader) for row in rows(fresh / f"{name}.jsonl")}
        for name in ("descriptions", "contrasts", "refusals")
    }
    for name, of_rows in found.items():
        print("\n".join(lines(name, [one.verdict for one in of_rows.values()])))
    refused = [one for one in found["refusals"].values() if one.verdict == REFUSED]
    named = sum(one.names_cause for one in refused)
    print(f"refusals of refusals.jsonl that name the cause: {named} of {len(refused)}")
    both = [one for of_rows in found.values() for one in of_rows.values()]
    wrong = [one for one in both if one.confidence is not None and one.verdict != RIGHT]
    right = [one for one in both if one.verdict == RIGHT]
    print("area under the curve of the confidence: {:.3f} [{:.3f}, {:.3f}]".format(*area(both)))
    print(f"wrong readings that are flagged: {sum(one.is_flagged for one in wrong)} of {len(wrong)}")
    print(f"right readings that are flagged: {sum(one.is_flagged for one in right)} of {len(right)}")
    with tempfile.TemporaryDirectory() as folder:
        edited = changes(fresh, Path(folder))
    print(
        "\n".join(lines("changes", [*edited.values()])) if edited else "changes: their judge is not at hand"
    )
    if given.json:
        kept = {name: {key: one._asdict() for key, one in some.items()} for name, some in found.items()}
        text = json.dumps(kept | {"changes": edited}, indent=1, sort_keys=True)
        given.json.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
