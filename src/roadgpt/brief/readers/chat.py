"""The chat reader: asks a language model for the plan of a description, and checks it like any other plan.

The model answers in the plan language of ``roadgpt.brief.plan``, whose rules it is told from the table of the
language; every word of the answer is looked up and nothing is executed. If the answer is not a valid plan, or
what it tells cannot be built or does not happen, the model is asked again, with all that is wrong."""

import re
from collections.abc import Callable, Iterable, Sequence
from itertools import groupby
from pathlib import Path
from string import Template
from typing import Any, TypeVar

from pydantic import BaseModel, Field

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import SCENE, SCENE_PART, objections, read_plan
from roadgpt.brief.readers.model.mentions import unused_in
from roadgpt.brief.refusal import EXAMPLE, MOST_CHARACTERS
from roadgpt.brief.scene import AROUND, Role
from roadgpt.chat import Chat, ChatSettings, Message, configured, open_chat
from roadgpt.chat.answer import fixed_description
from roadgpt.errors import BriefError, EditError, RoadGPTError
from roadgpt.language.names import What
from roadgpt.language.table import (
    ANYWHERE,
    FLOWS,
    LANDFORMS,
    LIGHTS,
    MANEUVERS,
    MOVING,
    NUMBERS,
    OF_ITSELF,
    OF_OTHERS,
    PLACES,
    ROAD_USERS,
    ROADS,
    SCENES,
    SURFACES,
    WEATHER,
)
from roadgpt.reading import read_text

MOST_PLAN = 1500  # characters of a plan; the longest useful ones have a few hundred
MOST_UNUSED = 40  # words
ALONG = {*SCENES["sets"]["along"]}
Answer = TypeVar("Answer", bound=BaseModel)
Read = TypeVar("Read")


def told_in(path: Path) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Returns the rules in a file, and the examples behind them: words, and the answer on the next line. The
    examples are sent as turns of the conversation: small models follow them better than rules."""
    rules, _, examples = read_text(path).partition("---\n")
    lines = examples.splitlines()
    return rules, tuple(zip(lines[::2], lines[1::2], strict=True))


def _or(names: Iterable[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} or {last}"


def _rows() -> dict[str, str]:
    """Returns what the rules tell of the table of the language."""
    lone, sided = ([name for name, row in PLACES.items() if bool(row.side) == has] for has in (False, True))
    airs = ((name, row.usual[0], "mm/h" if row.falls else "metres of sight") for name, row in WEATHER.items())
    own = (_action(name, *["car 1"] * (name in AROUND)) for name in OF_ITSELF)
    return {
        "who": _or(ROAD_USERS),
        "lone": _or(lone),
        "sided": ", ".join(f"{name} ({PLACES[name].said})" for name in sided),
        "numbers": _by_place([*filter(NUMBERS.get, Role.model_fields)], NUMBERS, "where", _number),
        "actions": _by_place(OF_OTHERS, MANEUVERS, "starts", _action),
        "of_persons": _or(name for name in OF_OTHERS if {*MOVING} <= {*MANEUVERS[name].who}),
        "own_actions": ", ".join(own),
        "flows": _or(FLOWS),
        "weather": ", ".join(f"{name} {usual:g} ({unit})" for name, usual, unit in airs),
        "lights": _or(LIGHTS),
        "surfaces": _or(SURFACES),
        "land": _or(LANDFORMS),
    }


def _number(name: str) -> str:
    return f"{NUMBERS[name].key}= ({NUMBERS[name].said.format('..')})"


def _action(name: What, *whom: str) -> str:
    row = MANEUVERS[name]
    keys = [NUMBERS[each].key for each in row.numbers]
    usual = "" if row.usual is None else f" (usually {row.usual:g})"
    numbers = [] if whom else [*(f"[{key}]{usual}" for key in keys[:1]), *(f"{key}=" for key in keys[1:])]
    return " ".join([name, *whom, *["left|right"] * row.side, *numbers])


def _by_place(names: Sequence[Any], rows: Any, places: str, said: Callable[[Any], str]) -> str:
    """Returns what the rows say, those for the same places on one line, the widest first."""

    def where(name: Any) -> tuple[int, str]:
        those = getattr(rows[name], places)
        along = ["along"] * ({*those} >= ALONG)
        named = [*along, *(each for each in those if not (along and each in ALONG))]
        return -len(those), "anywhere" if len(those) == len(ANYWHERE) else ", ".join(named)

    lines = groupby(sorted(names, key=where), where)
    return "\n".join(f"  {of}: {', '.join(map(said, those))}" for (_, of), those in lines)


RULES, EXAMPLES = told_in(Path(__file__).with_name("chat_rules.txt"))
RULES = Template(RULES).substitute(_rows())

WORD = re.compile(r"(?<![\w=+-])[\w-]+(?![\w=-])")
# Words that models write instead of those of the plan language, in spite of the rules.
SAID = {
    name.lower().replace(" ", "_"): kind
    for part in ("features", "slopes", "junctions", "controls")
    for kind, row in ROADS[part].items()
    for name in (*row["names"], *row.get("also", ()))
}
SAID_OF_OTHERS = {
    one.lower(): str(kind)
    for kind, row in reversed([*ROAD_USERS.items()])
    for words in (row.words, row.also, row.unseen)
    for one, _ in words.get("en", ())
    if one.isalpha() and one not in ROAD_USERS
}


class PlanAnswer(BaseModel):
    """The form of the language model's answer: the two parts of a plan, and the words left over."""

    model_config = fixed_description("What the model is asked for.")

    road: str = Field(description="What the tested car drives on.")
    scene: list[str] = Field(
        description="Who else is there, what happens, and under which conditions.",
        json_schema_extra={"items": {"type": "string", "pattern": SCENE_PART}},
    )
    unused: list[str] = Field(description="Words about road or scene that fit into neither, as written.")


class ChatReader:
    """Reads descriptions by asking a language model."""

    takes_trials = True

    def __init__(self, settings: ChatSettings | None = None, chat: Chat | None = None) -> None:
        self._settings = settings or configured()
        self._chat = chat or open_chat(self._settings)

    def read(self, words: str, trial: Callable[[Brief], Sequence[str]] | None = None) -> Brief:
        """Returns the Brief of a description, in normal form. What ``trial`` says of it goes back to the
        model, too; where that has no better plan, the Brief of the last valid one is returned.

        Raises BriefError if the description is empty or too long, or the model writes no valid plan for it,
        and ChatError if it cannot be asked."""
        if not words.strip():
            raise BriefError(f"the description is empty; {EXAMPLE}")
        if len(words) > MOST_CHARACTERS:
            raise BriefError(
                f"the description has {len(words):,} characters; {MOST_CHARACTERS:,} is the limit: shorten it"
            )
        told, valid = list[str](), list[Brief]()

        def read(answer: PlanAnswer) -> Brief:
            valid.append(brief := _brief(answer, words))
            is_last = len(told) + 1 >= self._settings.rounds
            said = () if is_last else (*lost(brief, words), *(trial(brief) if trial else ()))
            if said:
                raise BriefError("\n".join(said))
            return brief

        def objection(error: RoadGPTError, answer: PlanAnswer) -> str:
            said = objections(_line(answer)) or str(error).split("\n")
            told.append("; ".join(said))
            return again(said, "description")

        opening = opening_of(RULES, EXAMPLES, words)
        try:
            brief = until_valid(self._chat, opening, PlanAnswer, self._settings.rounds, read, objection)
        except BriefError:
            if not valid:
                raise
            brief = valid[-1]
        return brief.model_copy(update={"rounds": tuple(told)})


def opening_of(rules: str, examples: Sequence[tuple[str, str]], words: str) -> list[Message]:
    """Returns the rules, the examples as earlier turns of the conversation, and the words to be read."""
    turns = [Message(role="system", text=rules)]
    for asked, answer in examples:
        turns += [Message(role="user", text=asked), Message(role="assistant", text=answer)]
    return [*turns, Message(role="user", text=words)]


def until_valid(
    chat: Chat,
    opening: Sequence[Message],
    schema: type[Answer],
    rounds: int,
    read: Callable[[Answer], Read],
    objection: Callable[[RoadGPTError, Answer], str],
) -> Read:
    """Returns what ``read`` makes of a model's answer. If it raises an error, the model is asked again, with
    an objection, in up to ``rounds`` questions."""
    asked = [*opening]
    for left in reversed(range(rounds)):
        answer: Answer = chat.ask(asked, schema).data
        try:
            return read(answer)
        except (BriefError, EditError) as error:
            if not left:
                raise
            written = Message(role="assistant", text=answer.model_dump_json()[:MOST_PLAN])
            asked = [*opening, written, Message(role="user", text=objection(error, answer))]
    raise ValueError("a model is asked at least once")


def again(said: Sequence[str], what: str) -> str:
    """Returns the message that asks for another answer, because of objections to the one before."""
    rows = "".join(f"- {each}\n" for each in said)
    return f"This plan cannot be used as it is:\n{rows}Write the whole answer again, for the {what} above."


def lost(brief: Brief, words: str) -> list[str]:
    """Returns sentences on the road users and the weather that the words name and a Brief has not, neither in
    its scene nor among its unused words."""
    unused = " ".join(brief.unused).lower()
    return [
        f"the description says '{word}', and the scene has no {name}: add it, or put the word under 'unused' "
        "if it is nobody and nothing there"
        for word, name in unused_in(brief, words).items()
        if name in {*ROAD_USERS, *WEATHER} and word.lower() not in unused
    ]


def _brief(answer: PlanAnswer, words: str) -> Brief:
    line = _line(answer)
    if not line.strip("|/& ") or len(line) > MOST_PLAN:
        start = " ".join(words.split())[:40]
        raise BriefError(f"no road could be read out of '{start}'; {EXAMPLE}")
    brief = read_plan(line)
    check(brief, map_size=None, min_radius=0.0)  # the limits of a World are checked in brief.read
    unused = said_in(words, answer.unused)
    share = len(unused) / max(len(words.split()), 1)
    told = {"words": words, "unused": unused, "confidence": round(max(0.0, 1.0 - share), 3)}
    return normal(brief).model_copy(update=told)


def _line(answer: PlanAnswer) -> str:
    """Returns the plan of an answer, with common synonyms in the words of plans."""
    road = WORD.sub(lambda word: SAID.get(word[0].lower(), word[0]), answer.road)
    scene = WORD.sub(lambda word: SAID_OF_OTHERS.get(word[0].lower(), word[0]), "; ".join(answer.scene))
    return f"{road} {SCENE} {scene}" if scene.strip("; ") else road


def said_in(words: str, unused: Sequence[str]) -> tuple[str, ...]:
    """Returns those of the unused words that occur in the text; any others were made up by the model."""
    there = words.lower()
    return tuple(word for word in unused[:MOST_UNUSED] if word.strip() and word.lower() in there)
