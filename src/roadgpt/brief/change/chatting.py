"""Asks a language model for the plan of a change request, and checks the plan like any other.

The model answers in the language of ``roadgpt.brief.change.plan``. If the answer is not a valid plan, it is
asked again, with a sentence that states the error."""

from dataclasses import replace
from pathlib import Path

from pydantic import BaseModel, Field

from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.change.request import EditRequest, refuse_clashes
from roadgpt.brief.change.spoken import spoken
from roadgpt.brief.plan import SCENE
from roadgpt.brief.readers.chat import MOST_PLAN, again, opening_of, said_in, told_in, until_valid
from roadgpt.chat import ChatSettings, open_chat
from roadgpt.chat.answer import fixed_description
from roadgpt.errors import EditError, RoadGPTError

RULES, EXAMPLES = told_in(Path(__file__).with_name("chat_rules.txt"))


class ChangeAnswer(BaseModel):
    """The form of the language model's answer."""

    model_config = fixed_description("What the model is asked for.")

    changes: list[str] = Field(description="The changes of the road, one line each.")
    scene: list[str] = Field(description="The changes of the scene, one line each.")
    unused: list[str] = Field(description="Words of the request that fit into none, as written.")


def request_by_chat(words: str, settings: ChatSettings, surface: str = "") -> EditRequest:
    """Returns a change request as a language model reads it; raises EditError if it writes no valid plan.
    ``surface`` is what the words say of the surface, which may be all that they ask for."""

    def read(answer: ChangeAnswer) -> EditRequest:
        unused, line = said_in(words, answer.unused), _line(answer)[:MOST_PLAN]
        if surface and not line:
            return EditRequest(words, (), unused, surface=surface)
        request = spoken(read_change_plan(line))
        refuse_clashes(request.changes)
        return replace(request, words=words, unused=unused, surface=surface)

    chat, opening = open_chat(settings), opening_of(RULES, EXAMPLES, words)
    try:
        return until_valid(chat, opening, ChangeAnswer, settings.rounds, read, _objection)
    except EditError as error:
        raise EditError(f"the language model's plan cannot be used: {error}") from error


def _line(answer: ChangeAnswer) -> str:
    road, scene = "; ".join(answer.changes), "; ".join(answer.scene)
    return f"{road} {SCENE} {scene}" if scene else road


def _objection(error: RoadGPTError, answer: ChangeAnswer) -> str:
    del answer
    return again([str(error)], "request")
