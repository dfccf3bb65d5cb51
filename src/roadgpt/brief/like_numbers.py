"""Gives the parts of a road that must be alike the numbers that are given for one of them."""

from collections.abc import Container

from roadgpt.brief.model import Brief, Clause

NAMED_BY = {"degrees": "sharpness", "radius": "sharpness", "length": "size"}
"""The numbers that like parts share, and the field whose word stands in the place of such a number."""


def with_like_numbers(brief: Brief) -> Brief:
    """Returns a Brief whose clauses of one kind have the angle, radius or length that one of them is given.

    Clauses with a word instead, such as "sharp", keep it, and so do all if several numbers are given. A Brief
    that does not ask for like parts is returned unchanged.
    """
    if not brief.alike:
        return brief
    clauses = brief.clauses
    for name, word in NAMED_BY.items():
        given = {(each.kind, number) for each in clauses if (number := getattr(each, name)) is not None}
        kinds = [kind for kind, _ in given]
        only = {kind: number for kind, number in given if kinds.count(kind) == 1}
        clauses = tuple(
            each.model_copy(update={name: only[each.kind]}) if _is_open(each, name, word, only) else each
            for each in clauses
        )
    return brief if clauses == brief.clauses else brief.model_copy(update={"clauses": clauses})


def _is_open(clause: Clause, name: str, word: str, only: Container[str]) -> bool:
    return clause.kind in only and getattr(clause, name) is None and getattr(clause, word) is None
