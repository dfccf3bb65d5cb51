"""Turns clauses into changes; what a clause omits is taken from its neighbours. Main function:
``gathered``.
"""

from collections.abc import Sequence
from dataclasses import replace

from roadgpt.design.edit.clause import RequestClause
from roadgpt.design.edit.request import Change, Target
from roadgpt.design.edit.wording import VERBS, wanted
from roadgpt.errors import EditError

ADVICE = "say what is to be different where, for example: make the second turn sharper, and the end downhill"


def gathered(clauses: Sequence[RequestClause]) -> list[Change]:
    """Returns the changes that the clauses ask for.

    Raises:
        EditError: a clause cannot be understood, or does not say what is to be changed.
    """
    work = _Gathering()
    for number, clause in enumerate(clauses):
        rest = clauses[number + 1 :]
        if _complains_of_it(clause) and work.last is not None:
            continue  # 'flatten the second straight, it's too steep'
        if clause.keeps or (_complains(clause) and _is_settled(rest)):
            work.before = tuple(clause.targets) or work.before
        elif clause.is_action:
            work.act(clause)
        elif clause.targets or clause.places:
            work.name(clause, is_last=not any(other.is_action for other in rest))
        elif clause.unknown:
            _not_understood(clause)
    return work.done()


class _Gathering:
    """The changes so far, and what the next clause may leave out."""

    def __init__(self) -> None:
        self.changes: list[Change] = []
        self.before: tuple[Target, ...] = ()
        """What was spoken of before."""
        self.waiting: list[RequestClause] = []
        """Names of which it is still to be said what is wanted."""
        self.last: RequestClause | None = None

    def act(self, clause: RequestClause) -> None:
        """Takes a clause that says what is to be done."""
        if clause.begins_unknown and not clause.names & {
            *VERBS,
            "make",
            "add",
        }:  # 'rotate the road by 90 degrees'
            _not_understood(clause)
        targets = [target for other in self.waiting for target in other.targets] + clause.targets
        places = [place for other in self.waiting for place in other.places] + clause.places
        self.waiting = []
        targets = [_like(target, self.before) for target in targets]
        found = wanted(replace(clause, targets=targets, places=places), self.before)
        is_lost = not (targets or places or clause.new)  # then it would be done to the whole road
        if clause.unknown and (not found or is_lost):
            _not_understood(clause)
        self.changes += found
        self.last = clause
        self.before = tuple(dict.fromkeys(c.target for c in found if c.target is not None)) or self.before

    def name(self, clause: RequestClause, is_last: bool) -> None:
        """Takes a clause that only names places; the last one is to be changed as was said before."""
        added = [index for index, change in enumerate(self.changes) if change.what == "add"]
        if self._is_side_of_new(clause):
            self.changes[-1] = replace(self.changes[-1], side=clause.targets[0].side)
        elif not clause.targets and added:  # 'add a left turn, radius 40 m, after the second turn'
            self.changes[added[-1]] = replace(self.changes[added[-1]], place=clause.places[0])
        elif clause.unknown:  # what is wanted of the places may be among these words
            _not_understood(clause)
        elif is_last and self.last is not None:  # 'make the first turn sharper, and the last'
            targets = [_like(target, self.before) for target in clause.targets]
            self.changes += wanted(
                replace(self.last, targets=targets, new=[], words=clause.words), self.before
            )
            self.before = tuple(clause.targets)
        else:
            self.waiting.append(clause)

    def done(self) -> list[Change]:
        """Returns all changes.

        Raises:
            EditError: nothing says what to do with a place that was named.
        """
        if self.waiting and not (self.changes and self.last is None):
            said = " and ".join(clause.words for clause in self.waiting)
            raise EditError(f"what is to be different about '{short(said)}' is not said; {ADVICE}")
        return self.changes

    def _is_side_of_new(self, clause: RequestClause) -> bool:
        """'Add an S-bend, first to the right'."""
        is_bare = bool(clause.targets) and clause.targets[0].is_bare
        return is_bare and bool(self.changes) and self.changes[-1].what == "add"


def _is_settled(rest: Sequence[RequestClause]) -> bool:
    """'The second turn is too gentle, make it sharper': does the clause behind a complaint say what to do?"""
    return bool(rest) and rest[0].is_action and all(t.noun == "it" or t.is_that for t in rest[0].targets)


def _complains_of_it(clause: RequestClause) -> bool:
    return (
        "too" in clause.names
        and bool(clause.names & TOO.keys())
        and all(t.noun == "it" for t in clause.targets)
    )


def short(words: str) -> str:
    """Returns the words in one line of at most 60 characters, to be quoted in a message."""
    plain = " ".join(words.split())
    return plain if len(plain) <= 60 else f"{plain[:59]}…"


TOO = {"gentle": "sharper", "sharp": "gentler", "sweeping": "tighter", "long": "shorter", "short": "longer",
       "steep": "flatter", "flat": "steeper"}  # fmt: skip
"""What is wanted of what is too long."""


def _complains(clause: RequestClause) -> bool:
    """Is something too long? Then the clause is one that wants it shorter."""
    if "too" not in clause.names or not clause.names & TOO.keys():
        return False
    clause.row = [replace(x, name=TOO.get(x.name, x.name)) for x in clause.row if x.name != "too"]
    return True


def _like(target: Target, before: Sequence[Target]) -> Target:
    """'The first one' is a straight where straights were spoken of before."""
    nouns = [other.noun for other in before if other.noun in ("turn", "straight")]
    return replace(target, noun=nouns[-1]) if target.noun is None and nouns else target


def _not_understood(clause: RequestClause) -> None:
    told = ", ".join(f"'{word}'" for word in clause.unknown)
    raise EditError(f"{told} in '{short(clause.words)}' is not understood; {ADVICE}")
