"""Prompts with truths: a reading of such a prompt is right if the roads made of it meet the truth."""

import json
from dataclasses import dataclass
from pathlib import Path

from roadgpt.brief.model import Brief
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.errors import LearnError, RoadGPTError
from roadgpt.reading import read_text
from roadgpt.road import Design, World, build
from roadgpt.study.truth import Truth, holds

ROADS = 5
"""Roads that are made of each prompt, with the seeds 0 to 4; all of them must meet the truth."""


@dataclass(frozen=True, slots=True)
class ToldPrompt:
    """A request in words, and its truth: what the measures of a road must be to fulfil the request."""

    text: str
    truth: Truth


def told_prompts(path: Path) -> list[ToldPrompt]:
    """Returns the prompts of a file of JSON lines such as ``{"id", "prompt", "truth"}``. Prompts without a
    truth, which must be refused, are left out.

    Raises:
        LearnError: a line is not such a prompt.
    """
    out = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        try:
            row = json.loads(line)
            text = str(row["prompt"])
            if "truth" in row:
                out.append(ToldPrompt(text, Truth.model_validate(row["truth"])))
        except (ValueError, KeyError, TypeError) as error:
            raise LearnError(f"line {number} of '{path}' is not a prompt with its truth") from error
    return out


def is_right(brief: Brief, truth: Truth) -> bool:
    """Returns whether all roads made from a Brief meet a truth; False if a road cannot be made."""
    try:
        world = world_for(brief, World())
        designs = [draft(brief, world, seed=seed) for seed in range(ROADS)]
    except RoadGPTError:
        return False
    roads = [measure(build(each).centreline()) for each in designs if isinstance(each, Design)]
    return len(roads) == len(designs) and all(all(holds(road, truth).values()) for road in roads)
