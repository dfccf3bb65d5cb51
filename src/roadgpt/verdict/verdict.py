"""Defines the Verdict: whether the car kept its lane, by which margin, and where it first failed.

The levels of severity say how far outside its lane a car was, and colour all pictures, pages, tables and
terminal output. A car that passes a test may have been partly outside its lane, and with a tolerance above
0.5, such as that of RoadGPT's thesis, even mostly.
"""

import json
import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import AliasChoices, ConfigDict, Field, ValidationError

from roadgpt.brief.scene import Event
from roadgpt.errors import UsageError
from roadgpt.language.names import Face
from roadgpt.reading import strictly

JUDGEMENT = 2
"""The version of the rules by which drives are judged, raised when the same drive may be judged otherwise. It
stands in the versions of every record; a record without it was judged by version 1."""
Outcome = Literal["PASS", "UNAVOIDABLE", "NOT TESTED", "FAIL", "INVALID"]
"""UNAVOIDABLE: a collision that no driver could have avoided, which is no failure. NOT TESTED, INVALID: the
car kept its lane, but what the scene prescribes did not happen: for its driver alone, or for any."""
Cause = Literal[
    "out of lane", "fell", "rolled", "crashed", "sank", "stuck", "timeout", "collision", "wrong turn",
    "wrong way", "stop line",
    "red light", "failure to yield", "task",
]  # fmt: skip
DEPARTURES: tuple[Cause, ...] = ("out of lane", "fell", "rolled", "crashed", "sank")
"""The causes by which the car is beside its lane."""
Side = Literal["left", "right"]
Severity = Literal["at most 10 % outside", "partly outside", "mostly outside"]
SEVERITIES: tuple[Severity, ...] = get_args(Severity)
"""All levels, from the best to the worst."""
PARTLY, MOSTLY = 0.1, 0.5
"""Shares of the car's bounding box outside its lane above which the level is "partly" or "mostly outside"."""
STANDS = 0.05  # m/s, up to which nuPlan takes somebody for standing
Party = Literal["ego", "other"]
Fault = Literal["ego", "other", "both", "nobody"]
Offence = Literal["red light", "stop", "priority", "wrong way", "speed", "lane", "distance"]
IncidentKind = Literal[
    "out of lane", "wrong turn", "wrong way", "off road", "stop line", "red light", "failure to yield",
    "collision", "near miss", "blocked", "speeding", "task",
]  # fmt: skip


@dataclass(frozen=True)
class Contact:
    """How the tested car and somebody else on the road touched first."""

    xy: tuple[float, float]
    """Position (x, y) in metres where they touched."""
    face: Face
    """Side of the tested car that was touched."""
    other_face: Face
    """Side of the other that was touched."""
    speed: float
    """Speed of the tested car in m/s."""
    other_speed: float
    """Speed of the other in m/s, negative when it reversed."""
    impact_speed: float
    """Difference of the two velocities in m/s."""
    overlap: float | None
    """Share of the tested car's width, 0 to 1, that lay before the other; None if its front was not
    touched."""
    nuplan_at_fault: Annotated[
        bool, Field(validation_alias=AliasChoices("nuplan_at_fault", "at_fault"))  # its name in version 1
    ]
    """Whether it is the tested car's fault by nuPlan, as ``roadgpt.verdict.contact`` defines it."""
    place: float | None = None
    """Where on ``face`` the middle of the touch was, as a share: of front and rear from the left, of the
    sides from the front; None in older records."""


@dataclass(frozen=True)
class Law:
    """What the law says of a collision of the tested car, "ego", and another one; see
    ``roadgpt.verdict.law``."""

    way: Party | None
    """Who had the way; None if no rule gave it to one of them."""
    ego: tuple[Offence, ...]
    other: tuple[Offence, ...]

    def said(self, name: str) -> str:
        """Returns it in words; ``name`` is that of the other."""
        names = {"ego": "the tested car", "other": name}
        told = [f"{names[self.way]} had the way"] if self.way else []
        offences = {"ego": self.ego, "other": self.other}
        return "; ".join(told + [f"{names[who]}: {', '.join(its)}" for who, its in offences.items() if its])


@dataclass(frozen=True)
class Incident:
    """One thing that went wrong, with the place and the time at which it began."""

    kind: IncidentKind
    at_s: float
    """Station of the car's centre of gravity in metres."""
    at_xy: tuple[float, float]
    """Position (x, y) of the car's centre of gravity in metres."""
    at_time: float
    """Time in seconds since the start of the drive."""
    other: str | None = None
    """Name of the other, of a collision, a near miss or a failure to yield; None for other kinds."""
    contact: Contact | None = None
    """How they touched in a collision; None for other kinds."""


@dataclass(frozen=True)
class Verdict:
    """The result of one drive. The place of a failure is that of the car's centre of gravity."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid", allow_inf_nan=False)

    outcome: Outcome
    cause: Cause | None
    """Cause of the failure, or of what was unavoidable; None if the car kept its lane and reached the goal.
    On routes, "wrong turn", "wrong way" and "stop line" are one if nothing else failed, or among others."""
    description: str
    """The result of the drive in one sentence."""
    sbft_description: str
    """The text that the SBFT competition would give as ``description``, without the simulation's name."""
    max_oob: float
    """Largest share of the car's bounding box outside its lane during the drive, 0 to 1, without the step at
    which it reached the goal or was stuck."""
    margin: float
    """Smallest margin during the drive in metres: how far the car could have been shifted sideways before
    failing (``roadgpt.verdict.oracle``). It is negative exactly if the car left its lane or fell."""
    oob_counter: int
    """Number of times the car went out of its lane."""
    beyond: float = 0.0
    """Largest distance in metres by which the car's body extended beyond the outer edge of a marking of its
    lane, over the same steps as ``max_oob``; 0 if it never did."""
    at_s: float | None = None
    """Station in metres where the car failed; None if the car did not fail."""
    at_xy: tuple[float, float] | None = None
    """Position (x, y) in metres where the car failed; None if the car did not fail."""
    at_time: float | None = None
    """Time in seconds from the start to the failure; None if the car did not fail."""
    side: Side | None = None
    """The side on which the car left its lane or fell; None for other results."""
    incidents: tuple[Incident, ...] | None = None
    """What the car did wrong on a route through junctions or with others on the road, in order of time; None
    on a single road without others. A tyre off the road, for one, fails no test."""
    events: tuple[Event, ...] | None = None
    """What happened, in order of time, and then what the scene prescribes that did not: its actions and
    lights, contacts and other incidents, where the car was out of its lane, and who had the wheel. None if
    there are none, and of drives without others and handovers."""
    least_gap: float | None = None
    """The least distance in metres, up to the first contact, from bumper to bumper to somebody ahead in the
    same lane; 0 at a collision, None if nobody ever was ahead in the same lane."""
    least_ttc: float | None = None
    """The least time to collision in seconds, as ``roadgpt.verdict.measure`` returns it, up to the first
    contact; None if there was none."""
    own_share: float | None = None
    """The share of the way, 0 to 1, that the driver drove itself; None if it never handed over."""
    law: Law | None = None
    """Who had the way in the first collision, and the offences of each; None if there was no collision."""
    avoidable: bool | None = None
    """Whether the collision that is the cause could have been avoided; None for other causes."""
    at_fault: Fault | None = None
    """Whose fault the first collision was, by ``law`` and the car's conduct (``roadgpt.verdict.law``);
    whether it could have been avoided is another question."""
    avoided_by: tuple[str, ...] | None = None
    """Those of the four drivers of ``roadgpt.verdict.careful`` who avoid the collision that is the cause;
    None for other causes."""
    criterion: str | None = None
    """By whom this collision was to be avoided, or it is UNAVOIDABLE: "r157" (the careful driver), "reg157",
    "rss", "fsm" or "any" of them; None for other causes."""
    handed_to: str | None = None
    """Who drove where the car failed, if the driver had handed over: such a failure is not one of the driver.
    None for other failures, and if the car did not fail."""

    def __repr__(self) -> str:
        told = (f"{name}={value!r}" for name, value in vars(self).items() if value is not None)
        return f"Verdict({', '.join(told)})"

    @property
    def counts(self) -> dict[str, int]:
        """The number of incidents of each kind that occurred; empty if there were none."""
        return dict(Counter(each.kind for each in self.incidents or ()))

    @property
    def first_contact(self) -> Contact | None:
        """How the tested car and somebody else touched first; None if there was no collision."""
        return next((each.contact for each in self.incidents or () if each.contact is not None), None)

    @property
    def is_at_fault(self) -> bool | None:
        """Whether the first collision was the tested car's fault, also together with the other's; by nuPlan
        in verdicts of version 1 of the rules. None if there was no collision."""
        if self.at_fault is not None or self.first_contact is None:
            return None if self.at_fault is None else self.at_fault in ("ego", "both")
        return self.first_contact.nuplan_at_fault

    @property
    def severity(self) -> Severity:
        """How far outside its lane the car was, in three levels; it follows from ``max_oob`` alone."""
        return severity(self.max_oob)

    @property
    def kept(self) -> bool:
        """Whether the car kept its lane and reached the goal."""
        return self.outcome == "PASS"

    @property
    def failed(self) -> bool:
        """Whether the car failed: it did not keep its lane or reach the goal, and could have."""
        return self.outcome == "FAIL"

    def to_json(self) -> dict[str, Any]:
        """Returns the fields and ``kept`` as JSON data, for ``Verdict.from_json``.

        The fields from ``incidents`` on, and ``other`` and ``contact`` of incidents, are left out where they
        are None."""
        names = [each.name for each in fields(self)]
        optional = {*names[names.index("incidents") :], "other", "contact", "until"}

        def told(part: object) -> dict[str, Any]:
            return {key: each for key, each in vars(part).items() if each is not None or key not in optional}

        data: dict[str, Any] = json.loads(json.dumps({"kept": self.kept, **told(self)}, default=told))
        return data

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """Returns the Verdict from the result of ``to_json``.

        Raises:
            UsageError: a field is missing or unknown, or its value is invalid."""
        try:
            return strictly(cls, {key: value for key, value in data.items() if key != "kept"})
        except (AttributeError, TypeError, ValueError) as error:
            said = str(error)
            if isinstance(error, ValidationError):
                first = error.errors(include_url=False)[0]
                said = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
            raise UsageError(f"the verdict cannot be read ({said}): judge the drive again") from error


def severity(share: float) -> Severity:
    """Returns the level for a share (0 to 1) of the car's bounding box outside its lane."""
    if share > MOSTLY:
        return "mostly outside"
    return "partly outside" if share > PARTLY else SEVERITIES[0]


def graded(outcome: str, share: float | None) -> str:
    """Returns an outcome as displayed, for example "PASS (partly outside)": the level is appended only to
    PASS, and only if the share of the box outside the lane, 0 to 1, is known and above 10 %."""
    if outcome != "PASS" or (share or 0.0) <= PARTLY:
        return outcome
    return f"{outcome} ({severity(share or 0.0)})"


def percent(share: float) -> str:
    """Returns a share (0 to 1) in per cent: only exactly 0 as "0 %" and 1 as "100 %", and less than 0.1 % as
    that."""
    told = f"{100 * share:.0f}"
    if told == "0" and share > 0:
        told = f"{100 * share:.1g}" if share >= 0.001 else "<0.1"
    elif told == "100" and share < 1:
        told = f"{math.floor(1000 * share) / 10:.1f}"
    return f"{told} %"
