"""Compares the events of drives with what an outside referee of traffic finds in the exported files.

    python benchmarks/bench_events.py --referee FOLDER [N]      N scenes of the catalogue, by several drivers

Asked of each scene: whether the tested car touched somebody, whom, which of its sides and which of the
other's (the referee tells front, rear and side), and of each action of an actor that we say has happened,
and that the referee has a word for, whether it saw it within 3 s of ours. A scene agrees if all that is
asked of it does."""

import argparse
import importlib
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

from roadgpt.brief.plan import read_plan
from roadgpt.brief.scenarios import LANE_WIDTH, scenarios
from roadgpt.errors import RoadGPTError
from roadgpt.language.table import MANEUVERS
from roadgpt.road import World
from roadgpt.run import Run, Setup, perform
from roadgpt.run.exporting import export

DRIVERS = ("robot", "lane_centring", "reference")
NEAR = 3.0  # s
WORDS = {
    "brake": ("brakes", "stops"), "stop": ("stops",), "cut_in": ("cuts in",), "cut_out": ("cuts out",),
    "change_lane": ("changes lane", "cuts in", "cuts out"), "overtake": ("overtakes",), "merge": ("merges",),
    "cross": ("crosses", "enters", "turns in"), "turn_across": ("turns across", "crosses", "enters"),
    "turn_in": ("turns in", "crosses", "enters"), "turn_off": ("turns off",), "reverse": ("reverses",),
    "pull_out": ("pulls out",), "wrong_way": ("wrong way",), "run_light": ("runs red",),
}  # fmt: skip
"""The referee's words for actions; the others have none, or have bounds that a told number need not reach."""
SIDES = {"left": "side", "right": "side", "mirror": "side"}


def asked(referee: Any, run: Run) -> dict[str, tuple[Any, Any]]:
    """Returns what we and the referee say of a run, by what is asked."""
    assert run.verdict is not None
    with tempfile.TemporaryDirectory() as folder:
        export(run, folder, ["opendrive", "openscenario"], lambda said: None)
        _, measured = referee.check(f"{folder}/road.drive.xosc", {"outcome": {"collision": True}})
        xosc, xodr, route = referee.files(f"{folder}/road.drive.xosc")
        seen = referee.Scene(xosc, xodr, referee.json.loads(Path(route).read_text())["route"])
        names = [each.name for each in seen.actors]
        deeds = {name: seen.deeds(n) for n, name in enumerate(names) if seen.life[n]}
    outcome, hit = measured.get("outcome", {}), run.verdict.first_contact
    first = next((each for each in run.verdict.incidents or () if each.contact), None)
    found = {"contact": (first is not None, bool(outcome.get("collision")))}
    if first and hit and outcome.get("collision"):
        found["with"] = (first.other, outcome["with"])
        found["face"] = (SIDES.get(hit.face, hit.face), outcome["hit"])
        found["its face"] = (SIDES.get(hit.other_face, hit.other_face), outcome["hits"])
    ends = first.at_time if first else run.drive.duration if run.drive else 0.0
    for event in run.verdict.events or ():
        words = next((w for what, w in WORDS.items() if event.what.startswith(MANEUVERS[what].said)), None)
        if not words or event.who not in deeds or event.why or event.time is None or event.time > ends - 1.0:
            continue
        until = (ends if event.until is None else event.until) + NEAR
        saw = [(each["does"], float(seen.t[each["begin"]]), each["time"]) for each in deeds[event.who]]
        is_seen = any(
            does in words and event.time - NEAR <= last and begins <= until for does, begins, last in saw
        )
        found[f"{event.who} {event.what}, {event.time:.1f} to {until:.1f} s"] = (True, is_seen or saw)
    return found


def main() -> None:
    """Prints a line for each disagreement, and the counts."""
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("--referee", type=Path, help="folder of referee_traffic.py")
    args.add_argument("count", type=int, nargs="?", default=300)
    given = args.parse_args()
    if given.referee is None:
        print("no referee here: give the folder of referee_traffic.py with --referee", file=sys.stderr)
        return
    sys.path.insert(0, str(given.referee))
    referee = importlib.import_module("referee_traffic")
    every = [(name, driver, seed) for name in scenarios() for driver in DRIVERS for seed in (1, 2, 3)]
    agrees, scenes, right, total = 0, 0, Counter[str](), Counter[str]()
    for name, driver, seed in random.Random(8).sample(every, len(every)):
        if scenes == given.count:
            break
        setup = Setup(driver=driver, reader="plan", scenario=name)
        try:
            plan, world = read_plan(scenarios()[name].plan), World().changed(lane_width=LANE_WIDTH)
            run = perform(plan, seed, world, setup)
        except RoadGPTError as error:
            print(f"refused  {name} {driver}: {error}", flush=True)
            continue
        if run.verdict is None or run.drive is None or run.drive.others is None:
            continue
        found = asked(referee, run)
        wrong = {what: both for what, both in found.items() if both[0] != both[1]}
        scenes, agrees = scenes + 1, agrees + (not wrong)
        for what, both in found.items():
            kind = what if what in ("contact", "with", "face", "its face") else "actions"
            total[kind] += 1
            right[kind] += both[0] == both[1]
        if wrong:
            print(f"differs  {name} {driver} {seed}: {wrong}", flush=True)
        if scenes % 20 == 0:
            print(f"{agrees} of {scenes} agree", flush=True)
    parts = ", ".join(f"{kind} {right[kind]} of {total[kind]}" for kind in total)
    print(f"{agrees} of {scenes} scenes agree ({agrees / max(scenes, 1):.1%}): {parts}")


if __name__ == "__main__":
    main()
