"""A small language model as designer, with and without repair: roads that are valid, and keep their words.

Replays the recording of examples/chat-replay, which takes seconds. With ``--base-url`` a server is asked what
the recording does not hold, and its answers are added to it.
"""

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

from pydantic import BaseModel

from bench_design import EVALUATION, is_kept, the_referee
from roadgpt.brief import read
from roadgpt.chat import Chat, ChatError, ChatSettings, Message, Reply, ReplyError, Spent, counting, open_chat
from roadgpt.chat.meter import Meter
from roadgpt.check import inspect
from roadgpt.design.designers.chat import ChatDesigner
from roadgpt.design.designers.thesis import ThesisDesigner
from roadgpt.errors import DesignError
from roadgpt.road import Design, World, build
from roadgpt.run import seed_of

RECORDING = Path(__file__).resolve().parents[1] / "examples" / "chat-replay"
MODEL = "qwen2.5-coder-1.5b-instruct-q4_k_m"
REFEREE = the_referee()
MOST = 400  # tokens of an answer
WAYS = {"thesis none 1": 2, "chat none 1": 3, "chat place 1": 3, "chat full 1": 3, "chat full 2": 1}
"""Designer, repair and most questions; and how many roads of each description the recording has."""
HEAD = """\
| designer, repair, questions | roads | read | valid (SBFT) | as asked (referee) | valid and as asked \
| requests | tokens | seconds |
|---|---|---|---|---|---|---|---|---|"""


@dataclass(frozen=True)
class ChatResult:
    """What came of one road."""

    words: str
    way: str
    number: int
    design: Design | None
    spent: Spent
    problem: str = ""
    is_valid: bool = False
    is_valid_for_sbft: bool = False
    is_as_asked: bool = False
    is_right: bool = False
    """By the outside referee, where it is at hand."""


class ReplayFirst:
    """Answers from the recording; asks a server for what it does not hold, and adds that."""

    def __init__(self, settings: ChatSettings, folder: Path, base_url: str | None) -> None:
        self.spent = Spent()
        self._folder = str(folder)
        self._settings, self._base_url = settings, base_url
        self._live: Chat | None = None

    def ask(self, messages: Sequence[Message], schema: type[BaseModel] | None = None) -> Reply:
        """The recorded answer, or a new one."""
        if self._base_url is None or any(Path(self._folder).glob("??/*.json")):
            replay = open_chat(self._settings.model_copy(update={"replay": self._folder}))
            try:
                return self._counted(replay, messages, schema)
            except ReplyError:
                raise
            except ChatError:
                if self._base_url is None:
                    raise
        if self._live is None:
            told = {"record": self._folder, "base_url": self._base_url}
            self._live = open_chat(self._settings.model_copy(update=told))
        return self._counted(self._live, messages, schema)

    def _counted(self, chat: Chat, messages: Sequence[Message], schema: type[BaseModel] | None) -> Reply:
        before = chat.spent
        try:
            return chat.ask(messages, schema)
        finally:
            self.spent = self.spent + chat.spent.since(before)


def made(words: str, way: str, number: int, folder: Path, base_url: str | None) -> ChatResult:
    """One road as ``roadgpt run`` makes it: of --seed NUMBER for chat, road NUMBER of --seed 1 for thesis."""
    designer_name, repair, rounds = way.split()
    told = {"repair": repair, "rounds": int(rounds), "max_completion": MOST}
    settings = ChatSettings.model_validate({"model": MODEL, "timeout": 900, "retries": 0, **told})
    chat = ReplayFirst(settings, folder, base_url)
    is_thesis = designer_name == "thesis"
    seed, index = (1, number) if is_thesis else (number, 1)
    brief, world = read(words), World()
    try:
        with counting(Meter(), f"road {index}"):
            designer = (ThesisDesigner if is_thesis else ChatDesigner)(settings, chat)
            design = designer.draft(brief, world, (), (), seed_of(seed, index))
    except (DesignError, ReplyError) as error:
        return ChatResult(words, way, number, None, chat.spent, str(error))
    road = build(design, "spline" if is_thesis else "arcs")
    found = inspect(road, brief, world)
    broken = {finding.rule for finding in found}
    return ChatResult(
        words,
        way,
        number,
        design,
        chat.spent,
        "; ".join(finding.sentence for finding in found),
        is_valid=broken <= {"promises"},
        is_valid_for_sbft=not inspect(road, None, world, "sbft"),
        is_as_asked=not any(finding.stops or finding.rule == "promises" for finding in found),
        is_right=REFEREE is not None and is_kept(road, EVALUATION[words], REFEREE),
    )


def row(name: str, roads: Sequence[ChatResult]) -> str:
    """A row of the table."""

    def number(of: Callable[[ChatResult], object]) -> int:
        return sum(bool(of(one)) for one in roads)

    counts = (
        len(roads),
        number(lambda one: one.design),
        f"{number(lambda one: one.is_valid)} ({number(lambda one: one.is_valid_for_sbft)})",
        f"{number(lambda one: one.is_as_asked)} ({number(lambda one: one.is_right) if REFEREE else '-'})",
        number(lambda one: one.is_valid and one.is_as_asked),
        f"{mean(one.spent.calls for one in roads):.1f}",
        f"{mean(one.spent.usage.total for one in roads):.0f}",
        f"{mean(one.spent.seconds for one in roads):.0f}",
    )
    return f"| {name} | {' | '.join(map(str, counts))} |"


def line(one: ChatResult) -> str:
    """A road of the recording, for the tests."""
    designer, repair, rounds = one.way.split()
    told = {"words": one.words, "designer": designer, "repair": repair, "rounds": int(rounds)}
    design = None if one.design is None else one.design.to_json()
    return json.dumps({**told, "number": one.number, "design": design, "problem": one.problem})


def main() -> None:
    """Print a row for all descriptions and for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--base-url", help="Of a server of OpenAI's protocol that has the model.")
    parser.add_argument("--recording", type=Path, default=RECORDING, help="What is replayed, and added to.")
    parser.add_argument("--ways", default=",".join(WAYS), help="Designer, repair and most questions of each.")
    parser.add_argument("--roads", type=int, help="Of each description; as many as are recorded.")
    parser.add_argument("--write", type=Path, help="Write every road to this file, as JSON lines.")
    asked = parser.parse_args()
    every: list[ChatResult] = []
    for way in asked.ways.split(","):
        for number in range(1, (asked.roads or WAYS[way]) + 1):
            for words in EVALUATION:
                every.append(made(words, way, number, asked.recording, asked.base_url))
                if asked.base_url:
                    print(f"    {every[-1]}", flush=True)
    print(HEAD)
    for way in asked.ways.split(","):
        roads = [one for one in every if one.way == way]
        print(row(f"{way}: all", roads))
        for words in EVALUATION:
            print(row(f"{way}: {words}", [one for one in roads if one.words == words]))
    if asked.write:
        asked.write.write_text("".join(f"{line(one)}\n" for one in every), encoding="utf-8")


if __name__ == "__main__":
    main()
