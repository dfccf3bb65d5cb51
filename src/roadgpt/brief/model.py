"""The Brief: the requirements for a road that were read from a description, as data.

Numbers in a Brief are in everyday units (degrees, metres and percent), so that people can write Briefs.
"""

from collections.abc import Iterator
from math import inf
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from roadgpt.brief.beside import BESIDE, friction_of
from roadgpt.brief.words import Range

Side = Literal["left", "right"]
OTHER_SIDE: dict[Side, Side] = {"left": "right", "right": "left"}
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


def _known(name: str) -> str:
    if name not in BESIDE:
        raise ValueError(f"'{name[:40]}' is none of the things beside a road: {', '.join(sorted(BESIDE))}")
    return name


Beside = Annotated[str, AfterValidator(_known)]


class Frozen(BaseModel):
    """Base of immutable values that are compared by content and read from and written to JSON."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def __repr_args__(self) -> Iterator[tuple[str | None, Any]]:
        """Yields only the fields that differ from their defaults, so that a printed Brief stays readable."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if field.is_required() or value != field.get_default(call_default_factory=True):
                yield name, value


class Amount(Frozen):
    """A number as the description gives it: exact (lo == hi), a lower bound (hi is None), an upper bound (lo
    is None) or a range.
    """

    lo: Annotated[float | None, Field(allow_inf_nan=False)] = None
    hi: Annotated[float | None, Field(allow_inf_nan=False)] = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.lo is None and self.hi is None:
            raise ValueError("an amount needs a lower or an upper bound")
        if self.lo is not None and self.hi is not None and self.lo > self.hi:
            raise ValueError(f"an amount between {self.lo:g} and {self.hi:g} has its bounds swapped")
        return self

    def __str__(self) -> str:
        lo, hi = (None if number is None else figure(number) for number in (self.lo, self.hi))
        if lo is None:
            return f"at most {hi}"
        return f"at least {lo}" if hi is None else lo if self.exact else f"{lo} to {hi}"

    @property
    def exact(self) -> bool:
        """True if the amount is a single number, not a bound or a range."""
        return self.lo == self.hi


def span(amount: Amount | None) -> Range:
    """Returns the interval of numbers that an amount allows; None allows every number."""
    lo, hi = (amount.lo, amount.hi) if amount else (None, None)
    return Range(-inf if lo is None else lo, inf if hi is None else hi)


def figure(number: float) -> str:
    """Formats a number with at most four decimals and no trailing zeros."""
    return f"{number:.4f}".rstrip("0").rstrip(".")


def exactly(number: float) -> Amount:
    """Returns the Amount that allows only this number."""
    return Amount(lo=number, hi=number)


def at_least(number: float) -> Amount:
    """Returns the Amount that allows this number or more."""
    return Amount(lo=number)


def at_most(number: float) -> Amount:
    """Returns the Amount that allows this number or less."""
    return Amount(hi=number)


def between(low: float, high: float) -> Amount:
    """Returns the Amount that allows every number from ``low`` to ``high``, both included."""
    return Amount(lo=low, hi=high)


class Clause(Frozen):
    """One feature along the road, or several features of the same kind in a row."""

    kind: Kind
    count: Amount = Amount(lo=1, hi=1)
    """The number of features of this kind in a row. For a serpentine, zigzag, slalom, winding road or
    switchback with a number ("4 switchbacks"), ``count`` is the number of turns. An s_bend or a chicane
    counts as one feature ("two S-bends" is 2).
    """
    side: Side | None = None
    """The direction of every turn; if the turns alternate, that of the first."""
    alternating: bool = False
    sharpness: Sharpness | None = None
    degrees: Amount | None = None
    """The change of heading of each turn in degrees, always positive."""
    radius: Amount | None = None
    """The radius of each turn in metres."""
    length: Amount | None = None
    """The length in metres of each straight, or of each turn along its curve."""
    size: Size | None = None
    """The size of a straight if the description gives a word instead of a number: "a long straight"."""
    slope: Slope | None = None
    incline: Amount | None = None
    """The grade in percent, always positive; ``slope`` says whether it is up or down."""


class Brief(Frozen):
    """A description and the requirements that were read from it.

    ``clauses`` are in driving order. If any clause is a turn, the clauses name *all* turns of the road. The
    other fields are requirements for the road as a whole, which hold in addition to the clauses.
    """

    words: str = ""
    clauses: tuple[Clause, ...] = ()
    turns: Amount | None = None
    left: Amount | None = None
    right: Amount | None = None
    alternating: bool = False
    sharpness: Sharpness | None = None
    """How tight every turn must be: "gentle", "sweeping" or "sharp"."""
    degrees: Amount | None = None
    """The change of heading of every turn in degrees."""
    radius: Amount | None = None
    """The radius of every turn in metres."""
    turning: Amount | None = None
    """The sum of the absolute turning angles of all turns in degrees."""
    slope: Slope | None = None
    """The slope of the whole road."""
    incline: Amount | None = None
    """The grade of the whole road in percent, always positive; ``slope`` says whether it is up or down."""
    steepest: Amount | None = None
    """The absolute value of the grade at the steepest place, in percent."""
    climb: Amount | None = None
    """The height of the end above the start in metres, negative if the road falls."""
    hills: Amount | None = None
    """The number of changes between climbing and falling."""
    length: Amount | None = None
    """The length of the whole road in metres."""
    starts: Clause | None = None
    """The first feature, if the clauses do not already name it."""
    ends: Clause | None = None
    """The last feature, if the clauses do not already name it."""
    motorway: bool = False
    """True if the description asks for a motorway; see ``brief.motorway``."""
    hard: bool = False
    """True if the road should be difficult for a lane keeper: tight turns, fast approaches, crests."""
    beside: tuple[Beside, ...] = ()
    """Names of things that the description mentions and that no requirement expresses, such as 'roundabout';
    ``brief.beside`` says what becomes of each."""
    unused: tuple[str, ...] = ()
    """The words of the description that were not understood."""
    confidence: Annotated[float, Field(ge=0, le=1)] = 1.0
    other: str = ""
    """The plan of the second likeliest reading, if the reader is not sure of this one; otherwise empty."""

    @property
    def friction(self) -> float | None:
        """The friction of the slipperiest surface that the words name; None if they name none."""
        return friction_of(self.beside)
