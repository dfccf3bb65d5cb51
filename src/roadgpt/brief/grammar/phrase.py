"""Defines Phrase: everything that a description says about one feature, one slope or one requirement."""

from dataclasses import dataclass, field

from roadgpt.brief.grammar.quantities import Term
from roadgpt.brief.model import Amount, Kind, Sharpness, Side, Size
from roadgpt.brief.normal import STRAIGHT

ROAD_LIKE: frozenset[Kind] = frozenset({"straight", "winding", "serpentine", "zigzag", "slalom"})
"""Kinds of features that can also describe a whole road: 'a winding road'."""
WAVY: frozenset[Kind] = frozenset({"winding", "serpentine", "zigzag", "slalom"})


@dataclass(slots=True)
class Phrase:
    """What a description says about one feature, slope or requirement; fields without a value are empty."""

    joint: str = ""
    fresh: bool = False
    """True if the phrase begins the description or follows a pause, such as a full stop."""
    count: Amount | None = None
    counted: bool = True
    """True if the count is a number in the text, not a word such as 'several'."""
    article: bool = False
    again: bool = False
    negated: bool = False
    only: bool = False
    scope: str = ""
    """The word 'all', 'each', 'both' or 'rest' if the phrase refers to features mentioned before."""
    pick: tuple[int, int] | None = None
    """Which earlier features the phrase refers to: the index of the first, and their number; a negative index
    counts from the last feature."""
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
    """'up', 'down' or 'flat'; empty if no slope is mentioned."""
    climbs: bool = False
    """True if the slope is expressed by a verb: 'climbs' rather than 'uphill'."""
    slope_noun: bool = False
    after_road: bool = False
    """True if the slope follows the word for the road: 'a road going uphill'."""
    steep: bool = False
    mild: bool = False
    mostly: bool = False
    each_side: bool = False
    same_hand: bool = False
    series: tuple[str, tuple[float, ...]] | None = None
    """For 'two bends of 45 and 90 degrees': the name of the field, and the numbers, one for each feature."""
    each: bool = False
    """True for 'of 40 m each': the number applies to every single feature."""
    half: int = 0
    """1 or 2 for the first or second half of the road, 3 for half of the features mentioned before."""
    nearly: bool = False
    degrees: Amount | None = None
    radius: Amount | None = None
    radius_said: bool = False
    length: Amount | None = None
    length_said: bool = False
    height: Amount | None = None
    height_said: str = ""
    turned: Amount | None = None
    """The required sum of the angles of all turns in degrees."""
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
    """The direction of most turns, 'left' or 'right'; 'same' if there are as many left as right turns."""
    climbs_said: bool = False
    """True for 'with steep climbs': the road has climbs, but the description does not say where."""
    changes: bool = False
    """True if the count is the number of changes of slope."""
    relative: bool = False
    """True if the phrase is a relative clause: 'the last turn, which is downhill'."""
    slope_alone: bool = False
    """True if the phrase is a straight that was inserted for a slope mentioned without a turn or straight."""
    free_turns: bool = False
    hard: bool = False
    mountain: bool = False
    highway: bool = False
    loop: bool = False
    items: list[Term] = field(default_factory=list)
    exception: list[Term] = field(default_factory=list)
    """The word 'except' if the phrase follows it; else empty."""
    ignored: list[Term] = field(default_factory=list)

    @property
    def turning(self) -> bool:
        """True if the phrase names a feature that turns."""
        return self.kind is not None and self.kind not in STRAIGHT

    @property
    def empty(self) -> bool:
        """True if the phrase has no content yet."""
        return not self.items
