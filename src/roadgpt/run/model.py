"""Defines the Run, which holds everything about one road from words to verdict, and its Request and seed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
from pydantic import SerializerFunctionWrapHandler, model_serializer

from roadgpt.brief.model import Brief, Frozen
from roadgpt.chat import ChatSettings, Spent
from roadgpt.check import Finding
from roadgpt.design import DesignReport
from roadgpt.drive import Drive
from roadgpt.drive.loading import driver_from_file, needs_permission
from roadgpt.errors import GivenUpError, UsageError
from roadgpt.road import Design, Road, World
from roadgpt.road.world import Parts
from roadgpt.verdict import Verdict

Outcome = Literal["PASS", "VALID", "UNAVOIDABLE", "NOT TESTED", "FAIL", "INVALID", "ERROR"]
"""The outcome of a Run, from the best to the worst. UNAVOIDABLE: a collision that no careful driver could
have avoided, which is no failure. NOT TESTED: what the scene prescribes did not happen, because the driver
was not as fast as it prescribes. VALID: the road breaks no rule and was not driven."""
SEED_BITS = 53  # so that a seed survives every JSON reader


class Setup(Parts):
    """Names the plug-ins that make and drive roads, with their options."""

    drives: bool = True
    """Whether roads are driven; if False, they are only designed and checked."""
    chat: ChatSettings | None = None
    """The language model for readers and designers that use one; None for the model in the user's
    settings."""

    @model_serializer(mode="wrap")
    def _to_file(self, fields: SerializerFunctionWrapHandler) -> dict[str, Any]:
        values: dict[str, Any] = fields(self)
        return {name: value for name, value in values.items() if value or name not in ("tracks", "scenario")}

    def staged(self, world: World, left_hand: bool) -> World:
        """Returns the World with the scene of the scenario for a side of traffic, and what its own adds, and
        with the scenario's criterion, if none was given to this World."""
        if not self.scenario:
            return world
        from roadgpt.brief.scenarios import scenario

        one, given = scenario(self.scenario), world.limits.avoidable
        return world.changed(scene=one.onto(world.scene, left_hand), avoidable=given or one.avoidable)

    def essence(self) -> Self:
        """Returns the Setup without the fields that may change when interrupted work is continued."""
        return self.model_copy(update={"chat": self.chat and self.chat.essence()})

    def came_with(self, file: object) -> Self:
        """Returns a copy that is marked as coming from a file of unknown origin, see ``roadgpt.provenance``:
        a driver in a Python file, recorded tracks and the language model's server are used only if the user
        names or permits them."""
        driver, tracks = (driver_from_file(each, file) for each in (self.driver, self.tracks))
        chat = self.chat and self.chat.came_with(file)
        return self.model_copy(update={"driver": driver, "tracks": tracks, "chat": chat})


def permissions(setups: Sequence[Setup], asks: bool = False, replays: bool = False) -> list[str]:
    """Returns the options that permit drivers' files, servers if a command ``asks`` language models, and
    recorded tracks if it ``replays`` them."""
    pairs = [("--driver", setup.driver) for setup in setups if needs_permission(setup.driver)]
    chats = [setup.chat for setup in setups if setup.chat and asks]
    pairs += [("--base-url", chat.base_url) for chat in chats if chat.base_url]
    pairs += [("--tracks", setup.tracks) for setup in setups if setup.tracks and replays]
    return [word for pair in dict.fromkeys(pairs) for word in pair]


class Request(Frozen):
    """The values that roads are made from, except for their number; the same Request gives the same files,
    except for times."""

    words: str = ""
    """The description; empty if the roads were not made from words."""
    seed: int = 0
    world: World = World()
    setup: Setup = Setup()

    def settings(self) -> dict[str, Any]:
        """Returns the values that may not change when an interrupted campaign is continued, by name."""
        return {"words": self.words, "seed": self.seed, **dict(self.setup.essence()), **self.world.values()}

    def came_with(self, file: object) -> Self:
        """Returns a copy that is marked as coming from a file of unknown origin, see ``Setup.came_with``."""
        given = self.setup.model_fields_set | self.world.limits.model_fields_set
        if not given >= {"driver", "oob_tolerance"}:
            raise UsageError(f"{file} lacks driver or oob_tolerance, whose defaults have changed; add them")
        beside = Path(str(file)).parent
        world = self.world.with_heights_in(beside, beside.parent.parent)  # of one run, or of all in a folder
        return self.model_copy(update={"setup": self.setup.came_with(file), "world": world})


@dataclass(frozen=True)
class Seconds:
    """The wall-clock times of a Run, which differ when it is repeated."""

    design: float = 0.0  # seconds of reading, designing and checking
    drive: float = 0.0  # seconds of driving and judging

    @property
    def total(self) -> float:
        """Total wall-clock seconds."""
        return self.design + self.drive


@dataclass(frozen=True, eq=False)
class Run:
    """Everything about one road from words to verdict. Results of stages that were not reached are None."""

    request: Request
    index: int
    """Number of the road in its campaign, from 1."""
    seed: int
    """The road's own seed, derived from the campaign's seed; for an existing road that is only driven, the
    campaign's seed."""
    outcome: Outcome = "VALID"
    description: str = "valid, not driven"
    """The outcome in a sentence."""
    brief: Brief | None = None
    design: Design | None = None
    road: Road | None = None
    findings: tuple[Finding, ...] = ()
    drive: Drive | None = None
    verdict: Verdict | None = None
    rounds: int = 0
    """Number of drafts that the designer made."""
    designing: DesignReport | None = None
    """The designer's report on its draft, if it used a language model."""
    spent: Spent | None = None
    """Tokens, seconds and money spent on language models for this road; None if none were used."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """What decided the results besides the request, see ``run.versions``."""
    driver_files: Mapping[str, str] = field(default_factory=dict)
    """Digests of all files that the driver's process has used so far; not written to disk."""
    source: str = ""
    """Name of the file that the road was read from, or the change request; used in headings."""
    trace: str = ""
    """The traceback of a simulator or a driver that failed; empty if none failed."""
    is_lost: bool = False
    """True if the simulator itself failed; this field is not written to disk."""
    seconds: Seconds = Seconds()

    def __repr__(self) -> str:
        made = f"{self.title!r}, {self.length:.0f} m, seed {self.seed}"
        return f"Run({self.index}, {self.outcome}: {self.description}; {made})"

    @property
    def words(self) -> str:
        """The description that the road was made from."""
        return self.request.words

    @property
    def title(self) -> str:
        """The scenario with its parameters, and the description, or else the road's source; never empty."""
        said = (self.request.setup.scenario, self.words or self.source)
        return ": ".join(filter(None, said)) or "a road without a description"

    @property
    def plain_design(self) -> Design | None:
        """The design of a single road; None if there is none, or if it has junctions or is a map."""
        return self.design if self.design is not None and self.design.is_plain else None

    @property
    def world(self) -> World:
        """The map, the friction, the default lanes, the limits of the rules, and the scene with the weather
        that the drive has drawn."""
        return self.request.world.in_weather_of(self.seed)

    @property
    def is_valid(self) -> bool:
        """True if there is a road and it breaks no rule."""
        return self.road is not None and not self.findings

    @property
    def validation_message(self) -> str:
        """The message of the first broken rule, or why there is no road; empty for a valid road."""
        if self.findings:
            return self.findings[0].sentence
        return "" if self.road else self.description

    @property
    def length(self) -> float:
        """Length of the road in plan, metres; 0 if there is no road."""
        return self.road.length if self.road else 0.0


def seed_of(seed: int, index: int) -> int:
    """Returns the seed of road ``index`` (from 1) of the campaign with seed ``seed``.

    The seed comes from numpy's SeedSequence, so that campaigns with consecutive seeds, such as 1 and 2, have
    no road in common. numpy guarantees that SeedSequence gives the same numbers in all versions."""
    if seed < 0:
        raise UsageError(f"{seed} is no seed; give a whole number from 0 up")
    drawn = np.random.SeedSequence([seed, index]).generate_state(1, np.uint64)[0]
    return int(drawn) >> (64 - SEED_BITS)


MOST = 3  # lost drives in a row; each may have cost minutes of waiting for the simulator to start


def given_up(reason: str, again: str) -> GivenUpError:
    """Returns the error for a simulator that has lost ``MOST`` drives in a row: with the message of the last
    one, and how the rest can be driven later."""
    return GivenUpError(f"the simulator failed {MOST} times in a row and is given up ({reason}); {again}")
