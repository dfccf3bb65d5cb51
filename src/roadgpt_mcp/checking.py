"""Finds all objections to a plan: to each part, to what contradicts itself, and to the road as built."""

import re
from collections.abc import Callable, Iterator
from typing import Any

from roadgpt.brief import sentence
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import BETWEEN, SCENE, WHOLE, is_junction, is_map, plan, read_action, read_plan
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
    if found := [*dict.fromkeys(_of_parts(text))]:
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


def _of_parts(text: str) -> Iterator[str]:
    """Yields the objections to each part of a plan by itself, and else to the whole of its scene and road."""
    route, _, scene = text.partition(SCENE)
    ways, _, whole = route.partition(WHOLE)
    for part in (ways,) if is_map(ways) else ways.split(BETWEEN):
        clauses, _, wishes = part.partition("|")
        yield from _mistakes(read_plan, *((part,) if is_map(ways) else clauses.split(";")))
        yield from _mistakes(lambda wishes: read_plan(f"| {wishes}"), wishes)
    before = f"t_junction {WHOLE}" if BETWEEN in ways or is_junction(ways) or is_map(ways) else "|"
    yield from _mistakes(lambda whole: read_plan(f"{before} {whole}"), whole)
    possible = list[str]()
    for part in scene.split(";"):
        head, _, actions = part.partition(":")
        found = [*_mistakes(lambda head: read_plan(f"{SCENE} {head}"), head)]
        found += _mistakes(read_action, *actions.split(","))
        found = found or [*_mistakes(lambda part: read_plan(f"{SCENE} {part}"), part)]
        yield from found
        possible += [] if found else [part]
    yield from _mistakes(read_plan, f"{SCENE} {';'.join(possible)}", route or "|")


def _mistakes(read: Callable[[str], object], *texts: str) -> Iterator[str]:
    for text in filter(str.strip, texts):
        try:
            read(text)
        except RoadGPTError as error:
            yield str(error)
