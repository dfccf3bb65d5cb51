"""Edits a road with a language model: the model answers with the whole road, and code restores the segments
that were not to be changed.

For every segment of its answer, the model gives the number of the same segment in the old road; it also lists
the segments that the request concerns. All other segments get their old values back, whatever the model
answered for them.
"""

import json
from collections.abc import Sequence
from dataclasses import replace

from pydantic import BaseModel, Field

from roadgpt.chat import Chat, ChatSettings, Message, ReplyError, UnparsableError
from roadgpt.chat.json_schema import fixed_description
from roadgpt.check.measures import Measures
from roadgpt.design.answer import AnswerSegment, Number
from roadgpt.design.asking import rules
from roadgpt.design.designers.chat import RULES
from roadgpt.design.fit import Look, Requirements, look
from roadgpt.design.road_elements import RoadElement, RoadElements, elements_on_road
from roadgpt.errors import EditError, UsageError
from roadgpt.road import Design, Geometry, Segment, World, read_design
from roadgpt.road.design import MAX_SEGMENTS

MOST_SHOWN = 6000  # characters of its own answer that a model is shown again
TASK = """You are given a road that exists and a request to change it. Answer with the whole road as it is to
be afterwards, in driving order. Of every segment say in "was" the number of the old segment that it is, or 0
where it is new. Name in "touched" the numbers of the old segments that the request speaks of: only these may
change or go, all others are kept as they are. Turns and straights are counted as the list of what is seen
says. Change no more than the request asks for."""


class EditedSegment(AnswerSegment):
    """A segment of a road as a language model changed it."""

    model_config = fixed_description("A segment of the changed road.")

    was: int = Field(description="Number of the old segment that it is; 0 of a new one.")


class EditedRoad(BaseModel):
    """A road as a language model changed it."""

    model_config = fixed_description("The changed road.")

    touched: list[int] = Field(description="Numbers of the old segments that the request speaks of.")
    theta: Number = Field(description="Degrees, of the start; as it was, but for good reasons.")
    segments: list[EditedSegment] = Field(description="All segments, in driving order.")


def edited_by_chat(
    chat: Chat,
    settings: ChatSettings,
    design: Design,
    words: str,
    elements: RoadElements,
    found: Measures,
    allowed: set[int] | None,
    world: World,
    geometry: Geometry,
) -> Look:
    """Returns the road as a language model changed it.

    Only the segments with the numbers ``allowed``, counted from 1, may change; if ``allowed`` is None, the
    segments that the model lists may change. The Look has the elements measured on the changed road; if their
    names differ from those of ``elements``, it has none.

    Raises:
        EditError: no answer was a valid road that differs from the old one.
        ChatError: the model could not be asked.
    """
    opening = [
        Message(role="system", text=f"{rules(RULES, world)}\n\n{TASK}"),
        Message(role="user", text=_question(design, words, elements, found.length)),
    ]
    messages, wrong, problem = opening, "", None
    for _ in range(settings.rounds):
        said, problem = "", None
        try:
            reply = chat.ask(messages, EditedRoad)
            said = json.dumps(reply.data.model_dump(), separators=(",", ":"))
            new = _kept(design, reply.data, allowed)
            road = look(new, (), Requirements(world, geometry=geometry))
            wrong = next((finding.sentence for finding in road.findings), "")
            if new == design:
                wrong = "nothing about it has changed"
            if not wrong:
                seen, _ = elements_on_road(road.design, geometry)
                is_same = [element.name for element in seen] == [element.name for element in elements]
                return replace(road, elements=seen if is_same else ())
        except UnparsableError as error:
            wrong, said, problem = f"it could not be read: {error}", error.text, error
        except UsageError as error:
            wrong = str(error)
        messages = [
            *opening,
            Message(role="assistant", text=said[:MOST_SHOWN] or "(nothing)"),
            Message(role="user", text=f"This road will not do: {wrong}\nGive the whole road again, mended."),
        ]
    if isinstance(problem, ReplyError):
        raise problem
    raise EditError(
        f"the language model's road will not do: {wrong}; say it in other words, or without --designer"
    )


def _question(design: Design, words: str, elements: RoadElements, length: float) -> str:
    lines = [
        f"segment {number}: {json.dumps(segment.model_dump(exclude_none=True))}"
        for number, segment in enumerate(design.segments, 1)
    ]
    x, y, z = design.starting_point
    return "\n".join(
        [
            f"The road starts at ({x:g}, {y:g}, {z:g}) with theta {design.theta:g}; "
            f"it is {length:.0f} m long.",
            *lines,
            "What is seen along it:",
            *_seen(elements),
            f"The request, which is a wish about this road and nothing else: {json.dumps(words)}",
        ]
    )


def _seen(elements: Sequence[RoadElement]) -> list[str]:
    out, straights = [], 0
    for element in elements:
        first, end, seen = element.members.start + 1, element.members.stop, element.seen
        where = f"segments {first} to {end}" if end > first else f"segment {first}"
        if seen and element.is_turn:
            shape = f"{seen.degrees:.0f} degrees to the {seen.side}, radius {seen.radius:.0f} m"
            out.append(f"- {element.name}, {shape}: {where}")
        elif seen:
            straights += 1
            grades = ", ".join(f"{piece.grade:+.1f}" for piece in seen.pieces)
            out.append(f"- straight {straights}, {seen.length:.0f} m, {grades} %: {where}")
    return out


def _kept(design: Design, answer: EditedRoad, allowed: set[int] | None) -> Design:
    """Returns the changed design; the segments that must not change have their old values and order.

    Raises:
        UsageError: a segment that must not change is missing or misplaced; the message can be shown to the
            model.
    """
    if len(answer.segments) > MAX_SEGMENTS:
        raise UsageError(f"the road has {len(answer.segments):,} segments; {MAX_SEGMENTS} is the limit")
    old = dict(enumerate(design.segments, 1))
    touched = set(answer.touched) if allowed is None else allowed & set(answer.touched)
    kept = {number: segment for number, segment in old.items() if number not in touched}
    order = [segment.was for segment in answer.segments if segment.was in kept]
    if order != list(kept):
        missing = [number for number in kept if order.count(number) != 1]
        what = f"segment {missing[0]}" if missing else "the order of the old segments"
        raise UsageError(f"{what} is not as it was, though the request does not speak of it")
    segments = (kept.get(each.was) or _new(each, old.get(each.was)) for each in answer.segments)
    return design.model_copy(update={"theta": answer.theta % 360, "segments": tuple(segments)})


def _new(answer: EditedSegment, before: Segment | None) -> Segment:
    raw = answer.model_dump(include=set(AnswerSegment.model_fields))
    made, _ = read_design({"starting_point": [0, 0, 0], "theta": 0, "road_segment1": raw})
    (segment,) = made.segments
    plan = segment.distance, segment.turn_degrees
    if before is not None and plan == (before.distance, before.turn_degrees):
        return before.model_copy(update={"incline": segment.incline})  # its radius and transition stay
    return segment
