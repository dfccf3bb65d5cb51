"""A maneuver: an action of a scene with the numbers that were drawn for it, and the phases it consists of."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.brief.amount import Frozen, exactly
from roadgpt.brief.scene import Action
from roadgpt.language.names import ActorKind, What
from roadgpt.language.table import CUES, MANEUVERS, NUMBERS, ROAD_USERS

ROLL = 4.0  # s, after which the first action begins whose begin the scene leaves open
FAST = 250.0 / 3.6  # m/s, the most that a scene can ask for
BRAKE, STOP = (MANEUVERS[what].usual or 0.0 for what in ("brake", "stop"))
CHANGE = 2.0  # m/s^2
REVERSING = (MANEUVERS["reverse"].usual or 0.0) / 3.6  # m/s
TURNING = 20.0 / 3.6  # m/s, of vehicles that turn at a junction, at most
LATERAL: Mapping[What, float] = {
    "swerve": 0.5, "drift": 0.5, "cut_in": 1.5, "cut_out": 1.5, "change_lane": 1.0, "overtake": 1.5,
    "pull_out": 1.0, "wrong_way": 1.0, "pass": 1.0, "pull_over": 1.0,
}  # fmt: skip
"""The greatest speed sideways in m/s."""
PATH, RUNS, RUNNING_PATH = 1.0, 6.0 / 3.6, 1.5
"""Euro NCAP's persons reach their speed within 1 m (CPNA), or 1.5 m if they run (CPFA)."""
QUICKEST = 10.0  # m/s^2, with which a person starts at most
SCALES: Mapping[str, float] = {
    "speed": 1 / 3.6, "faster": 1 / 3.6, "to": 1 / 3.6, "overlap": 0.01, "impact": 0.01,
    "angle": math.pi / 180,
}  # fmt: skip


@dataclass(eq=False)
class Maneuver:
    """An action, and the numbers that were drawn for it, in metres, seconds and shares. Two of them are never
    equal: a second swerve is another one."""

    action: Action
    n: dict[str, float]
    before: int = 0
    """How many of its kind the same one does before it."""
    rolls: float = ROLL
    """After how many seconds it begins if nothing is said, or what is said is so from the begin on."""
    is_at_line: bool = False
    """Whether its gap is that when it leads over the line into the lane of whom one meets."""

    @property
    def what(self) -> What:
        """What is done."""
        return self.action.what

    @property
    def event(self) -> tuple[str, ...] | None:
        """What somebody else does, on which it begins."""
        mark = self.action.at
        return (mark.word, mark.of, str(mark.number), mark.what) if mark and mark.what else None

    @property
    def said(self) -> str:
        """What is done, in words, with the numbers that were drawn."""
        drawn = {
            field: exactly(round(self.n[field] / SCALES.get(field, 1.0), 1))
            for field in {*NUMBERS} & {*self.n}
            if (asked := getattr(self.action, field, None)) and not asked.exact
        }
        return str(self.action.model_copy(update=drawn))

    @property
    def is_open(self) -> bool:
        """Whether the scene leaves open when it begins."""
        return self.event is None and not {*CUES} & {*self.n}

    def slides(self, by: float, most: float) -> float:
        """Returns how many seconds it moves sideways by some metres, with at most so many m/s^2."""
        lasts = math.pi / 2 * abs(by) / self.n.get("lateral", LATERAL[self.what])
        if "duration" in self.n and "lateral" not in self.n:
            lasts = self.n["duration"] * (0.5 if self.what == "swerve" else 1.0)
        return max(lasts, math.pi * math.sqrt(abs(by) / 2 / most), 1e-3)


def drawn(thing: Frozen, rng: np.random.Generator) -> dict[str, float]:
    """Returns a number for each range of a part of a scene, in metres, seconds and shares."""
    found = {}
    for field, number in NUMBERS.items():
        amount = getattr(thing, field, None)
        if amount is not None:
            low = number.least if amount.lo is None else amount.lo
            high = number.most if amount.hi is None else amount.hi
            one = float(rng.uniform(low, high)) if low < high else low
            found[field] = one * SCALES.get(field, 1.0)
    return found


def starting(kind: ActorKind, speed: float) -> float:
    """Returns with which acceleration somebody starts to move that will have a speed."""
    path = RUNNING_PATH if speed > RUNS else PATH
    return ROAD_USERS[kind].pull or min(max(speed**2 / 2 / path, 0.1), QUICKEST)


class Phase(NamedTuple):
    """A part of a maneuver."""

    goal: float | None = None
    """The speed in m/s that it comes to, by ``pull``; negative backwards, None: as it is."""
    pull: float = CHANGE
    to: float | None = None
    """Where it moves to sideways, in metres to the left of the way, within ``slides`` seconds."""
    slides: float = 0.0
    lasts: float | None = None
    """After how many seconds it ends at the latest; the speed that is reached by then stays."""
    until: Literal["speed", "there", "passed", "met", "shunted", "beyond"] | None = None
    follows: float | None = None
    """The headway in seconds that it keeps to whom it meets."""
