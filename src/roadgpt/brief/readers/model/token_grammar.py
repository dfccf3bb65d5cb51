"""Grammars of tokens: which tokens may come next, and what follows each token.

A grammar is built of symbols by the functions below. No two alternatives of a symbol begin with the same
token, so the next token decides between them (LL(1)). The state of an unfinished text is a stack of symbols.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache


@dataclass(frozen=True, slots=True)
class Symbol:
    """A part of a grammar, such as a choice between tokens."""

    first: Callable[[], Iterable[str]]
    """Returns the tokens with which the symbol can begin."""
    after: Callable[[str], "Stack"]
    """Returns what follows if the symbol begins with this token."""
    may_be_empty: bool = False
    """Whether the symbol can be left out."""


Stack = tuple[Symbol, ...]
"""The symbols that must or may follow, the next one first."""


def _nothing(token: str) -> Stack:
    return ()


def one_of(*tokens: str, may_be_empty: bool = False) -> Symbol:
    """Returns the symbol for one of several tokens; without tokens, nothing can stand in its place."""
    return Symbol(lambda: tokens, _nothing, may_be_empty)


def sequel(head: Symbol, *rest: Symbol, is_open: bool = False) -> Symbol:
    """Returns the symbol for a sequence of symbols; with ``is_open``, the sequence may be left out."""
    return Symbol(head.first, lambda token: (*head.after(token), *rest), is_open)


def any_of(*ways: Symbol) -> Symbol:
    """Returns the symbol for a choice between several symbols."""

    def after(token: str) -> Stack:
        return next(way.after(token) for way in ways if token in way.first())

    return Symbol(lambda: [token for way in ways for token in way.first()], after)


def in_order(*parts: Symbol, least: int = 0) -> Symbol:
    """Returns the symbol for ``least`` or more of several symbols, each at most once, in the given order."""

    def after(token: str) -> Stack:
        index = next(index for index, part in enumerate(parts) if token in part.first())
        behind = parts[index + 1 :]
        return (*parts[index].after(token), *([in_order(*behind, least=least - 1)] if behind else []))

    return Symbol(lambda: [token for part in parts for token in part.first()], after, least <= 0)


def list_tail(joint: str, item: Symbol, most: int) -> Symbol:
    """Returns the symbol for at most ``most`` further items of a list, each after a separator such as ';'."""
    rest = later(lambda: list_tail(joint, item, most - 1), may_be_empty=True)
    return sequel(one_of(joint) if most else one_of(), item, rest, is_open=True)


def later(make: Callable[[], Symbol], may_be_empty: bool = False) -> Symbol:
    """Returns a symbol that is made when it is needed; a symbol can thus contain itself."""
    made = cache(make)
    return Symbol(lambda: made().first(), lambda token: made().after(token), may_be_empty)


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
