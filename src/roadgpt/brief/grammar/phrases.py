"""Puts words together that belong together: one Phrase for each thing, slope or wish, in the order said."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from roadgpt.brief.grammar.context import SKIPPED
from roadgpt.brief.grammar.quantities import Item
from roadgpt.brief.model import Amount, Kind, Sharpness, Side, Size, exactly

JOINTS = {
    ",": 1, "and": 2, "or": 2, "/": 2, "": 0, "stop": 3, ")": 1, "(": 4, "colon": 4, "with": 5, "for": 5, "into": 5,
    "then": 6, "between": 7, "after": 8, "start": 9, "end": 9,
}  # fmt: skip
"""How strongly things are joined; of two in a row ('and then') the stronger one holds."""
KINDS: dict[str, tuple[Kind, bool]] = {
    **{name: (name, False) for name in ("turn", "straight", "crest", "dip", "hairpin", "switchback", "u_turn")},
    **{name: (name, False) for name in ("s_bend", "chicane", "slalom", "serpentine", "zigzag", "winding")},
    "turn+": ("turn", True), "turn~": ("turn", False), "straight+": ("straight", True), "crest+": ("crest", True),
    "dip+": ("dip", True), "hairpin+": ("hairpin", True), "switchback+": ("switchback", True),
    "u_turn+": ("u_turn", True), "s_bend+": ("s_bend", True), "chicane+": ("chicane", True), "kink": ("turn", False),
    "dogleg": ("turn", False), "spiral": ("turn", False),
}  # fmt: skip
STRAIGHT: frozenset[Kind] = frozenset({"straight", "crest", "dip"})
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
    nearly: bool = False
    degrees: Amount | None = None
    radius: Amount | None = None
    radius_said: bool = False
    length: Amount | None = None
    length_said: bool = False
    height: Amount | None = None
    height_said: str = ""
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
    changes: bool = False
    """Does the count say how often the slope changes?"""
    hard: bool = False
    mountain: bool = False
    highway: bool = False
    loop: bool = False
    items: list[Item] = field(default_factory=list)
    ignored: list[Item] = field(default_factory=list)

    @property
    def turning(self) -> bool:
        """Is it a thing that turns?"""
        return self.kind is not None and self.kind not in STRAIGHT

    @property
    def empty(self) -> bool:
        """Is nothing said yet?"""
        return not self.items


def phrases(items: Sequence[Item]) -> list[Phrase]:
    """The phrases of a description."""
    chunker = _Chunker(items)
    for at, item in enumerate(items):
        chunker.take(at, item)
    chunker.close()
    return chunker.done


class _Chunker:
    """Reads items one after another into the current phrase, and begins a new one where it must."""

    def __init__(self, items: Sequence[Item]) -> None:
        self.items = items
        self.done = list[Phrase]()
        self.now = Phrase(fresh=True)
        self.negated = False

    def take(self, at: int, item: Item) -> None:
        name = item.name
        if name in _SILENT:
            return
        if name in _AS_JOINT:
            self._joint(_AS_JOINT[name])
            return
        self._begin_if_needed(at, item)
        if name in _TAKES:
            _TAKES[name](self.now, item, _next(self.items, at))
        elif name in KINDS:
            _take_kind(self.now, item)
        elif name.startswith("nth"):
            self.now.pick = (int(name[3:]) - 1, 1)
        self.now.items.append(item)

    def close(self) -> None:
        if not self.now.empty:
            self.done.append(self.now)

    def _joint(self, name: str) -> None:
        if not self.now.empty:
            self.negated = self.now.negated
            self.done.append(self.now)
            self.now = Phrase(joint=name)
        elif JOINTS[name] >= JOINTS[self.now.joint]:
            self.now.joint = name
        if name in (",", "stop", "colon", "then"):
            self.now.fresh = True
        self.now.negated = name == "or" and self.negated

    def _begin_if_needed(self, at: int, item: Item) -> None:
        now = self.now
        if not now.empty and _starts_anew(now, item, _next(self.items, at)):
            self.done.append(now)
            self.now = Phrase(fresh=False)


_SILENT = SKIPPED - {"a"} | {"?", "that", "speed", "across", "in_ten", "repeat_"}
_AS_JOINT = {
    ",": ",", "stop": "stop", "colon": "colon", "open": "(", "close": ")", "/": "/", "and": "and", "or": "or",
    "then": "then", "into": "into", "with": "with", "for": "for", "first_of_all": "start", "start": "start",
    "end": "end", "after": "after", "between": "between",
}  # fmt: skip


def _next(items: Sequence[Item], at: int) -> str:
    at += 1
    while at < len(items) and items[at].name in SKIPPED:
        at += 1
    return items[at].name if at < len(items) else ""


def _starts_anew(now: Phrase, item: Item, after: str) -> bool:
    """Does this item belong to another thing than the current phrase?"""
    name = item.name
    if name in KINDS:
        return _kind_starts_anew(now, KINDS[name][0])
    if name in ("left", "right", "both_sides", "free_side"):
        return now.side is not None or now.both_sides or now.road or now.kind in STRAIGHT
    if name in ("count", "a", "again"):
        return (
            _named(now)
            or (now.side is not None and name == "count")
            or (now.length is not None and name == "a")
        )
    if name in ("all", "both", "rest", "no", "only", "last_one") or name.startswith("nth"):
        return _named(now) or (now.slope != "" and name != "only")
    if name == "each":
        return _named(now) and after != "" and after not in _AS_JOINT
    if name in ("up", "down", "up~", "down~", "flat", "flat~"):
        return bool(now.slope and now.slope != name.rstrip("~")) or now.kind in ("crest", "dip")
    if name in ("m", "length"):
        return now.length is not None or (
            now.turning and not now.radius_said and after in ("long", "length", "total")
        )
    if name == "road":
        return now.turning and now.kind not in ROAD_LIKE and not now.road and now.joint != "with" and now.verb
    return False


def _named(now: Phrase) -> bool:
    return now.kind is not None or now.road


def _kind_starts_anew(now: Phrase, kind: Kind) -> bool:
    if now.road or (now.slope and kind in ("crest", "dip")):
        return True
    if now.kind is None:
        return False
    if kind == "turn" and now.turning:
        return False
    if now.kind == "turn" and not now.verb and kind not in STRAIGHT and not now.many:
        return False
    return not (now.kind in WAVY and kind not in STRAIGHT) and now.kind != kind


def _take_kind(now: Phrase, item: Item) -> None:
    kind, many = KINDS[item.name]
    if now.kind in WAVY and kind not in STRAIGHT and kind not in ("turn", now.kind):
        now.alternating = now.kind != "winding"
        now.kind = kind
    elif now.kind in (None, "turn"):
        now.kind = kind
    now.many |= many
    now.verb |= item.name.endswith("~")
    if item.name == "kink":
        now.degrees, now.sharpness = Amount(lo=15, hi=30), "gentle"
    elif item.name == "dogleg":
        now.degrees = Amount(lo=60, hi=120)
    elif item.name == "spiral":
        now.spiral = True


def _take_side(now: Phrase, item: Item, after: str) -> None:
    if item.name == "both_sides":
        now.both_sides = True
    elif item.name == "free_side":
        now.free_side = True
    else:
        now.side = "left" if item.name == "left" else "right"


def _take_slope(now: Phrase, item: Item, after: str) -> None:
    now.slope = item.name.rstrip("~")
    now.climbs |= item.name.endswith("~") or item.text in ("going", "goes")
    now.after_road = now.road
    if now.height_said == "" and after == "m":
        now.height_said = "?"  # 'climbs 10 metres'


def _take_count(now: Phrase, item: Item, after: str) -> None:
    if now.pick is not None and item.amount and item.amount.lo:
        now.pick = (now.pick[0] if now.pick[0] >= 0 else -int(item.amount.lo), int(item.amount.lo))
    elif now.count is None or (not now.counted and item.exact):
        now.count, now.counted = item.amount, item.exact
    else:
        now.ignored.append(item)


def _take_metres(now: Phrase, item: Item, after: str) -> None:
    if after == "across":
        now.ignored.append(item)
    elif (now.radius_said or after == "radius") and now.radius is None:
        now.radius = item.amount
    elif now.height_said not in ("", "?") or after in ("height", "loss", "gain") or (now.height_said == "?" and item.amount and (item.amount.hi or item.amount.lo or 0) <= MOST_HEIGHT):
        now.height = item.amount
    elif now.length is None:
        now.length = item.amount
    else:
        now.ignored.append(item)
    if now.height_said == "?":
        now.height_said = ""


MOST_HEIGHT = 30.0
"""Metres: 'climbs 20 metres' is a height, 'climbs 100 metres' a way."""


def _take_percent(now: Phrase, item: Item, after: str) -> None:
    amount = item.amount
    if amount and amount.lo is not None and amount.lo < 0:  # '-5 %' is downhill
        now.slope = now.slope or "down"
        amount = Amount(lo=abs(amount.hi if amount.hi is not None else amount.lo), hi=abs(amount.lo))
    if now.incline is None:
        now.incline = amount
    else:
        now.ignored.append(item)


def _take_degrees(now: Phrase, item: Item, after: str) -> None:
    amount = item.amount
    if amount and amount.lo is not None and amount.lo < 0:  # '-90 degrees' is to the right, as RoadGPT has it
        now.side = now.side or "right"
        amount = exactly(abs(amount.lo))
    now.degrees = amount if now.degrees is None or not now.degrees.exact else now.degrees


def _take_size(now: Phrase, item: Item, after: str) -> None:
    if now.length is not None or after == "m":
        now.length_said = True
    else:
        now.size = "long" if item.name == "long" else "short"


def _take_road(now: Phrase, item: Item, after: str) -> None:
    if now.kind is None or now.kind in ROAD_LIKE or now.verb:
        now.road = True


def _take_last(now: Phrase, item: Item, after: str) -> None:
    now.pick = (-1, 1)


def _take_times(now: Phrase, item: Item, after: str) -> None:
    now.times = item.amount or exactly(2)


def _set(**values: object) -> Callable[[Phrase, Item, str], None]:
    def take(now: Phrase, item: Item, after: str) -> None:
        for name, value in values.items():
            setattr(now, name, value)

    return take


def _sharpness(value: Sharpness) -> Callable[[Phrase, Item, str], None]:
    def take(now: Phrase, item: Item, after: str) -> None:
        if now.sharpness is None or value == "sweeping":
            now.sharpness = value

    return take


def _radius_word(now: Phrase, item: Item, after: str) -> None:
    if now.length is not None and now.radius is None and now.turning:
        now.radius, now.length = now.length, None
    now.radius_said = True


_TAKES: dict[str, Callable[[Phrase, Item, str], None]] = {
    **dict.fromkeys(("left", "right", "both_sides", "free_side"), _take_side),
    **dict.fromkeys(("up", "down", "flat", "up~", "down~", "flat~"), _take_slope),
    **dict.fromkeys(("long", "short"), _take_size),
    **{scope: _set(scope=scope) for scope in ("all", "each", "both", "rest")},
    "gentle": _sharpness("gentle"), "sharp": _sharpness("sharp"), "sweeping": _sharpness("sweeping"),
    "count": _take_count, "m": _take_metres, "%": _take_percent, "deg": _take_degrees, "road": _take_road,
    "deg90": _set(degrees=exactly(90)), "deg45": _set(degrees=exactly(45)), "last_one": _take_last,
    "times": _take_times, "times2": _take_times, "radius": _radius_word, "length": _set(length_said=True),
    "height": _set(height_said="gain"), "gain": _set(height_said="gain", slope="up"), "loss": _set(height_said="loss"),
    "lose": _set(height_said="loss", slope="down"), "highest": _set(highest=True), "slope": _set(slope_noun=True),
    "steep": _set(steep=True), "mild": _set(mild=True), "nearly": _set(nearly=True), "hilly": _set(hilly=True),
    "changes": _set(changes=True),
    "mountain": _set(mountain=True), "highway": _set(highway=True, road=True), "hard_road": _set(hard=True),
    "alternating": _set(alternating=True), "whole": _set(whole=True), "total": _set(total=True), "loop": _set(loop=True),
    "of_them": _set(of_them=True), "in_between": _set(in_between=True), "repeat": _set(repeat=True),
    "at_end": _set(place="end"), "at_start": _set(place="start"), "in_middle": _set(place="middle"),
    "no": _set(negated=True), "only": _set(only=True), "a": _set(article=True), "again": _set(again=True),
    "stretch": _set(stretch=True),
}  # fmt: skip
