"""Groups words that belong together into Phrases: one for each feature, slope or requirement."""

from collections.abc import Sequence
from math import radians, tan

from roadgpt.brief.grammar.context import SKIPPED
from roadgpt.brief.grammar.handlers import HANDLERS, KINDS, handle_kind
from roadgpt.brief.grammar.phrase import ROAD_LIKE, WAVY, Phrase
from roadgpt.brief.grammar.quantities import Term
from roadgpt.brief.model import Amount, Kind
from roadgpt.brief.normal import STRAIGHT

JOINTS = {
    ",": 1,
    "and": 2,
    "or": 2,
    "/": 2,
    "": 0,
    "stop": 3,
    ")": 1,
    "(": 4,
    "colon": 4,
    "with": 5,
    "for": 5,
    "into": 5,
    "then": 6,
    "between": 7,
    "after": 8,
    "except": 8,
    "ahead": 8,
    "enter": 5,
    "start": 9,
    "end": 9,
}
"""Maps each joining word or sign to its strength; of two in a row ('and then') the stronger one is used."""


def chunk(items: Sequence[Term]) -> list[Phrase]:
    """Groups the terms of a description into phrases and returns the phrases in text order."""
    chunker = _Chunker(items)
    for at, item in enumerate(items):
        chunker.take(at, item)
    chunker.close()
    for phrase in chunker.done:
        _slope_in_degrees(phrase)
    return chunker.done


def _slope_in_degrees(phrase: Phrase) -> None:
    """Converts 'climbs at 5 degrees' to a slope of 8.7 percent."""
    degrees = phrase.degrees
    sloped = phrase.slope in ("up", "down") or phrase.slope_noun
    if degrees and sloped and not phrase.turning and phrase.side is None and phrase.incline is None:
        lo, hi = (
            None if x is None else round(100 * tan(radians(min(x, 89.0))), 2)
            for x in (degrees.lo, degrees.hi)
        )
        phrase.incline, phrase.degrees = Amount(lo=lo, hi=hi), None


class _Chunker:
    """Reads terms one after another into the current phrase, and begins a new one where needed."""

    def __init__(self, items: Sequence[Term]) -> None:
        self.items = items
        self.done = list[Phrase]()
        self.now = Phrase(fresh=True)
        self.negated = False

    def take(self, at: int, item: Term) -> None:
        name = item.name
        if name in _SILENT:
            self.now.relative |= name == "that" and self.now.empty
            return
        if name in _AS_JOINT:
            self._joint(_AS_JOINT[name])
            self.now.exception += [item] if name == "except" else []
            return
        self._begin_if_needed(at, item)
        if name in HANDLERS:
            HANDLERS[name](self.now, item, _next(self.items, at))
        elif name in KINDS:
            handle_kind(self.now, item)
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

    def _begin_if_needed(self, at: int, item: Term) -> None:
        now = self.now
        if not now.empty and _starts_anew(now, item, _next(self.items, at)):
            self.done.append(now)
            self.now = Phrase(fresh=False)


_SILENT = SKIPPED - {"a"} | {"?", "that", "speed", "across", "in_ten", "repeat_"}
_AS_JOINT = {
    ",": ",",
    "stop": "stop",
    "colon": "colon",
    "open": "(",
    "close": ")",
    "/": "/",
    "and": "and",
    "or": "or",
    "then": "then",
    "into": "into",
    "enter": "enter",
    "ahead": "ahead",
    "with": "with",
    "for": "for",
    "first_of_all": "start",
    "start": "start",
    "end": "end",
    "after": "after",
    "except": "except",
    "between": "between",
}


def _next(items: Sequence[Term], at: int) -> str:
    at += 1
    while at < len(items) and items[at].name in SKIPPED:
        at += 1
    return items[at].name if at < len(items) else ""


_TURNS = {name for name, (kind, _) in KINDS.items() if kind not in STRAIGHT} | {"left", "right"}


def _starts_anew(now: Phrase, item: Term, after: str) -> bool:
    """True if this term belongs to another feature than the current phrase."""
    name = item.name
    if now.joint == "after" and now.length and not _named(now) and name in _TURNS:
        return True  # 'after 50 m turn left'
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
