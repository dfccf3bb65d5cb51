"""Grammars of tokens, made of objects that return which tokens may come next and what follows each token.

A grammar is built of the symbols below. No two alternatives of a symbol begin with the same token, so the
next token decides between them (LL(1)). The state of an unfinished text is a stack of symbols.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol


class Symbol(Protocol):
    """A part of a grammar, such as a choice between tokens."""

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
        """Returns an empty tuple."""
        return ()


@dataclass(frozen=True, slots=True)
class Sequel:
    """A first symbol, the head, and the symbols that follow it.

    With ``is_open``, the whole sequence may be left out.
    """

    head: Symbol
    rest: tuple[Symbol, ...]
    is_open: bool = False

    @property
    def may_be_empty(self) -> bool:
        """Whether the whole sequence may be left out."""
        return self.is_open

    def first(self) -> Iterable[str]:
        """Returns the tokens with which the head begins."""
        return self.head.first()

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the rest of the head, and the symbols after the head."""
        return (*self.head.after(token), *self.rest)


@dataclass(frozen=True, slots=True)
class AnyOf:
    """One of several symbols."""

    ways: tuple[Symbol, ...]

    @property
    def may_be_empty(self) -> bool:
        """Always False: a symbol must be chosen."""
        return False

    def first(self) -> Iterable[str]:
        """Returns the tokens with which one of the symbols begins."""
        return [token for way in self.ways for token in way.first()]

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the rest of the symbol that begins with the token."""
        return next(way.after(token) for way in self.ways if token in way.first())


@dataclass(frozen=True, slots=True)
class InOrder:
    """At least ``least`` of several symbols, each at most once and in the given order."""

    parts: tuple[Symbol, ...]
    least: int = 0

    @property
    def may_be_empty(self) -> bool:
        """Whether none of the symbols is required."""
        return self.least <= 0

    def first(self) -> Iterable[str]:
        """Returns the tokens with which one of the symbols begins."""
        return [token for part in self.parts for token in part.first()]

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the rest of the symbol that begins with the token, and the symbols after this symbol."""
        index = next(index for index, part in enumerate(self.parts) if token in part.first())
        later = self.parts[index + 1 :]
        return (*self.parts[index].after(token), *([InOrder(later, self.least - 1)] if later else []))


@dataclass(frozen=True, slots=True)
class ListTail:
    """At most ``most`` further items of a list, each after a separator such as ';'."""

    joint: str
    item: Symbol
    most: int

    @property
    def may_be_empty(self) -> bool:
        """Always True: the list may end here."""
        return True

    def first(self) -> Iterable[str]:
        """Returns the separator, or nothing if the list is full."""
        return [self.joint] if self.most else []

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the item and the rest of the list."""
        return (self.item, ListTail(self.joint, self.item, self.most - 1))


@dataclass(frozen=True, slots=True)
class Later:
    """A symbol that is created when it is needed; a symbol can thus contain itself."""

    make: Callable[[], Symbol]
    may_be_empty: bool = False

    def first(self) -> Iterable[str]:
        """Returns the tokens with which the symbol begins."""
        return self.make().first()

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the rest of the symbol."""
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
    """Returns the stack after one more token; the token must be allowed."""
    for index, symbol in enumerate(stack):
        if token in symbol.first():
            return (*symbol.after(token), *stack[index + 1 :])
        if not symbol.may_be_empty:
            break
    raise ValueError(f"the token '{token}' cannot stand here")
