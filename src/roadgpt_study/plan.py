"""Defines a study: its prompts and its parts. The file ``study.json`` in a study's folder contains the
definition. Prompts are read from JSON lines with the keys ``id``, ``prompt`` and ``truth``."""

from importlib.resources import files
from pathlib import Path
from typing import Literal, NamedTuple

from pydantic import Field, ValidationError

from roadgpt import plugins
from roadgpt.brief.model import Frozen
from roadgpt.chat import asks_a_model
from roadgpt.check.truth import Truth
from roadgpt.errors import UsageError, explained
from roadgpt.reading import json_of, read_model, read_text
from roadgpt.road import ORACLES, Limits, World
from roadgpt.run import Setup
from roadgpt.run.atomic import is_new, json_text, write_whole
from roadgpt.run.folder import slug

CARD = "study.json"
MOST = 10_000  # prompts in a file
LETTERS = 32  # of a description, in the name of its folder

Kind = Literal["thesis", "alignment"]


class Prompt(Frozen):
    """A description of a road, with the requirements that people wrote down for it, if any."""

    id: str = Field(min_length=1, max_length=80)
    prompt: str = Field(min_length=1, max_length=10_000)
    truth: Truth | None = None
    """The requirements that people wrote down; None: roads are checked against the requirements that the
    reader finds."""


class StudyPart(NamedTuple):
    """One part of a study: the roads that one designer makes from one description."""

    designer: str
    number: int  # number of the prompt in the study, counted from 1
    prompt: Prompt

    @property
    def name(self) -> str:
        """The path of the folder of this part, relative to the study's folder, with forward slashes."""
        words = slug(self.prompt.prompt)[:LETTERS].strip("-")
        return f"{slug(self.designer)}/{self.number:02d}-{words}"


class StudyPlan(Frozen):
    """The definition of a study; two studies with the same plan have the same files."""

    format: Literal[1] = 1
    kind: Kind
    prompts: tuple[Prompt, ...]
    designers: tuple[str, ...] = Field(min_length=1)
    roads: int = Field(ge=1)
    """Number of roads for each prompt and designer."""
    seed: int = 0
    world: World = World(limits=Limits(**ORACLES["thesis"]))
    setup: Setup = Setup(driver="beamng_like")
    """Reader, driver, simulator and language model. ``setup_of`` fills in the designer and selects the
    strict rules."""
    source: str = ""
    """Name of the file with the prompts; empty for the thesis' prompts."""
    command: str = ""
    """The command with which users can repeat the study."""

    def parts(self) -> tuple[StudyPart, ...]:
        """Returns all parts, one for each designer and prompt, ordered by designer and then by prompt."""
        return tuple(
            StudyPart(designer, number, prompt)
            for designer in self.designers
            for number, prompt in enumerate(self.prompts, 1)
        )

    def setup_of(self, designer: str) -> Setup:
        """Returns the setup for one designer, with a language model only if designer or reader ask one."""
        asks = asks_a_model(plugins.find("designers", designer)) or asks_a_model(
            plugins.find("readers", self.setup.reader.partition(":")[0])
        )
        chat = self.setup.chat if asks else None
        return self.setup.model_copy(update={"designer": designer, "rules": "strict", "chat": chat})

    def essence(self) -> "StudyPlan":
        """Returns the plan without the settings that may change when an interrupted study is resumed."""
        return self.model_copy(update={"setup": self.setup.essence()})


def open_folder(plan: StudyPlan, folder: Path) -> None:
    """Creates a study's folder, or checks that it holds the same study with as many or fewer roads and
    designers, and writes ``study.json``."""
    with explained(UsageError, f"cannot use {folder}", "name another folder"):
        folder.mkdir(parents=True, exist_ok=True)
        if (folder / CARD).is_file():
            _same(read_plan(folder), plan, folder)
        elif not is_new(folder, CARD):
            raise UsageError(f"{folder} is not empty and holds no study; name another folder")
        write_whole(folder / CARD, json_text(plan.model_dump(mode="json", by_alias=True)))


def _same(there: StudyPlan, asked: StudyPlan, folder: Path) -> None:
    one, other = there.essence(), asked.essence()
    if one.setup.chat is None:  # no model was asked yet, so the first designer that asks one may join
        other = other.model_copy(update={"setup": other.setup.model_copy(update={"chat": None})})
    free = ("roads", "designers", "source", "command")  # more roads and more designers may join
    differs = [name for name in type(one).model_fields if getattr(one, name) != getattr(other, name)]
    wrong = [name for name in differs if name not in free]
    if wrong:
        raise UsageError(
            f"{folder} holds another study (other {' and '.join(wrong)}); name another folder, or add --again"
        )
    if asked.roads < there.roads:
        raise UsageError(f"{folder} holds a study of {there.roads} roads each; ask for as many or more")
    lost = [name for name in there.designers if name not in asked.designers]
    if lost:
        raise UsageError(
            f"{folder} holds roads by {' and '.join(lost)} as well; give --designer {lost[0]} as well"
        )


def read_plan(folder: Path) -> StudyPlan:
    """Returns the plan in a study's folder."""
    absent = f"there is no study in {folder}; give the folder of a study"
    plan = read_model(StudyPlan, folder / CARD, "the card of a study", absent)
    return plan.model_copy(update={"setup": plan.setup.came_with(folder / CARD)})


def read_prompts(path: Path) -> tuple[Prompt, ...]:
    """Returns the prompts of a file, in the order of the file."""
    try:
        text = read_text(path, 4_000_000, "a file of prompts", "utf-8-sig")
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}; give a file of JSON lines") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} is no text in UTF-8; give a file of JSON lines") from error
    return _prompts(text, str(path))


def thesis_prompts() -> tuple[Prompt, ...]:
    """Returns the three descriptions of the thesis' table of valid roads, and two more from its survey."""
    return _prompts(files("roadgpt_study").joinpath("data/thesis.jsonl").read_text("utf-8"), "thesis.jsonl")


def _prompts(text: str, name: str) -> tuple[Prompt, ...]:
    found: dict[str, Prompt] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        prompt = _prompt(number, line, f"{name}, line {number}")
        if prompt.id in found:
            raise UsageError(f"{name}, line {number}: the id '{prompt.id}' stands there twice")
        found[prompt.id] = prompt
    if not found:
        raise UsageError(f'{name} holds no prompt; give lines such as {{"id": "1", "prompt": "a road"}}')
    if len(found) > MOST:
        raise UsageError(f"{name} holds {len(found)} prompts; give {MOST:,} at most")
    return tuple(found.values())


def _prompt(number: int, text: str, where: str) -> Prompt:
    try:
        data = json_of(text)
    except ValueError as error:
        raise UsageError(f"{where} is no JSON ({error})") from error
    if not isinstance(data, dict):
        raise UsageError(f'{where} is no object; give lines such as {{"id": "1", "prompt": "a road"}}')
    data.setdefault("id", str(number))
    if isinstance(data["id"], int):
        data["id"] = str(data["id"])
    try:
        return Prompt.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise UsageError(f"{where}, {place}: {first['msg'].removeprefix('Value error, ')}") from error
