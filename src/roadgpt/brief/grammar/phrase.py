"""A Phrase: everything that was said about one feature, one slope or one requirement."""

from dataclasses import dataclass, field

from roadgpt.brief.grammar.quantities import Term
from roadgpt.brief.model import Amount, Kind, Sharpness, Side, Size
from roadgpt.brief.normal import STRAIGHT

ROAD_LIKE: frozenset[Kind] = frozenset({"straight", "winding", "serpentine", "zigzag", "slalom"})
"""Kinds that can describe a whole road: 'a winding road'."""
WAVY: frozenset[Kind] = frozenset({"winding", "serpentine", "zigzag", "slalom"})


@dataclass(slots=True)
class Phrase:
    """What was said about one feature; a field is empty if nothing was said."""

    joint: str = ""
    fresh: bool = False
    """True if a pause, or the beginning, stands before it."""
    count: Amount | None = None
    counted: bool = True
    """True if a number was said, rather than 'several'."""
    article: bool = False
    again: bool = False
    negated: bool = False
    only: bool = False
    scope: str = ""
    """'all', 'each', 'both' or 'rest' of the features said before."""
    pick: tuple[int, int] | None = None
    """The first of the features said before, and how many; a negative first counts from the last."""
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
    """True if the slope was said as a verb: 'climbs' rather than 'uphill'."""
    slope_noun: bool = False
    after_road: bool = False
    """True if the slope was said after the road: 'a road going uphill'."""
    steep: bool = False
    mild: bool = False
    mostly: bool = False
    each_side: bool = False
    same_hand: bool = False
    series: tuple[str, tuple[float, ...]] | None = None
    """For 'two bends of 45 and 90 degrees': the name of the field, and the numbers."""
    each: bool = False
    """True for 'of 40 m each': the number applies to every single one."""
    half: int = 0
    """1 or 2: the first or the second half of the road; 3: half of the features said before."""
    nearly: bool = False
    degrees: Amount | None = None
    radius: Amount | None = None
    radius_said: bool = False
    length: Amount | None = None
    length_said: bool = False
    height: Amount | None = None
    height_said: str = ""
    turned: Amount | None = None
    """The sum of all turning angles in degrees."""
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
    """'left', 'right' or 'same': to which side more turns go."""
    climbs_said: bool = False
    """True for 'with steep climbs': there are some, somewhere."""
    changes: bool = False
    """True if the count says how often the slope changes."""
    relative: bool = False
    """True if it begins with 'which': 'the last turn, which is downhill'."""
    slope_alone: bool = False
    """True if only a slope was said, which then became a straight."""
    free_turns: bool = False
    hard: bool = False
    mountain: bool = False
    highway: bool = False
    loop: bool = False
    items: list[Term] = field(default_factory=list)
    exception: list[Term] = field(default_factory=list)
    """The word 'except', if the phrase follows it."""
    ignored: list[Term] = field(default_factory=list)

    @property
    def turning(self) -> bool:
        """True if it is a feature that turns."""
        return self.kind is not None and self.kind not in STRAIGHT

    @property
    def empty(self) -> bool:
        """True if nothing has been said yet."""
        return not self.items
