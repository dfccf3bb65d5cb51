"""The Brief: what a description asks for, as data.

A Brief stands at a door, so its numbers carry the units that people speak in: degrees, metres, percent.
"""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Side = Literal["left", "right"]
Sharpness = Literal["gentle", "sweeping", "sharp"]
Size = Literal["long", "short"]
Slope = Literal["up", "down", "flat", "nearly_flat", "gently_up", "gently_down", "steeply_up", "steeply_down"]
Kind = Literal[
    "straight",
    "crest",  # a straight that climbs, then falls
    "dip",  # a straight that falls, then climbs
    "turn",
    "hairpin",
    "switchback",
    "u_turn",
    "s_bend",
    "chicane",
    "slalom",
    "serpentine",
    "zigzag",
    "winding",
]


class Frozen(BaseModel):
    """A value: never changed, compared by content, read from and written to JSON."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def __repr_args__(self) -> Iterator[tuple[str | None, Any]]:
        """What was set to something else than usual; the rest would bury it."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if field.is_required() or value != field.get_default(call_default_factory=True):
                yield name, value


class Amount(Frozen):
    """A number as it was asked for: exactly (lo == hi), at least (no hi), at most (no lo), or between."""

    lo: Annotated[float | None, Field(allow_inf_nan=False)] = None
    hi: Annotated[float | None, Field(allow_inf_nan=False)] = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.lo is None and self.hi is None:
            raise ValueError("an amount needs a lower or an upper bound")
        if self.lo is not None and self.hi is not None and self.lo > self.hi:
            raise ValueError(f"an amount between {self.lo:g} and {self.hi:g} has its bounds swapped")
        return self

    @property
    def exact(self) -> bool:
        """Was one number asked for, rather than a bound or a range?"""
        return self.lo == self.hi


def exactly(number: float) -> Amount:
    """Just this number."""
    return Amount(lo=number, hi=number)


def at_least(number: float) -> Amount:
    """This number or more."""
    return Amount(lo=number)


def at_most(number: float) -> Amount:
    """This number or less."""
    return Amount(hi=number)


def between(low: float, high: float) -> Amount:
    """From one number to the other, both allowed."""
    return Amount(lo=low, hi=high)


class Clause(Frozen):
    """One thing along the road, or several of the same kind in a row."""

    kind: Kind
    count: Amount = Amount(lo=1, hi=1)
    """How many of this kind, one after another; of turns, where the kind is serpentine, zigzag,
    slalom, winding or switchback and a number was given ("4 switchbacks"). s_bend and chicane count as one
    thing each ("two S-bends" = 2)."""
    side: Side | None = None
    """Of every turn; of the first turn, where they alternate."""
    alternating: bool = False
    sharpness: Sharpness | None = None
    degrees: Amount | None = None
    """Heading change of each turn, always positive."""
    radius: Amount | None = None
    """Metres, of each turn."""
    length: Amount | None = None
    """Metres: of each straight; of each turn along its curve."""
    size: Size | None = None
    """Of a straight without a number: 'a long straight'."""
    slope: Slope | None = None
    incline: Amount | None = None
    """Percent, always positive; slope says whether up or down."""


class Brief(Frozen):
    """The words, and the promises read out of them.

    ``clauses`` stand in driving order. Where any clause turns, the clauses name *all* turns of the road.
    The other fields are wishes for the road as a whole, and hold besides the clauses.
    """

    words: str = ""
    clauses: tuple[Clause, ...] = ()
    turns: Amount | None = None
    left: Amount | None = None
    right: Amount | None = None
    alternating: bool = False
    sharpness: Sharpness | None = None
    """Of every turn."""
    degrees: Amount | None = None
    """Of every turn."""
    radius: Amount | None = None
    """Metres, of every turn."""
    turning: Amount | None = None
    """Degrees, all turns together, whichever way."""
    slope: Slope | None = None
    """Of the whole road."""
    incline: Amount | None = None
    """Percent, always positive, of the whole road; slope says whether up or down."""
    steepest: Amount | None = None
    """Percent, always positive: the steepest place, whichever way."""
    climb: Amount | None = None
    """Metres from start to end, negative for a fall."""
    hills: Amount | None = None
    """How often the road changes between climbing and falling."""
    length: Amount | None = None
    """Metres, of the whole road."""
    starts: Clause | None = None
    """The first thing, where the clauses do not say it."""
    ends: Clause | None = None
    """The last thing, where the clauses do not say it."""
    motorway: bool = False
    """Was a motorway asked for? See ``brief.motorway``."""
    hard: bool = False
    """Hard for a lane keeper: tight, fast into bends, over crests."""
    unused: tuple[str, ...] = ()
    """Words of the description that were not understood."""
    confidence: Annotated[float, Field(ge=0, le=1)] = 1.0
