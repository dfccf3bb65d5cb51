"""Runs the catalogue of scenarios with the test robot, and lets an outside referee of traffic judge the
exported files by truths that were written before the scenarios were built.

    python benchmarks/bench_scenarios.py --referee FOLDER             all scenarios on their nominal roads
    python benchmarks/bench_scenarios.py --referee FOLDER --roads     on the roads of tests/traffic/roads.json
    python benchmarks/bench_scenarios.py --referee FOLDER --only 'r157:*' --seeds 20
    python benchmarks/bench_scenarios.py --referee FOLDER --roads --sample 60 --seeds 20     60 of its pairs
    python benchmarks/bench_scenarios.py --referee FOLDER --left-hand      roads and truths mirrored
    python benchmarks/bench_scenarios.py --prescribed     a table: driven against prescribed

A pair of a scenario and a road is found, where every key of the truth holds; refused, with its sentence; or
missed, with the keys that do not hold. On other roads than the nominal one only who is there, what they do,
and whether they meet is asked: numbers belong to the nominal road."""

import argparse
import importlib
import json
import random
import re
import shlex
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from roadgpt.brief.model import mirrored
from roadgpt.brief.plan import read_plan
from roadgpt.brief.scenarios import LANE_WIDTH, scenarios
from roadgpt.errors import DesignError, UsageError
from roadgpt.road import World
from roadgpt.run import Run, Setup, perform
from roadgpt.run.exporting import export

TRUTHS = Path(__file__).resolve().parents[1] / "tests" / "traffic"
RATES = ("does", "decel", "accel")
ANYWHERE = ("kind", "where", "does", "n", "decel", "accel", "collides")
"""The keys of an actor that hold on any road."""


def driven(name: str, plan: str = "", seed: int = 1, left_hand: bool = False, **of_world: Any) -> Run:
    """Drives a scenario on its nominal road or that of a plan, or on its mirror image."""
    brief = read_plan(plan or scenarios()[name].plan)
    world = World().changed(**({} if plan else {"lane_width": LANE_WIDTH}), **of_world)
    setup = Setup(driver="robot", reader="plan", scenario=name)
    return perform(mirrored(brief) if left_hand else brief, seed, world, setup)


def judged(referee: Any, run: Run, truth: dict[str, Any]) -> tuple[list[str], dict[str, Any]]:
    """Returns the keys of the truth that do not hold in the exported files, and what was measured."""
    with tempfile.TemporaryDirectory() as folder:
        export(run, folder, ["opendrive", "openscenario"], lambda said: None)
        holds, measured = referee.check(f"{folder}/road.drive.xosc", truth)
    return [key for key, value in holds.items() if not value], measured


def table(only: str) -> Iterator[str]:
    """Yields the rows of a table of the nominal scenarios: each number as driven, in brackets as prescribed,
    and the tolerance, with a star where it is ours."""
    sys.path.insert(0, str(TRUTHS.parent))
    measured, prescribed = map(importlib.import_module, ("measured", "prescribed"))
    yield "| scenario | as driven (as prescribed), tolerance |"
    yield "|---|---|"
    for name in filter(lambda each: fnmatchcase(each, only), scenarios()):
        found = measured.Measured(driven(name))
        said = []
        for row in (*prescribed.PRESCRIBED, *prescribed.OF_ROBOT):
            if row.scenario == name:
                value, unit = getattr(found, row.what)(row.who, row.want), prescribed.UNITS.get(row.what, "m")
                of = f"{row.what.replace('_', ' ')}{f' of no. {row.who + 1}' if row.who else ''}"
                own = "*" if row.whose == "ours" else ""
                number = f"{round(value, 2) + 0.0:g} ({round(row.want, 2):g}) {unit}"
                said.append(f"{of} {number} ±{round(row.tolerance, 2):g}{own}")
        yield f"| `{name}` | {'; '.join(said)} |"


def anywhere(truth: dict[str, Any]) -> dict[str, Any]:
    """Returns what of a truth holds on any road."""
    actors = []
    for each in truth.get("actors", ()):
        does = each["does"] if isinstance(each["does"], list) else [each["does"]]
        plain = [
            {key: one[key] for key in RATES if key in one} if isinstance(one, dict) else one for one in does
        ]
        actors.append({**{key: each[key] for key in ANYWHERE if key in each}, "does": plain})
    found = {key: truth[key] for key in ("sound", "conditions", "flow") if key in truth}
    return found | ({"actors": actors} if actors else {})


def main() -> None:
    """Prints a line for each pair, and the counts."""
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("--referee", type=Path, help="folder of referee_traffic.py")
    args.add_argument("--prescribed", action="store_true")
    args.add_argument("--roads", action="store_true")
    args.add_argument("--only", default="*")
    args.add_argument("--seeds", type=int, default=1)
    args.add_argument("--road", type=int, default=0, help="only this road, from 1")
    args.add_argument("--sample", type=int, default=0, help="only so many pairs, drawn by chance")
    args.add_argument("--left-hand", action="store_true")
    args.add_argument("--verbose", action="store_true")
    given = args.parse_args()
    if given.prescribed:
        for line in table(given.only):
            print(line, flush=True)
        return
    if given.referee is None:
        print("no referee here: give the folder of referee_traffic.py with --referee", file=sys.stderr)
        return
    sys.path.insert(0, str(given.referee))
    referee = importlib.import_module("referee_traffic")
    truths = (TRUTHS / "catalogue.json").read_text()
    if given.left_hand:
        truths = re.sub(r"\b(?:left|right)\b", lambda side: "right" if side[0] == "left" else "left", truths)
    catalogue = json.loads(truths)["scenarios"]
    roads = json.loads((TRUTHS / "roads.json").read_text())["roads"] if given.roads else [None]
    roads = roads[given.road - 1 : given.road] if given.road else roads
    named = [one for one in catalogue if fnmatchcase(one["name"], given.only)]
    pairs = [(road, one) for road in roads for one in named if road is None or "grid" in one]
    fit = [(road, one) for road, one in pairs if road is None or one["name"] not in road["fits"]["all but"]]
    counts, sure = Counter[str](), 0
    chosen = random.Random(1).sample(fit, given.sample) if given.sample else fit
    for road, one in chosen:
        own = Counter[str]()
        for seed in range(1, given.seeds + 1):
            outcome, said = _outcome(referee, one, road, seed, given)
            own[outcome] += 1
            print(f"{outcome:<8} {one['name']:<42} {road['plan'] if road else ''}  {said}", flush=True)
        counts += own
        sure += own["found"] >= 0.95 * given.seeds
    print(f"{dict(counts)}; {sure} of {len(chosen)} pairs are found with 95 % of their seeds")
    print(f"{len(pairs) - len(fit)} pairs do not fit by the list of roads")


def _outcome(
    referee: Any, entry: dict[str, Any], road: dict[str, Any] | None, seed: int, given: argparse.Namespace
) -> tuple[str, str]:
    words = iter(shlex.split(road.get("options", "")) if road else ())
    more = {key[2:].replace("-", "_"): float(value) for key, value in zip(words, words, strict=True)}
    more |= {"bank": more["bank"] / 100} if "bank" in more else {}
    try:
        run = driven(entry["name"], road["plan"] if road else "", seed, given.left_hand, **more)
    except (UsageError, DesignError) as error:
        return "refused", str(error)
    if run.outcome in ("INVALID", "ERROR") or run.drive is None:
        return "refused" if run.description.startswith("refused") else "error", run.description
    wrong, measured = judged(referee, run, anywhere(entry["truth"]) if road else entry["truth"])
    more_said = json.dumps(referee.plain(measured), default=str) if given.verbose else ""
    if not wrong:
        return "found", more_said
    faults = {key: value for key, value in measured["faults"].items() if value and key in wrong}
    said = {key: measured.get("outcome", {}).get(key.partition(".")[2]) for key in wrong if "outcome" in key}
    return "missed", f"{wrong} {faults or ''} {said or ''} {run.description} {more_said}"


if __name__ == "__main__":
    main()
