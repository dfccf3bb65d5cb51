"""Random segment lists as a language model writes them: how many become valid, and by how much change."""

import sys
import time
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import get_args

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from authorities import roadgpt_checks
from llm_like import random_lists
from roadgpt import check
from roadgpt.chat.model import Repair
from roadgpt.check.measures import measure, way
from roadgpt.design.repair import repair
from roadgpt.road import Design, World, build, read_design

WORLD = World()
LISTS, SEED = 400, 1


def main() -> None:
    """Print a table: none, place and full side by side."""
    lists = random_lists(LISTS, SEED)
    accepted = [not roadgpt_checks.verdict(each) for each in lists]
    designs = [read_design(each)[0] for each in lists]
    strict = [not check.inspect(build(design), None, WORLD) for design in designs]
    wrong = sum(yes and not ours for yes, ours in zip(accepted, strict, strict=True))
    share = sum(accepted) / LISTS
    print(f"{LISTS} lists, seed {SEED}: RoadGPT's own checks accept {sum(accepted)} ({share:.0%});")
    print(f"    of those, {wrong} are not strictly valid as arcs")
    print("       valid       as proposed  change of lengths    change of angles     ms")
    print("                                median, mean, 95 %   median, mean, 95 %   median, most")
    for how in get_args(Repair):
        print(_row(how, designs))


def _row(how: Repair, designs: Sequence[Design]) -> str:
    valid = kept = 0
    lengths, angles, took = [], [], []
    for design in designs:
        begun = time.process_time()
        after = repair(design, None, WORLD, how).design
        took.append(1000 * (time.process_time() - begun))
        road = build(after)
        if check.inspect(road, None, WORLD):
            continue
        valid += 1
        turns = [(turn.side, way(turn.grade)) for turn in measure(road.centreline()).turns]
        kept += turns == proposed_turns(design)
        for one, other in zip(design.segments, after.segments, strict=True):
            lengths.append(100 * abs(other.distance / one.distance - 1))
            if one.turn_degrees:
                angles.append(100 * abs(other.turn_degrees / one.turn_degrees - 1))
    shares = f"{valid:4} {valid / len(designs):6.1%} {kept:4} {kept / len(designs):6.1%}"
    times = f"{np.median(took):6.1f} {max(took):6.0f}"
    return f"{how:6} {shares}  {_spread(lengths)} {_spread(angles)} {times}"


def _spread(percent: Sequence[float]) -> str:
    return f"{np.median(percent):5.1f} {np.mean(percent):5.1f} {np.quantile(percent, 0.95):5.1f} %"


def proposed_turns(design: Design) -> list[tuple[str, str]]:
    """Side and slope of every turn of a list: segments of one hand in a row that turn 10 degrees or more."""
    out = []
    for hand, group in groupby(design.segments, key=lambda segment: np.sign(segment.turn_degrees)):
        own = list(group)
        if hand and abs(sum(s.turn_degrees for s in own)) >= 10:
            mean = sum(s.distance * s.incline for s in own) / sum(s.distance for s in own)
            out.append(("left" if hand > 0 else "right", way(mean)))
    return out


if __name__ == "__main__":
    main()
