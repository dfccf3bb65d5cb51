"""Writes pairs as chats for fine-tuning a larger language model to answer a description with a Brief or a
Design.
"""

import json
from collections.abc import Iterable, Iterator

from roadgpt.brief.plan import read_plan
from roadgpt.brief.refusal import refused
from roadgpt.design import draft
from roadgpt.errors import DesignError
from roadgpt.road import World
from roadgpt_training.pair import Pair

TO_BRIEF = (
    "Read the description of a road and answer with its Brief as JSON. If no road can be built, say why."
)
TO_DESIGN = "Design a road for the description and answer with its road segments as JSON."


def brief_chats(pairs: Iterable[Pair]) -> Iterator[str]:
    """Yields one line of JSON for each pair: a chat in which a description is answered with its Brief. If the
    plan is a refusal, the answer is a sentence of advice."""
    for pair in pairs:
        if pair.is_refusal:
            answer = str(refused(pair.plan))
        else:
            answer = read_plan(pair.plan).model_dump_json(exclude_defaults=True)
        yield _chat(TO_BRIEF, pair.text, answer)


def design_chats(pairs: Iterable[Pair], world: World, seed: int) -> Iterator[str]:
    """Yields chats in which a description is answered with a Design, one line of JSON each.

    Refusals, and descriptions for which no road can be designed, are skipped.
    """
    for number, pair in enumerate(pairs):
        if pair.is_refusal:
            continue
        try:
            design = draft(read_plan(pair.plan), world, seed=seed + number)
        except DesignError:
            continue
        yield _chat(TO_DESIGN, pair.text, json.dumps(design.to_json()))


def _chat(system: str, user: str, answer: str) -> str:
    roles = (("system", system), ("user", user), ("assistant", answer))
    return json.dumps(
        {"messages": [{"role": role, "content": text} for role, text in roles]}, ensure_ascii=False
    )
