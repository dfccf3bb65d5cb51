"""The chat reader: asks a language model for the plan of a description, and checks it like any other plan.

The model answers in the plan language of ``roadgpt.brief.plan``; every word of the answer is looked up and
nothing is executed. If the answer is not a valid plan, the model is asked again, with a sentence that states
the error."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from string import Template
from typing import TypeVar

from pydantic import BaseModel, Field

from roadgpt.brief.feasible import check
from roadgpt.brief.junctions import MAP
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import BETWEEN, JUNCTIONS, KINDS, SCENE, WHOLE, is_junction, is_map, read_plan
from roadgpt.brief.refusal import EXAMPLE, MOST_CHARACTERS
from roadgpt.brief.scene import AROUND
from roadgpt.chat import Chat, ChatSettings, Message, configured, open_chat
from roadgpt.chat.answer import fixed_description
from roadgpt.errors import BriefError, EditError, RoadGPTError
from roadgpt.language.table import (
    FLOWS,
    LIGHTS,
    MANEUVERS,
    NUMBERS,
    OF_ITSELF,
    OF_OTHERS,
    PLACES,
    ROAD_USERS,
    ROADS,
    SURFACES,
    WEATHER,
    ManeuverRow,
)  # fmt: skip
from roadgpt.reading import read_text

MOST_PLAN = 1000  # characters of a plan; the longest useful ones have a few hundred
MOST_UNUSED = 40  # words
Answer = TypeVar("Answer", bound=BaseModel)
Read = TypeVar("Read")


def told_in(path: Path) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Returns the rules in a file, and the examples behind them: words, and the answer on the next line."""
    rules, _, examples = read_text(path).partition("---\n")
    lines = examples.splitlines()
    return rules, tuple(zip(lines[::2], lines[1::2], strict=True))


# The examples are sent as turns of the conversation: small models follow them better than rules.
def _or(names: Iterable[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} or {last}"


def _rows() -> dict[str, str]:
    """Returns what the rules tell of the table of the language."""

    def first_number(row: ManeuverRow) -> str:
        return f" ({NUMBERS[row.numbers[0]].unit})" if row.numbers and row.usual else ""

    lone, sided = ([name for name, row in PLACES.items() if bool(row.side) == has] for has in (False, True))
    airs = ((name, row, "mm/h" if row.falls else "metres of sight") for name, row in WEATHER.items())
    return {
        "who": _or(ROAD_USERS),
        "lone": _or(lone),
        "sided": ", ".join(f"{name} ({PLACES[name].said})" for name in sided),
        "actions": _or(f"{name}{first_number(MANEUVERS[name])}" for name in OF_OTHERS),
        "own_actions": _or(f"{name} car 1" if name in AROUND else name for name in OF_ITSELF),
        "sided_actions": ", ".join(name for name in OF_OTHERS if MANEUVERS[name].side),
        "flows": _or(FLOWS),
        "weather": ", ".join(f"scene {name} {row.usual[0]:g} ({unit})" for name, row, unit in airs),
        "lights": _or([*LIGHTS, *SURFACES]),
    }


RULES, EXAMPLES = told_in(Path(__file__).with_name("chat_rules.txt"))
RULES = Template(RULES).substitute(_rows())
ROAD = "road"
"""The first word of a line of "along" that holds for a whole road."""
OTHERS = re.compile(r"\bscene\b[\s:]*")
"""The first word of a line of "along" that is a part of the scene."""
ON_LINES = (
    " In your answer, what a plan has behind | is a line that begins with road, and what it has behind || is "
    'under "road"'
)

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

    along: list[str] = Field(description="What comes along the road, in driving order.")
    road: str = Field(description="What holds for the whole road.")
    unused: list[str] = Field(description="Words about the road that fit into neither, as written.")


class ChatReader:
    """Reads descriptions by asking a language model."""

    def __init__(self, settings: ChatSettings | None = None, chat: Chat | None = None) -> None:
        self._settings = settings or configured()
        self._chat = chat or open_chat(self._settings)

    def read(self, words: str) -> Brief:
        """Returns the Brief of a description, in normal form; raises BriefError if the description is empty
        or too long, or the model writes no valid plan for it, and ChatError if it cannot be asked."""
        if not words.strip():
            raise BriefError(f"the description is empty; {EXAMPLE}")
        if len(words) > MOST_CHARACTERS:
            raise BriefError(
                f"the description has {len(words):,} characters; {MOST_CHARACTERS:,} is the limit: shorten it"
            )
        opening = opening_of(RULES, EXAMPLES, words)
        return until_valid(
            self._chat,
            opening,
            PlanAnswer,
            self._settings.rounds,
            lambda data: _brief(data, words),
            _objection,
        )


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


def _brief(answer: PlanAnswer, words: str) -> Brief:
    line = _line(answer)
    if not line.strip("|/ ") or len(line) > MOST_PLAN:
        start = " ".join(words.split())[:40]
        raise BriefError(f"no road could be read out of '{start}'; {EXAMPLE}")
    brief = read_plan(line)
    check(brief, map_size=None, min_radius=0.0)  # the limits of a World are checked in brief.read
    unused = said_in(words, answer.unused)
    share = len(unused) / max(len(words.split()), 1)
    told = {"words": words, "unused": unused, "confidence": round(max(0.0, 1.0 - share), 3)}
    return normal(brief).model_copy(update=told)


def _objection(error: RoadGPTError, answer: PlanAnswer) -> str:
    where = ON_LINES if "|" in str(error) and any(map(is_junction, _things(answer))) else ""
    return f"{error}.{where and f'{where}.'} Write the plan again, for the description above."


def _line(answer: PlanAnswer) -> str:
    whole, _, scene = answer.road.partition(SCENE)
    scene = "; ".join([*(line for line in answer.along if OTHERS.match(line.strip())), scene])
    said = re.sub(r"\w+", lambda word: SAID_OF_OTHERS.get(word[0].lower(), word[0]), OTHERS.sub("", scene))
    line = _road_line([*_things(answer)], _in_our_words(whole))
    return f"{line} {SCENE} {said}" if said.strip("; ") else line


def _road_line(things: list[str], whole: str) -> str:
    if things and is_map(things[0]):
        return f"{'; '.join(things)} {WHOLE} {whole}"
    if not any(map(is_junction, things)):
        return _road([*things, f"{ROAD} {whole}"])
    parts = [
        part
        for is_place, lines in groupby(things, is_junction)
        for part in (lines if is_place else (_road([*lines]),))
    ]
    return f"{f' {BETWEEN} '.join(parts)} {WHOLE} {whole}"


def _things(answer: PlanAnswer) -> Iterator[str]:
    """Yields the lines of an answer in the words of plans; several on one line are taken apart."""
    for line in answer.along:
        if OTHERS.match(line.strip()):
            continue
        yield from filter(None, map(_in_our_words, re.split(rf";|{BETWEEN}", line)))


def _road(lines: Sequence[str]) -> str:
    clauses = [line for line in lines if line.split()[0] != ROAD]
    wishes = [line.removeprefix(ROAD) for line in lines if line.split()[0] == ROAD]
    return f"{'; '.join(clauses)} | {' '.join(wishes)}"


def _in_our_words(text: str) -> str:
    """Returns one line of a plan with its kind first and common synonyms replaced; other words stay."""
    words = [SAID.get(word.lower(), word) for word in text.replace("|", " ").replace(",", " ").split()]
    if words[:1] in ([MAP], [ROAD]):
        return " ".join(words)
    # the way straight on at a junction is not a straight
    kinds = JUNCTIONS if any(word in JUNCTIONS for word in words) else KINDS
    kind = [word for word in words if word in kinds and "(" not in text][:1]
    return " ".join([*kind, *(word for word in words if word not in kind)])


def said_in(words: str, unused: Sequence[str]) -> tuple[str, ...]:
    """Returns those of the unused words that occur in the text; any others were made up by the model."""
    there = words.lower()
    return tuple(word for word in unused[:MOST_UNUSED] if word.strip() and word.lower() in there)
