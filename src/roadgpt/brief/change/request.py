"""Defines a change request as data: the changes to make, and the places along the road that they concern.
Refuses changes that cannot all be made at once, or do not fit the places they name."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, cast

from roadgpt.brief.scene import Action, Scene
from roadgpt.errors import EditError
from roadgpt.language.names import Kind, Sharpness, Side, Slope, Where
from roadgpt.language.names import What as Doing

Noun = Literal["turn", "straight", "end", "start", "road"]
What = Literal[
    "angle",  # sharper, gentler, by or to so many degrees
    "radius",  # tighter, wider, metres
    "length",
    "slope",
    "climb",  # metres of height that a part of the road gains
    "side",
    "shape",  # a hairpin, a gentle turn
    "straighten",  # a straight in the place of a turn
    "add",
    "remove",
    "count",  # so many turns, in all or of one kind
    "move",  # a turn to another place
    "mirror",
    "swap",  # two turns, or two straights, change places
    "reverse",  # the whole road, from its end to its start
    "alternate",
]
Way = Literal["up", "down", "flat"]
Steepness = Literal["gently", "steeply"]
Measure = Literal["sharp", "long", "steep"]
SLIGHTLY, MUCH = 0.5, 1.8
"""Sizes of a change ('slightly', 'much') for which no number is given, relative to the usual size."""
OF_SLOPE: frozenset[What] = frozenset({"slope", "climb"})
REORDERS: tuple[What, ...] = ("swap", "move")
"""Changes that put turns or straights in another order."""
NUMBERING: tuple[What, ...] = ("add", "remove", "count", "straighten")
"""Changes that add or remove turns or straights."""
HILLS = {"crest": 1, "dip": -1}
"""The kinds of hill that can be added, with the sign of their first slope."""


@dataclass(frozen=True, slots=True)
class Target:
    """Places on the road, as a person names them: 'the second left turn', 'turns 2 to 4', 'the end'."""

    noun: Noun | None = None
    """The noun, such as 'turn' or 'straight'; None if there is only a number, as in 'the second'."""
    kind: Kind | None = None
    """The kind of turn, as in 'the hairpin'."""
    numbers: tuple[int, ...] = ()
    """Positions, counted from 1, or from -1 backwards from the end; empty if none is given."""
    middle: bool = False
    every: bool = False
    """True if all matching elements are meant, as in 'every turn' or 'turns'; else only one may match."""
    side: Side | None = None
    sharpness: Sharpness | None = None
    way: Way | None = None
    size: Literal["long", "short"] | None = None
    most: tuple[Measure, int] | None = None
    """The superlative: ("long", 1) for 'the longest', ("sharp", -1) for 'the gentlest'."""
    place: "Place | None" = None
    """The place of the element, as in 'the straight after the second turn'."""
    but: "Target | None" = None
    """The exceptions, as in 'all turns except the first'."""
    count: int | None = None
    """The number of elements, as in 'two turns' (new ones) or 'the two sharpest turns'."""
    degrees: float | None = None
    """The angle, as in 'the 90 degree bend'."""
    length: float | None = None
    """The length in metres, as in 'the 40 m straight' and 'the last 80 m'."""
    half: int | None = None
    """1 or 2 if only the first or the second half of the road is meant."""
    words: str = ""

    @property
    def is_distance(self) -> bool:
        """Whether the target is a distance from an end of the road, as in 'the last 80 m'."""
        return self.noun in ("start", "end") and self.length is not None


@dataclass(frozen=True, slots=True)
class Place:
    """A place on the road: after, before or on something, between two things, or the start, middle or end.

    'from' and 'up_to' include the thing itself, as in 'from the third turn on'."""

    how: Literal["after", "before", "from", "up_to", "between", "on", "start", "end", "middle"]
    target: Target | None = None
    other: Target | None = None

    @property
    def ends(self) -> tuple[Target, ...]:
        """The things that the place names: none, one or two."""
        return tuple(each for each in (self.target, self.other) if each)

    @property
    def is_of_distances(self) -> bool:
        """Whether the place is named by distances, as in 'from station 150 on'."""
        return any(each.is_distance for each in self.ends)


@dataclass(frozen=True, slots=True, kw_only=True)
class Value:
    """How a number is to change."""

    more: int = 0
    """1 for sharper, wider, longer or steeper, -1 for the opposite, 0 if the request gives no direction."""
    by: float | None = None
    to: float | None = None
    times: float | None = None
    like: Target | None = None
    """The place from which the value ``to`` is taken, as in 'as long as the first straight'. With ``by`` or
    ``times``, the value differs from it by so much, as in 'twice as long as the first straight'."""
    bound: Literal[-1, 0, 1] = 0
    """-1: ``to`` is an upper limit; 1: ``to`` is a lower limit; 0: ``to`` is the value itself."""
    dose: float = 1.0
    """The size of a change for which no number is given: less than 1 for 'slightly', more than 1 for
    'much'."""

    @property
    def is_compared(self) -> bool:
        """Whether the change gives its value by how much it differs from that of another place."""
        return self.like is not None and (self.by is not None or self.times is not None)

    @property
    def takes_places(self) -> bool:
        """Whether the value can be that of another place."""
        return False


@dataclass(frozen=True, slots=True)
class Change(Value):
    """One requested change."""

    what: What
    target: Target | None = None
    """The places to change. With None, the request names no places and means the whole road, or the places
    mentioned before."""
    way: Way | None = None
    steepness: Steepness | None = None
    """How steep the new slope is if ``way`` is "up" or "down"; None if the request does not say."""
    side: Side | None = None
    """The new side; None for the opposite of the present side."""
    kind: Kind | None = None
    sharpness: Sharpness | None = None
    count: int = 1
    place: Place | None = None
    degrees: float | None = None
    """The angle in degrees of a turn that is added."""
    radius: float | None = None
    length: float | None = None
    grade: float | None = None
    is_whole: bool = False
    """For a straight at an end of the road: whether its length includes the straight that is already there
    ('end with a 60 m straight')."""
    words: str = ""

    @property
    def takes_places(self) -> bool:
        """Whether the value can be that of another place."""
        return self.what != "climb"

    @property
    def slope(self) -> Slope | None:
        """The new slope, with its steepness if the request gives it, as in "steeply_up"."""
        return cast(Slope, f"{self.steepness}_{self.way}") if self.steepness else self.way

    @property
    def sign(self) -> int:
        """1 if the new slope goes uphill, -1 if downhill, 0 if level or if the request does not say."""
        return {"up": 1, "down": -1}.get(self.way or "", 0)

    @property
    def is_hill(self) -> bool:
        """Whether the change adds a crest or a dip."""
        return self.what == "add" and self.kind in HILLS

    @property
    def is_of_road(self) -> bool:
        """Whether the change concerns the whole road or a part of the road, instead of turns or straights."""
        return self.target is not None and self.target.noun == "road"

    @property
    def is_state(self) -> bool:
        """Whether the change sets a value or a slope, instead of a limit or a difference."""
        return not self.bound and not self.more and (self.to is not None or self.way is not None)

    def aim(self, now: float) -> float | None:
        """Returns the value that the change asks for; None if the request gives no number.

        A difference or a factor is applied to the present value ``now``."""
        if self.to is not None:
            return self.to
        if self.by is not None:
            return now + self.more * self.by
        return None if self.times is None else now * self.times

    def is_outside(self, now: float) -> bool:
        """Returns whether a value violates the limit that the change sets."""
        assert self.to is not None
        return (now - self.to) * self.bound < 0


@dataclass(frozen=True, slots=True)
class Things:
    """Parts of a scene, as a person names them: 'the truck', 'the second car behind', 'all bridges'."""

    name: str
    """A kind of actor or of landscape, "actor" and "landscape" for any of them, or another part of a
    scene."""
    numbers: tuple[int, ...] = ()
    """Positions among those that fit, counted from 1, or from -1 backwards from the last one."""
    every: bool = False
    where: Where | None = None
    side: Side | Literal["opposite", "other"] | None = None
    """"other" is the one on which it is not now."""


@dataclass(frozen=True, slots=True)
class SceneChange(Value):
    """One requested change of the scene."""

    what: Literal["add", "remove", "number", "count", "as"]
    target: Things | None = None
    """None for what is added to the scene."""
    doing: Doing | None = None
    """The action that is removed, or whose number changes."""
    key: str = ""
    """The field of the number."""
    new: Scene | Action | None = None
    """What is added: a scene of one part, not checked by itself, or an action of an actor."""
    form: Things | None = None
    """What somebody is to be, and where; the name is empty if the kind stays."""


@dataclass(frozen=True, slots=True)
class EditRequest:
    """All changes that one request asks for."""

    words: str
    changes: tuple[Change, ...]
    scene: tuple[SceneChange, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = ()
    """Words of the request that were not understood."""
    confidence: float = 1.0
    """Estimated probability that the request was read correctly."""
    others: tuple[str, ...] = ()
    """The plans of other readings that are likely, the likeliest first."""
    surface: str = ""
    """The surface that the road is to get, such as "wet"; empty if it stays as it is."""

    @property
    def other(self) -> str:
        """The plan of the second likeliest reading; empty if no other is likely."""
        return self.others[0] if self.others else ""


def refuse_clashes(changes: Sequence[Change]) -> None:
    """Raises EditError if a change does not fit its place, or two changes need separate requests."""
    for change in changes:
        if fault := next(_faults(change), ""):
            raise EditError(fault)
    numbering = [change for change in changes if change.what in NUMBERING and not change.is_hill]
    counts = [change for change in changes if change.what == "count"]
    sides = [change.target.side for change in counts if change.target]
    are_of_both_sides = len(numbering) == len(sides) == 2 and {*sides} == {"left", "right"}
    if counts and len(numbering) > 1 and not are_of_both_sides:
        raise clash(counts[0], next(change for change in numbering if change is not counts[0]))


def clash(one: Change, other: Change) -> EditError:
    """Returns the error for two changes that cannot be made at once."""
    return EditError(f"'{one.words}' and '{other.words}' need requests of their own; make one change first")


def _faults(change: Change) -> Iterator[str]:
    target, words = change.target, change.words
    if target is not None and target.length is not None and target.noun == "road":
        metres = f"len={target.length:g}"
        yield f"'{words}' does not say which metres of the road; write start {metres} or end {metres}"
    yield from _distances_in(change.place)
    yield from _distances_in(Place("on", change.like))
    if target is not None:
        yield from _faults_of_target(target)
    if change.what == "count" and target is not None:
        of_all = ("kind", "side", "sharpness", "way", "every", "words")
        if target != Target("turn", **{name: getattr(target, name) for name in of_all}):
            yield (
                f"'{words}' counts the turns of a place; only all turns, or those of a side or a kind, can"
                " be counted, for example: turn left: x4"
            )
        if change.to is None or change.to < 1:
            yield f"'{words}' gives no number of turns; write for example: turn: x4"
    if change.is_hill and change.count > 1:
        yield f"'{words}' adds several at once; say where each one is to be"
    shape = (change.length, change.grade, change.degrees, change.radius)
    shape_in_words = (change.side, change.sharpness, change.way)
    if change.is_hill and (change.is_whole or any(each is not None for each in (*shape, *shape_in_words))):
        yield f"'{words}' gives a {change.kind} a shape; write only where it is to be"


def _faults_of_target(target: Target) -> Iterator[str]:
    place = target.place
    for distance in (target, *(place.ends if place else ())):
        if distance.is_distance and (distance.length or 0) < 0:
            yield f"'{distance.words}' is no distance; give metres from 0 on"
    if target.is_distance and target != Target(target.noun, length=target.length, words=target.words):
        yield f"'{target.words}' is a distance, which stands alone; leave the other words out"
    if target.noun == "road" and place and place.is_of_distances:  # a part of the road between distances
        is_plain = target == Target("road", place=place, words=target.words) and place.how != "on"
        is_plain = is_plain and len(place.ends) == (2 if place.how == "between" else 1)
        if not is_plain or not all(end.is_distance for end in place.ends):
            yield (
                f"'{target.words}' mixes distances with other words; write for example: "
                "road between(start len=50, start len=100)"
            )
    else:
        yield from _distances_in(place)
    yield from _distances_in(Place("on", target.but))


def _distances_in(place: Place | None) -> Iterator[str]:
    """Yields that a place is named by a distance, however deep."""
    for target in place.ends if place else ():
        if target.is_distance:
            yield f"'{target.words}' is a distance, which cannot name a place; name a turn or a straight"
        yield from _distances_in(target.place)
        yield from _distances_in(Place("on", target.but))
