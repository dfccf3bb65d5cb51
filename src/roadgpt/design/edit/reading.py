"""Reads change requests by rules: words -> Request. Verb: ``read_request``.

The words are cut into clauses at commas and at 'and'. Each clause names a place and what is to be different
there; what it leaves out is taken from the clause before, or from the one behind: 'make the first and the
last turn sharper', 'make it longer, too'.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from roadgpt.design.edit.lexing import UNKNOWN, Lexeme, lexemes
from roadgpt.design.edit.naming import NOUNS, PLACES, named, place_at
from roadgpt.design.edit.request import Change, Place, Request, Target
from roadgpt.design.edit.wording import wanted
from roadgpt.errors import EditError

MOST_CHARACTERS = 2000
SEPARATORS = {"comma", "and", "then", "stop"}
IDLE = {"too", "make", "with", "of", "at", "as", "to", "by", "a", "the", "on"}
"""Words that ask for nothing by themselves."""
AT = {"at_start": "start", "at_end": "end", "at_mid": "middle"}
ADVICE = "say what is to be different where, for example: make the second turn sharper, and the end downhill"


@dataclass
class Clause:
    """What was found in one clause."""

    targets: list[Target] = field(default_factory=list)
    new: list[Target] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    row: list[Lexeme] = field(default_factory=list)
    """What is left: verbs, comparatives and amounts."""
    unknown: list[str] = field(default_factory=list)
    words: str = ""

    @property
    def names(self) -> set[str]:
        """Of all meanings that are left."""
        return {lexeme.name for lexeme in self.row}

    @property
    def is_action(self) -> bool:
        """Does it say what is to be done?"""
        is_side = "make" in self.names and any(target.is_bare for target in self.targets)
        return bool(self.new) or is_side or bool(self.names - IDLE)


def read_request(words: str) -> Request:
    """What a change request asks for.

    Raises:
        EditError: it is empty, too long, or asks for no change that is known.
    """
    if not words.strip():
        raise EditError(f"no change was asked for; {ADVICE}")
    if len(words) > MOST_CHARACTERS:
        raise EditError(
            f"a change request of {len(words)} characters is too long; use {MOST_CHARACTERS} or less"
        )
    row = lexemes(words)
    refused = next((x.text for x in row if x.name == "not"), None)
    if refused:
        raise EditError(f"'{refused}' is not understood in a change request; {ADVICE}")
    clauses = [_clause(part) for part in _parts(row)]
    clauses = [clause for clause in clauses if clause.words]
    changes = _changes(clauses)
    unused = tuple(word for clause in clauses for word in clause.unknown)
    if not changes:
        told = f"'{_short(words)}' is no change of a road that I know"
        raise EditError(f"{told}; {ADVICE}")
    return Request(words, tuple(changes), unused)


def _short(words: str) -> str:
    plain = " ".join(words.split())
    return plain if len(plain) <= 60 else f"{plain[:59]}…"


def _parts(row: Sequence[Lexeme]) -> list[list[Lexeme]]:
    """The clauses; an 'and' within a name of places cuts nothing."""
    out: list[list[Lexeme]] = [[]]
    at = 0
    while at < len(row):
        lexeme = row[at]
        if lexeme.name in SEPARATORS:
            out.append([])
            at += 1
            continue
        stop = at + 1
        found = None
        if lexeme.name in PLACES:
            stop_, place = place_at(row, at)
            stop = stop_ if place else stop
        else:
            found = named(row, at)
            stop = found.stop if found else stop
        out[-1] += row[at:stop]
        at = stop
    return [part for part in out if part]


def _clause(row: Sequence[Lexeme]) -> Clause:
    out = Clause(words=" ".join(x.text for x in row if x.text))
    at = 0
    while at < len(row):
        lexeme = row[at]
        if lexeme.name == UNKNOWN:
            out.unknown.append(lexeme.text)
            at += 1
            continue
        if lexeme.name in AT:
            how: Any = AT[lexeme.name]
            out.places.append(Place(how))
            at += 1
            continue
        if lexeme.name == "turn" and at == 0 and len(row) > 1 and _is_verb(row):
            at += 1
            continue
        if lexeme.name in PLACES:
            stop, place = place_at(row, at)
            if place:
                out.places.append(place)
                at = stop
                continue
        found = named(row, at + (lexeme.name == "but"))
        if found and lexeme.name == "but":
            if out.targets:
                out.targets[-1] = replace(out.targets[-1], but=found.target, every=True)
            at = found.stop
            continue
        if found:
            target = found.target
            if out.targets and not target.is_definite:  # 'make the second and the last turn left turns'
                target = replace(target, indefinite=True)
            (out.new if target.is_new else out.targets).append(target)
            at = found.stop
            continue
        out.row.append(lexeme)
        at += 1
    return out


def _is_verb(row: Sequence[Lexeme]) -> bool:
    """'Turn the second bend left': the first word is what to do."""
    return row[1].name in ("the", "every", "ord", "it") and any(x.name in NOUNS for x in row[1:])


def _changes(clauses: Sequence[Clause]) -> list[Change]:
    out: list[Change] = []
    before: tuple[Target, ...] = ()
    waiting: list[Clause] = []
    last: Clause | None = None
    for number, clause in enumerate(clauses):
        if _complains(clause):  # 'the second turn is too gentle, make it sharper'
            rest = clauses[number + 1 :]
            if rest and rest[0].is_action and all(target.noun == "it" for target in rest[0].targets):
                before = tuple(clause.targets) or before
                continue
        if not clause.is_action:
            if not clause.targets and not clause.places:
                if clause.unknown:
                    _not_understood(clause)
                continue
            if _is_side_of_new(clause, out):
                out[-1] = replace(out[-1], side=clause.targets[0].side)
                continue
            added = [index for index, change in enumerate(out) if change.what == "add"]
            if not clause.targets and added:  # 'add a left turn, radius 40 m, after the second turn'
                out[added[-1]] = replace(out[added[-1]], place=clause.places[0])
                continue
            is_last = not any(other.is_action for other in clauses[number + 1 :])
            if clause.unknown and is_last and not out:
                _not_understood(clause)
            if is_last and last is not None:  # 'make the first turn sharper, and the last'
                targets = [_like(target, before) for target in clause.targets]
                out += wanted(replace(last, targets=targets, new=[], words=clause.words), before)
                before = tuple(clause.targets)
            else:
                waiting.append(clause)
            continue
        targets = [target for other in waiting for target in other.targets] + clause.targets
        waiting_places = [place for other in waiting for place in other.places]
        waiting = []
        targets = [_like(target, before) for target in targets]
        whole = replace(clause, targets=targets, places=waiting_places + clause.places)
        found = wanted(whole, before)
        if not found and clause.unknown:
            _not_understood(clause)
        out += found
        last = clause
        before = tuple(dict.fromkeys(c.target for c in found if c.target is not None)) or before
    if waiting:
        said = " and ".join(clause.words for clause in waiting)
        if out and last is None:
            return out
        raise EditError(f"what is to be different about '{_short(said)}' is not said; {ADVICE}")
    return out


TOO = {"gentle": "sharper", "sharp": "gentler", "sweeping": "tighter", "long": "shorter", "short": "longer",
       "steep": "flatter", "flat": "steeper"}  # fmt: skip
"""What is wanted of what is too long."""


def _complains(clause: Clause) -> bool:
    """Is something too long? Then the clause is one that wants it shorter."""
    if "too" not in clause.names or not clause.names & TOO.keys():
        return False
    clause.row = [replace(x, name=TOO.get(x.name, x.name)) for x in clause.row if x.name != "too"]
    return True


def _is_side_of_new(clause: Clause, out: Sequence[Change]) -> bool:
    """'Add an S-bend, first to the right'."""
    return bool(out) and out[-1].what == "add" and bool(clause.targets) and clause.targets[0].is_bare


def _like(target: Target, before: Sequence[Target]) -> Target:
    """'The first one' is a straight where straights were spoken of before."""
    nouns = [other.noun for other in before if other.noun in ("turn", "straight")]
    return replace(target, noun=nouns[-1]) if target.noun is None and nouns else target


def _not_understood(clause: Clause) -> None:
    told = ", ".join(f"'{word}'" for word in clause.unknown)
    raise EditError(f"{told} in '{_short(clause.words)}' is not understood; {ADVICE}")
