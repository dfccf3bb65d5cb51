"""Constrained decoding: the grammar of plans as an automaton, so that the model can only write valid plans.

Modifiers have a fixed order, the one in which ``brief.plan`` prints them. A measured number is either a slot
of the description with a suitable unit, or a number that a word implies ("right angle": 90).
"""

from collections.abc import Sequence
from copy import copy

from roadgpt.brief.readers.model.evidence import Evidence
from roadgpt.brief.readers.model.measures import LARGEST_SEEN
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.vocabulary import (
    CLAUSE_KEYS,
    KINDS,
    MEASURES,
    NUMBER_OF,
    PLACES,
    REFUSALS,
    ROAD_KEYS,
    SHARPNESS,
    SIDES,
    SIZES,
    SLOPES,
    SLOT_TOKENS,
    UNIT_OF,
)

STRAIGHT_KINDS = frozenset({"straight", "crest", "dip"})
CLAUSE_ORDER: list[list[str]] = [
    ["x"],
    SIDES,
    SHARPNESS,
    SIZES,
    SLOPES,
    ["alternating"],
    *([k] for k in CLAUSE_KEYS),
]
ROAD_ORDER: list[list[str]] = [
    SHARPNESS, SLOPES, ["alternating"], ["hard"],
    *([key] for key in ROAD_KEYS), *([place] for place in PLACES),
]  # fmt: skip
UNSAID = {"deg=": ("15", "30", "45", "60", "90", "120", "180"), "steepest=": ("4",)}
"""Numbers that a plan may contain although they are not in the text, by plan key."""
COUNTS = tuple(str(number) for number in range(LARGEST_SEEN + 1))
END = "<end>"
MOST_CLAUSES = 20


class PlanAutomaton:
    """The state of a plan that is being written token by token; knows which tokens may come next."""

    def __init__(
        self, slots: Sequence[NumberSlot], said: frozenset[str], evidence: Evidence | None = None
    ) -> None:
        self.slots, self.said = slots, said
        self.evidence = evidence or Evidence()
        self.place = "start"  # start, kind, clause, road, done
        self.kind = ""
        self.rank = -1  # modifiers up to this rank have been passed
        self.road_rank = -1
        self.is_inside = False  # of starts( ) or ends( )
        self.key = ""  # the key whose amount is being written
        self.amount: list[str] = []
        self.clauses = 0

    def copy(self) -> "PlanAutomaton":
        """Returns an independent copy in the same state."""
        other = copy(self)
        other.amount = list(self.amount)
        return other

    def allowed(self) -> list[int]:
        """Returns the indices of all tokens that may come next."""
        return [NUMBER_OF[word] for word in dict.fromkeys(self._next())]

    def push(self, word: str) -> None:
        """Advances the state by one token."""
        if self.key and (word in ("..", "-") or word in SLOT_TOKENS or word in COUNTS or word.isdigit()):
            self.amount.append(word)
            return
        self.key, self.amount = "", []
        if word in REFUSALS or word == END:
            self.place = "done"
        elif word in KINDS:
            self.place, self.kind, self.rank = "clause", word, -1
            self.clauses += 1
        elif word == ";":
            self.place = "kind"
        elif word == "|":
            self.place, self.rank = "road", -1
        elif word == ")":
            self.place, self.rank, self.is_inside = "road", self.road_rank, False
        elif word in PLACES:
            self.road_rank = self._rank(word, ROAD_ORDER)
            self.place, self.is_inside = "kind", True
        else:
            self.rank = self._rank(word, ROAD_ORDER if self.place == "road" else CLAUSE_ORDER)
            if word == "x" or word.endswith("="):
                self.key = word

    def _rank(self, word: str, order: list[list[str]]) -> int:
        return next(rank for rank, mods in enumerate(order) if word in mods)

    def _next(self) -> list[str]:
        if self.place == "done":
            return [END]
        if self.place == "start":
            return [*REFUSALS, *KINDS, "|"]
        if self.place == "kind":
            return list(KINDS)
        if self.key:
            more, is_whole = self._amounts()
            return [*more, *(self._mods() if is_whole else [])]
        return self._mods()

    def _mods(self) -> list[str]:
        if self.place == "road":
            later = [word for mods in ROAD_ORDER[self.rank + 1 :] for word in mods if self._has_number(word)]
            return [*later, END] if self.rank >= 0 else later
        later = [word for mods in CLAUSE_ORDER[self.rank + 1 :] for word in mods if self._suits(word)]
        return (
            [*later, ")"]
            if self.is_inside
            else [*later, *([";"] if self.clauses < MOST_CLAUSES else []), "|", END]
        )

    def _has_number(self, word: str) -> bool:
        return not word.endswith("=") or bool(self._numbers(word))

    def _suits(self, word: str) -> bool:
        if not self._has_number(word):
            return False
        if self.kind in STRAIGHT_KINDS:
            return word not in SIDES and word not in SHARPNESS and word not in ("alternating", "deg=", "r=")
        return word not in SIZES

    def _amounts(self) -> tuple[list[str], bool]:
        """Returns what may follow inside an amount, and whether the amount is already complete."""
        numbers, written = self._numbers(self.key), self.amount
        if not written:
            return ["..", *numbers, *(["-"] if self.key == "climb=" else [])], False
        if written == ["-"]:
            return numbers, False
        if written == [".."]:
            return numbers, False
        if written[-1] == "..":
            low = self._value(written[-2])
            return [number for number in numbers if self._value(number) > low], True
        is_range = ".." in written or written[0] == "-"
        return ([] if is_range else [".."]), True

    def _numbers(self, key: str) -> list[str]:
        """Returns the numbers that a key can have in this description; a key without any is never written."""
        fitting = [
            SLOT_TOKENS[index]
            for index, slot in enumerate(self.slots)
            if slot.unit in ("", UNIT_OF.get(key, "")) and slot.unit != "kmh"
        ]
        if key == "hills=" and not self.evidence.hills:
            return [number for number in COUNTS if number in self.said]
        if key not in MEASURES:
            return [*COUNTS, *fitting]
        is_meant = self.evidence.angles if key == "deg=" else self.evidence.mountains
        unsaid = UNSAID.get(key, ()) if is_meant else ()
        plain = [number for number in (*COUNTS, *UNSAID.get(key, ())) if number in self.said]
        return [*fitting, *plain, *unsaid]

    def _value(self, word: str) -> float:
        return self.slots[SLOT_TOKENS.index(word)].value if word in SLOT_TOKENS else float(word)
