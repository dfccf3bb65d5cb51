"""Reads change requests by rules, and returns each as an EditRequest. Main function: ``read_request``.

The words are split into clauses at commas and at 'and'. Each clause names a place and the change to make
there; what a clause omits is taken from the clause before or after it: 'make the first and the last turn
sharper', 'make it longer, too'.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from roadgpt.design.edit.clause import RequestClause
from roadgpt.design.edit.gathering import ADVICE, gathered, short
from roadgpt.design.edit.lexing import UNKNOWN, RequestLexeme, lexemes
from roadgpt.design.edit.naming import NOUNS, PLACES, SIDED, named, place_at
from roadgpt.design.edit.request import Change, EditRequest, Place, Target
from roadgpt.design.edit.rewording import reworded
from roadgpt.errors import EditError

MOST_CHARACTERS = 2000
SEPARATORS = {"comma", "and", "then", "stop"}
AT = {"at_start": "start", "at_end": "end", "at_mid": "middle"}


def read_request(words: str) -> EditRequest:
    """Reads what a change request asks for.

    Raises:
        EditError: the request is empty, too long, or asks for no known change.
    """
    if not words.strip():
        raise EditError(f"no change was asked for; {ADVICE}")
    if len(words) > MOST_CHARACTERS:
        raise EditError(
            f"a change request of {len(words)} characters is too long; use {MOST_CHARACTERS} or less"
        )
    row = reworded(lexemes(words))
    refused = next((x.text for x in row if x.name == "not"), None)
    if refused:
        raise EditError(f"'{refused}' is not understood in a change request; {ADVICE}")
    clauses = _with_amounts([clause for part in _parts(row) if (clause := _clause(part)).words])
    kept = [target for clause in clauses if clause.keeps for target in clause.targets]
    changes = _settled([_sparing(change, kept) for change in gathered(clauses)])
    sides = {(change.target, change.side): change for change in changes if change.what == "side"}
    if len(sides) > len({target for target, _ in sides}):
        raise EditError("the same turns are to go left and right; say which turn is to go where")
    unused = tuple(word for clause in clauses for word in clause.unknown)
    if not changes:
        told = f"'{short(words)}' is no change of a road that I know"
        raise EditError(f"{told}; {ADVICE}")
    return EditRequest(words, _folded(changes), unused)


def _settled(changes: Sequence[Change]) -> list[Change]:
    """'Make turn 2 tighter, with a radius of 20 m': what a number is said of as well is settled by it."""
    bends = {"angle", "radius"}
    said = [c for c in changes if c.to is not None or c.by is not None or c.times is not None]

    def is_said(change: Change) -> bool:
        is_vague = change.more != 0 and change not in said
        alike = [c for c in said if c.target == change.target]
        return is_vague and any(c.what == change.what or {c.what, change.what} <= bends for c in alike)

    return [change for change in changes if not is_said(change)]


def _parts(row: Sequence[RequestLexeme]) -> list[list[RequestLexeme]]:
    """The clauses; an 'and' within a name of places cuts nothing."""
    out: list[list[RequestLexeme]] = [[]]
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


def _clause(row: Sequence[RequestLexeme]) -> RequestClause:
    out = RequestClause(words=" ".join(x.text for x in row if x.text), begins_unknown=row[0].name == UNKNOWN)
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
            at = _behind_road(row, at + 1)
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


def _behind_road(row: Sequence[RequestLexeme], at: int) -> int:
    """'In the middle of the road' is a place, and speaks of no road."""
    found = named(row, at + 1) if at < len(row) and row[at].name in ("of", "on") else None
    return found.stop if found and found.target.noun == "road" and not found.target.half else at


def _is_verb(row: Sequence[RequestLexeme]) -> bool:
    """'Turn the second bend left': the first word is what to do."""
    things = {*NOUNS, *SIDED, "left", "right"}
    return row[1].name in ("the", "every", "ord", "it") and any(x.name in things for x in row[1:])


def _with_amounts(clauses: Sequence[RequestClause]) -> list[RequestClause]:
    """'Make it shorter, 300 m in total': a number by itself belongs to what stands before it."""
    out: list[RequestClause] = []
    for clause in clauses:
        before = out[-1] if out else None
        if clause.is_amount and before and before.is_action and "#" not in before.names:
            before.row += [*([] if clause.names & {"by", "to"} else [RequestLexeme("to", "")]), *clause.row]
            before.words = f"{before.words}, {clause.words}"
        else:
            out.append(clause)
    return out


def _sparing(change: Change, kept: Sequence[Target]) -> Change:
    """'Make all turns sharper, but leave the second one alone'."""
    target = change.target
    kept = [replace(one, noun=one.noun or "turn") for one in kept]
    kept = [one for one in kept if target and target.noun in (one.noun, "road")]
    is_counted = target is not None and bool(target.numbers)
    if target is None or target.but or not kept or is_counted or not (target.every or target.noun == "road"):
        return change
    numbers = tuple(number for one in kept for number in one.numbers)
    if len(kept) > 1 and not all(one.numbers and one.noun == kept[0].noun for one in kept):
        raise EditError("several things are to be left alone; name them with numbers: leave turns 1 and 3")
    return replace(change, target=replace(target, but=replace(kept[0], numbers=numbers)))


def _folded(changes: Sequence[Change]) -> tuple[Change, ...]:
    """What is said of a new turn is a part of its addition: 'add a left turn, downhill at 5 %'."""
    out: list[Change] = []
    for change in changes:
        is_of_new = change.target is not None and change.target.indefinite and change.what != "add"
        last = next((i for i in reversed(range(len(out))) if out[i].what == "add"), None)
        if not is_of_new:
            out.append(change)
        elif last is None:
            raise EditError(f"which one is meant in '{change.words}' is not said; say: the second turn")
        else:
            out[last] = _with(out[last], change)
    return tuple(out)


def _with(added: Change, more: Change) -> Change:
    match more.what:
        case "slope":
            grade = None if more.to is None else -abs(more.to) if more.way == "down" else more.to
            return replace(added, way=more.way or added.way, grade=grade)
        case "angle":
            return replace(added, degrees=more.to or added.degrees)
        case "radius":
            return replace(added, radius=more.to or added.radius)
        case "length":
            return replace(added, length=more.to or added.length)
        case "side":
            return replace(added, side=more.side or added.side)
        case "shape":
            return replace(added, kind=more.kind or added.kind, sharpness=more.sharpness or added.sharpness)
        case _:
            return added
