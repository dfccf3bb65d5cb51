"""The sentence that a Brief says itself in is read back by the grammar as the same Brief."""

from hypothesis import assume, given, settings

from roadgpt.brief import Brief, Clause, check, exactly, normal, sentence
from roadgpt.brief.normal import SINGLE, STRAIGHT
from roadgpt.brief.readers.grammar import GrammarReader
from roadgpt.errors import BriefError
from strategies import briefs, sensible_briefs


def is_possible(brief: Brief) -> bool:
    try:
        check(brief, map_size=None)
    except BriefError:
        return False
    return True


def _is_one(clause: Clause) -> bool:
    return clause.kind in SINGLE | STRAIGHT and clause.count == exactly(1)


def can_be_said(brief: Brief) -> bool:
    """Not in words: a last thing besides clauses, several last things, lengths of the turns of a chicane."""
    said = normal(brief)
    edges = [clause for clause in (said.starts, said.ends) if clause]
    if len(edges) > 1 or (edges and said.clauses) or any(not _is_one(c) for c in edges):
        return False
    return not any(c.length and c.kind not in SINGLE | STRAIGHT for c in said.clauses)


@settings(max_examples=150, deadline=None)
@given(sensible_briefs())
def test_sensible_briefs_read_back(brief: Brief) -> None:
    assume(is_possible(brief))
    again = GrammarReader().read(sentence(brief))
    assert normal(again) == normal(brief)
    assert again.unused == ()
    assert again.confidence == 1


@settings(max_examples=200, deadline=None)
@given(briefs())
def test_all_that_can_be_said_reads_back(brief: Brief) -> None:
    assume(is_possible(brief) and can_be_said(brief))
    assert normal(GrammarReader().read(sentence(brief))) == normal(brief)
