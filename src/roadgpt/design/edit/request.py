"""A change request as data: what is to be changed, of which places along the road."""

from dataclasses import dataclass
from typing import Literal

from roadgpt.brief.model import Kind, Sharpness, Side

Noun = Literal["turn", "straight", "end", "start", "road", "it"]
What = Literal[
    "angle",  # sharper, gentler, by or to so many degrees
    "radius",  # tighter, wider, metres
    "length",
    "slope",
    "side",
    "shape",  # a hairpin, a gentle turn
    "straighten",  # a straight in the place of a turn
    "add",
    "remove",
    "mirror",
    "alternate",
]
Way = Literal["up", "down", "flat"]
Measure = Literal["sharp", "long", "steep"]


@dataclass(frozen=True, slots=True)
class Target:
    """Places on the road, as a person names them: 'the second left turn', 'turns 2 to 4', 'the end'."""

    noun: Noun | None = None
    """None if only a number was given: 'the second'."""
    kind: Kind | None = None
    """Kind of turn: 'the hairpin'."""
    numbers: tuple[int, ...] = ()
    """Counted from 1, from the last backwards from -1; empty for all that are meant."""
    middle: bool = False
    every: bool = False
    """All of them were meant: 'every turn', 'turns'; else it must be one."""
    side: Side | None = None
    sharpness: Sharpness | None = None
    way: Way | None = None
    size: Literal["long", "short"] | None = None
    most: tuple[Measure, int] | None = None
    """'The longest' is ("long", 1), 'the gentlest' is ("sharp", -1)."""
    place: "Place | None" = None
    """'The straight after the second turn'."""
    but: "Target | None" = None
    """'All turns except the first'."""
    indefinite: bool = False
    """'A turn': something new, not something that is there."""
    count: int | None = None
    """'Two turns', of new ones."""
    degrees: float | None = None
    """'The 90 degree bend'."""
    length: float | None = None
    """'The 40 m straight'."""
    is_that: bool = False
    """'That turn': the one that was spoken of last."""
    is_bare: bool = False
    """A side without a noun: 'the third left'."""
    half: int | None = None
    """1 or 2: that half of the road."""
    is_definite: bool = True
    """Something says which: 'the', 'every', a number; 'left turns' alone may be what others are to become."""
    words: str = ""

    @property
    def is_new(self) -> bool:
        """Whether it names something that is not on the road yet."""
        return self.indefinite or (self.count is not None and not (self.numbers or self.most))


@dataclass(frozen=True, slots=True)
class Place:
    """A place on the road: after, before or on something, or between two things."""

    how: Literal["after", "before", "between", "on", "start", "end", "middle"]
    target: Target | None = None
    other: Target | None = None


@dataclass(frozen=True, slots=True)
class Change:
    """One change that is asked for."""

    what: What
    target: Target | None = None
    """None where nothing was named: the whole road, or what was spoken of before."""
    more: int = 0
    """1 for sharper, wider, longer or steeper, -1 for the opposite, 0 where a value was said."""
    by: float | None = None
    to: float | None = None
    times: float | None = None
    bound: Literal[-1, 0, 1] = 0
    """-1: ``to`` is an upper limit; 1: ``to`` is a lower limit; 0: ``to`` is the value itself."""
    dose: float = 1.0
    """How much is meant where no number was said: 'slightly' is less than 1, 'much' more."""
    way: Way | None = None
    side: Side | None = None
    """New side; None for the opposite of the present one."""
    kind: Kind | None = None
    sharpness: Sharpness | None = None
    count: int = 1
    place: Place | None = None
    degrees: float | None = None
    """Angle of a turn that is added."""
    radius: float | None = None
    length: float | None = None
    grade: float | None = None
    is_whole: bool = False
    """Of a straight at an end of the road: with what is there already ('end with a 60 m straight')."""
    words: str = ""


@dataclass(frozen=True, slots=True)
class EditRequest:
    """All changes that are asked for at once."""

    words: str
    changes: tuple[Change, ...]
    unused: tuple[str, ...] = ()
    """Words that were not understood."""
