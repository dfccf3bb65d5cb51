"""The development prompts, judged by the referee, where both are at hand: words in, roads out."""

import json

import pytest

from outside_judge import SHARED, load_referee
from roadgpt.brief import read
from roadgpt.design.designers.planner import Planner
from roadgpt.errors import RoadGPTError
from roadgpt.road import Design, World, build

ROADS = 5
LEAST = 20  # prompts of which all roads must be right


def test_nearly_all_prompts_give_only_roads_that_are_right() -> None:
    prompts, referee = SHARED / "prompts" / "dev.jsonl", load_referee()
    if referee is None or not prompts.exists():
        pytest.skip("the prompts or the referee are not at hand")
    planner, perfect = Planner(), list[str]()
    for line in prompts.read_text(encoding="utf-8").splitlines():
        prompt = json.loads(line)
        if all(right(prompt, planner, referee)):
            perfect.append(prompt["id"])
    assert len(perfect) >= LEAST, perfect


def right(prompt: dict, planner: Planner, referee) -> list[bool]:
    earlier: list[Design] = []
    out: list[bool] = []
    try:
        brief = read(prompt["prompt"])
    except RoadGPTError:
        return [False]
    for seed in range(ROADS):
        try:
            earlier.append(planner.draft(brief, World(), (), earlier, seed))
        except RoadGPTError:
            return [False]
        points = build(earlier[-1]).centreline().round(4)
        out.append(all(referee.check(points, prompt["truth"])[0].values()))
    return out
