"""A Phrase: all that was said about one thing, one slope or one wish."""

from dataclasses import dataclass, field

from roadgpt.brief.grammar.quantities import Term
from roadgpt.brief.model import Amount, Kind, Sharpness, Side, Size
from roadgpt.brief.normal import STRAIGHT

ROAD_LIKE: frozenset[Kind] = frozenset({"straight", "winding", "serpentine", "zigzag", "slalom"})
"""Kinds that a whole road can be said to be: 'a winding road'."""
WAVY: frozenset[Kind] = frozenset({"winding", "serpentine", "zigzag", "slalom"})


@dataclass(slots=True)
class Phrase:
    """What was said about one thing; a field is empty where nothing was said."""

    joint: str = ""
    fresh: bool = False
    """Does a pause, or the beginning, stand before it?"""
    count: Amount | None = None
    counted: bool = True
    """Was a number said, rather than 'several'?"""
    article: bool = False
    again: bool = False
    negated: bool = False
    only: bool = False
    scope: str = ""
    """all, each, both or rest: of the things said before."""
    pick: tuple[int, int] | None = None
    """First and number of the things said before; negative first counts from the last."""
    kind: Kind | None = None
    many: bool = False
    verb: bool = False
    road: bool = False
    stretch: bool = False
    side: Side | None = None
    both_sides: bool = False
    free_side: bool = False
    sharpness: Sharpness | None = None
    size: Size | None = None
    slope: str = ""
    """up, down or flat."""
    climbs: bool = False
    """Said as a verb: 'climbs', rather than 'uphill'."""
    slope_noun: bool = False
    after_road: bool = False
    """Was the slope said after the road: 'a road going uphill'?"""
    steep: bool = False
    mild: bool = False
    mostly: bool = False
    each_side: bool = False
    same_hand: bool = False
    series: tuple[str, tuple[float, ...]] | None = None
    """'two bends of 45 and 90 degrees': of what, and the numbers."""
    each: bool = False
    """'of 40 m each': the number is that of every single one."""
    half: int = 0
    """1 or 2: the first or the second half of the road; 3: half of the things said before."""
    nearly: bool = False
    degrees: Amount | None = None
    radius: Amount | None = None
    radius_said: bool = False
    length: Amount | None = None
    length_said: bool = False
    height: Amount | None = None
    height_said: str = ""
    turned: Amount | None = None
    """Degrees of all turns together."""
    turned_said: bool = False
    incline: Amount | None = None
    highest: bool = False
    alternating: bool = False
    spiral: bool = False
    whole: bool = False
    total: bool = False
    of_them: bool = False
    in_between: bool = False
    times: Amount | None = None
    repeat: bool = False
    place: str = ""
    hilly: bool = False
    more: str = ""
    """left, right or same: of which side there are more turns."""
    climbs_said: bool = False
    """'with steep climbs': some, somewhere."""
    changes: bool = False
    """Does the count say how often the slope changes?"""
    relative: bool = False
    """Does it begin with 'which': 'the last turn, which is downhill'?"""
    slope_alone: bool = False
    """Was it a slope and no more, and made a straight?"""
    free_turns: bool = False
    hard: bool = False
    mountain: bool = False
    highway: bool = False
    loop: bool = False
    items: list[Term] = field(default_factory=list)
    exception: list[Term] = field(default_factory=list)
    """The word 'except', where the phrase stands behind it."""
    ignored: list[Term] = field(default_factory=list)

    @property
    def turning(self) -> bool:
        """Is it a thing that turns?"""
        return self.kind is not None and self.kind not in STRAIGHT

    @property
    def empty(self) -> bool:
        """Is nothing said yet?"""
        return not self.items
