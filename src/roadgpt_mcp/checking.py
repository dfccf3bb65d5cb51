"""Finds all objections to a plan: to each part, to what contradicts itself, and to the road as built."""

import re
from collections.abc import Callable, Iterator
from typing import Any

from roadgpt.brief import sentence
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import SCENE, objections, plan
from roadgpt.cli.commands.make import all_remarks
from roadgpt.design.room import world_for
from roadgpt.errors import RoadGPTError
from roadgpt.road import World
from roadgpt.run import Setup, brief_of, perform
from roadgpt.traffic import begin


def checked(text: str, kind: str) -> dict[str, Any]:
    """Returns all objections to a plan; without any, what it means. The kind is description or change."""
    if kind == "change":
        changes, _, scene = text.partition(SCENE)
        parts = [
            *re.split(r";(?![^()]*\))", changes),
            *(f"{SCENE} {part}" for part in scene.split(";") if part),
        ]
        found = [*dict.fromkeys(_mistakes(read_change_plan, *parts, text))]
        return {"objections": found} | ({} if found else {"plan": change_plan(read_change_plan(text))})
    if found := [*objections(text)]:
        return {"objections": found}
    world = World()
    try:
        brief = brief_of(text, world, setup := Setup(reader="plan", drives=False))
        run = perform(brief, 1, world, setup)
    except RoadGPTError as error:
        return {"objections": [str(error)]}
    found = [finding.sentence for finding in run.findings]
    if (road := run.road) is not None and run.world.scene.has_others and not found:
        found = [*_mistakes(lambda _: begin(road, run.world, run.seed, aims={}), "the others")]
    remarks = [*all_remarks(brief, world_for(brief, world), world)]
    return {"objections": found, "plan": plan(brief), "sentence": sentence(brief), "remarks": remarks}


def _mistakes(read: Callable[[str], object], *texts: str) -> Iterator[str]:
    for text in filter(str.strip, texts):
        try:
            read(text)
        except RoadGPTError as error:
            yield str(error)
