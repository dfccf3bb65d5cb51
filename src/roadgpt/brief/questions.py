"""What a reading leaves in doubt, or open, as questions with choices; each choice is another plan."""

import re
from collections.abc import Iterator
from typing import Any, get_args

from roadgpt.brief.amount import figure, read_amount
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import SCENE, objections, plan, read_plan
from roadgpt.brief.readers.model.mentions import mentions_in
from roadgpt.brief.scene import Role
from roadgpt.brief.words import SURE
from roadgpt.language.names import Side, Way
from roadgpt.language.table import MANEUVERS, OF_ITSELF, PLACES, ROAD_USERS

Asked = Iterator[tuple[str, list[str]]]
SPOTS = (" crossing left: cross", " crossing right: cross", " ahead", " oncoming")
OPEN = re.compile(r"(?:\w+ )?[a-z]*=?((?:\d[\d.]*\d|\d)?\.\.(?:\d[\d.]*)?)")


def questions(brief: Brief, of_numbers: bool = True) -> Iterator[tuple[str, list[Brief]]]:
    """Yields questions, each with what can be chosen instead of the Brief, the most doubtful first."""
    same = {name: getattr(brief, name) for name in ("words", "unused", "confidence")}
    for part in (_doubts, _places, *[_numbers] * of_numbers):
        for about, plans in part(brief):
            possible = [line for line in plans if not objections(line)]
            if choices := [read_plan(line).model_copy(update=same) for line in possible]:
                yield about, choices


def _staged(brief: Brief, *roles: tuple[int, Role], **changed: Any) -> str:
    actors = tuple((dict(enumerate(brief.scene.actors)) | dict(roles)).values())
    scene = brief.scene.model_copy(update={"actors": actors, **changed})
    return plan(brief.model_copy(update={"scene": scene}))


def _doubts(brief: Brief) -> Asked:
    """The other reading, words without effect that name somebody or weather, and who does something."""
    yield "Is this meant?", [brief.other] * bool(brief.other)
    line = plan(brief)
    for word, named in ((said, each.name) for said in brief.unused for each in mentions_in(said)):
        start = f"{line}{';' if SCENE in line else f' {SCENE}'} {named}"
        new = [f"{start}{each}" for each in (SPOTS if named in ROAD_USERS else [""])]
        yield f"'{word}' has no effect. Is this meant?", new
    actors = [*enumerate(brief.scene.actors)] if brief.confidence < SURE else []
    for at, role in ((at, role) for at, role in actors if role.actions):
        does, idle = {"actions": role.actions}, (at, role.model_copy(update={"actions": ()}))
        free = [(n, each.model_copy(update=does)) for n, each in actors if n != at and not each.actions]
        plans = [_staged(brief, idle, each) for each in free]
        if {each.what for each in role.actions} <= {*OF_ITSELF} and not brief.scene.actions:
            plans.append(_staged(brief, idle, **does))
        yield f"Who {MANEUVERS[role.actions[0].what].said}?", plans


def _places(brief: Brief) -> Asked:
    """The side of somebody, the kind of a junction, and the way on there."""
    for at, role in enumerate(brief.scene.actors):
        if PLACES[role.where].side and not role.side:
            sided = [role.model_copy(update={"side": side}) for side in (*get_args(Side), "opposite")]
            yield (
                f"On which side, or from which, is '{role}'?",
                [_staged(brief, (at, each)) for each in sided],
            )
    for at, place in enumerate(brief.junctions):
        kinds = ("t_junction", "crossroads", "roundabout") if place.kind == "junction" else ()
        for field, values in ("kind", kinds), ("take", () if place.take else get_args(Way)):
            about = f"Which {'way leads on at' if field == 'take' else 'kind is'} junction {at + 1}?"
            before, behind = brief.junctions[:at], brief.junctions[at + 1 :]
            new = [(*before, place.model_copy(update={field: each}), *behind) for each in values]
            yield about, [plan(brief.model_copy(update={"junctions": each})) for each in new]


def _numbers(brief: Brief) -> Asked:
    """Numbers that would be drawn: ranges, then bounds."""
    line = plan(brief)
    for found in sorted(OPEN.finditer(line), key=lambda each: ".." in (each[1][:2], each[1][-2:])):
        amount, (start, end) = read_amount(found[1]), found.span(1)
        low = amount.lo if amount.lo is not None else (amount.hi or 0.0) / 2
        high = 2 * low if amount.hi is None else amount.hi
        numbers = dict.fromkeys(round(each, 2 * (low % 1 > 0)) for each in (low, (low + high) / 2, high))
        yield f"{found[0]}: how much?", [f"{line[:start]}{figure(each)}{line[end:]}" for each in numbers]
