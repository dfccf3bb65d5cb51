"""Grammars over tokens, as data: which tokens may come next, and what is left of a grammar behind a token.

A grammar is built of the symbols below. No two alternatives of a symbol begin with the same token, so one
token decides (LL(1)), and the state of a text that is being written is a stack of symbols.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol


class Symbol(Protocol):
    """A part of a grammar."""

    @property
    def may_be_empty(self) -> bool:
        """Whether the symbol can be left out."""

    def first(self) -> Iterable[str]:
        """Returns the tokens with which the symbol can begin."""

    def after(self, token: str) -> "tuple[Symbol, ...]":
        """Returns what must follow if the symbol begins with this token."""


@dataclass(frozen=True, slots=True)
class OneOf:
    """One of several tokens."""

    tokens: Sequence[str]
    may_be_empty: bool = False

    def first(self) -> Iterable[str]:
        """Returns the tokens."""
        return self.tokens

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns that nothing follows."""
        return ()


@dataclass(frozen=True, slots=True)
class Sequel:
    """A token or another symbol that begins, and the symbols that follow it.

    With ``is_open`` the whole may be left out.
    """

    head: Symbol
    rest: tuple[Symbol, ...]
    is_open: bool = False

    @property
    def may_be_empty(self) -> bool:
        """Whether the whole may be left out."""
        return self.is_open

    def first(self) -> Iterable[str]:
        """Returns the tokens with which the head begins."""
        return self.head.first()

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns what is left of the head, and the rest."""
        return (*self.head.after(token), *self.rest)


@dataclass(frozen=True, slots=True)
class AnyOf:
    """One of several symbols."""

    ways: tuple[Symbol, ...]

    @property
    def may_be_empty(self) -> bool:
        """False: a choice is made."""
        return False

    def first(self) -> Iterable[str]:
        """Returns the tokens with which one of the symbols begins."""
        return [token for way in self.ways for token in way.first()]

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns what is left of the symbol that begins with the token."""
        return next(way.after(token) for way in self.ways if token in way.first())


@dataclass(frozen=True, slots=True)
class InOrder:
    """Some of several symbols, each at most once, in their order, and at least ``least`` of them."""

    parts: tuple[Symbol, ...]
    least: int = 0

    @property
    def may_be_empty(self) -> bool:
        """Whether enough symbols have been written."""
        return self.least <= 0

    def first(self) -> Iterable[str]:
        """Returns the tokens with which one of the symbols begins."""
        return [token for part in self.parts for token in part.first()]

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns what is left of the symbol that begins with the token, and the symbols behind it."""
        index = next(index for index, part in enumerate(self.parts) if token in part.first())
        later = self.parts[index + 1 :]
        return (*self.parts[index].after(token), *([InOrder(later, self.least - 1)] if later else []))


@dataclass(frozen=True, slots=True)
class ListTail:
    """Further items of a list, each behind a joint such as ';', at most ``most`` of them."""

    joint: str
    item: Symbol
    most: int

    @property
    def may_be_empty(self) -> bool:
        """True: a list can end."""
        return True

    def first(self) -> Iterable[str]:
        """Returns the joint, or nothing if the list is full."""
        return [self.joint] if self.most else []

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the item and the list behind it."""
        return (self.item, ListTail(self.joint, self.item, self.most - 1))


@dataclass(frozen=True, slots=True)
class Later:
    """A symbol that is made when it is needed, because it contains itself."""

    make: Callable[[], Symbol]
    may_be_empty: bool = False

    def first(self) -> Iterable[str]:
        """Returns the tokens with which the symbol begins."""
        return self.make().first()

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns what is left of the symbol."""
        return self.make().after(token)


Stack = tuple[Symbol, ...]
"""The symbols that must or may follow, the next one first."""


def allowed(stack: Stack) -> list[str]:
    """Returns the tokens that may come next, each once."""
    found: dict[str, None] = {}
    for symbol in stack:
        found |= dict.fromkeys(symbol.first())
        if not symbol.may_be_empty:
            break
    return list(found)


def pushed(stack: Stack, token: str) -> Stack:
    """Returns the stack behind one more token, which must be allowed."""
    for index, symbol in enumerate(stack):
        if token in symbol.first():
            return (*symbol.after(token), *stack[index + 1 :])
        if not symbol.may_be_empty:
            break
    raise ValueError(f"the token '{token}' cannot stand here")
