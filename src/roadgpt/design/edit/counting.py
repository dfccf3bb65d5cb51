"""Reads positions such as 'the second', 'first and third' and 'turns 2 to 4'."""

from collections.abc import Sequence
from typing import Any

from roadgpt.design.edit.lexing import RequestLexeme


class CountedRow:
    """A row of lexemes, and methods that read positions from it."""

    def __init__(self, row: Sequence[RequestLexeme]) -> None:
        self.row = row

    def name(self, at: int) -> str:
        """Returns the name of the lexeme at an index; empty if there is none."""
        return self.row[at].name if 0 <= at < len(self.row) else ""

    def ordinals(self, at: int, found: dict[str, Any]) -> int:
        """Reads 'second', 'first and third', 'last two' or 'second to fourth' into ``found``; returns the
        index of the next lexeme.
        """
        numbers = [int(self.row[at].value)]
        at += 1
        if self.name(at) == "#" and not self.row[at].unit and abs(numbers[0]) == 1:
            count, sign = int(self.row[at].value), numbers[0]
            found["numbers"] = tuple(sign * i for i in range(1, count + 1))
            return at + 1
        while True:
            step = at + 1
            if self.name(at) in ("and", "comma", "to") and self.name(step) == "and":
                step += 1
            if self.name(step) == "the":
                step += 1
            if self.name(at) not in ("and", "comma", "to") or self.name(step) != "ord":
                break
            after = int(self.row[step].value)
            if self.name(at) == "to" and 0 < numbers[-1] < after:
                numbers += range(numbers[-1] + 1, after)
            numbers.append(after)
            at = step + 1
        found["numbers"] = (*found.get("numbers", ()), *numbers)
        return at

    def numbers(self, at: int, found: dict[str, Any]) -> int:
        """Reads 'turns 2 to 4', 'turn 3' or 'turns 1, 3 and 5' into ``found``; returns the index of the
        next lexeme.
        """
        numbers: list[int] = []
        while (
            self.name(at) == "#" and not self.row[at].unit and self.row[at].value == int(self.row[at].value)
        ):
            value = int(self.row[at].value)
            joined = self.name(at + 1)
            step = at + 1
            if numbers and self.name(at - 1) == "to":
                numbers += range(numbers[-1] + 1, value)
            numbers.append(value)
            if joined in ("comma", "and", "to"):
                step = at + 2
                if self.name(step) == "and":
                    step += 1
                if self.name(step) == "#" and not self.row[step].unit:
                    at = step
                    continue
            at += 1
            break
        if numbers:
            found["numbers"] = (*found.get("numbers", ()), *numbers)
        return at
