"""The grammar reader: reads descriptions by rules, without a model, and reports the words it did not
understand.
"""

from roadgpt.brief.feasible import check
from roadgpt.brief.grammar.brief_builder import build_brief
from roadgpt.brief.grammar.chunking import chunk
from roadgpt.brief.grammar.context import TURNING, settle
from roadgpt.brief.grammar.lexicon import UNKNOWN, Lexeme, is_strange, lex, similar
from roadgpt.brief.grammar.quantities import Term, quantities
from roadgpt.brief.grammar.tokens import Token, tokens
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.refusal import EXAMPLE, MOST_CHARACTERS
from roadgpt.errors import BriefError

SURE = TURNING | {
    "road",
    "straight+",
    "crest+",
    "dip+",
    "hilly",
    "highway",
    "mountain",
    "more_left",
    "more_right",
    "same_sides",
}
"""Meanings that occur in descriptions of roads and hardly anywhere else; a text with one of them is taken for
the description of a road, unless more than three quarters of its words are unknown."""
LIKELY = frozenset(
    {"straight", "crest", "dip", "hill", "left", "right", "up", "down", "up~", "down~", "flat", "flat~"}
    | {"steep", "hard", "hard_road", "slope", "hills", "height", "radius", "%"}
)
LIKELY_SHARE = 0.2  # share of unknown words above which such words alone do not make it a road
SURE_SHARE = 0.75  # share of unknown words above which no word makes it a road


class GrammarReader:
    """Reads descriptions by rules."""

    def read(self, words: str) -> Brief:
        """Returns the Brief of a description, in normal form.

        Raises:
            BriefError: the description is empty, too long, not about a road, or contradicts itself.
        """
        if not words.strip():
            raise BriefError(f"the description is empty; {EXAMPLE}")
        if len(words) > MOST_CHARACTERS:
            raise BriefError(
                f"the description has {len(words):,} characters; {MOST_CHARACTERS:,} is the limit: shorten it"
            )
        found = tokens(words)
        lexemes = lex(found)
        items = settle(quantities(lexemes))
        brief, left_over = build_brief(chunk(items))
        unused = _unused(found, lexemes, items, left_over)
        share = len(unused) / max(sum(token.sort != "sign" for token in found), 1)
        _about_a_road(words, found, lexemes, share)
        check(brief, map_size=None, min_radius=0.0)  # the limits of a World are checked in brief.read
        told = {"words": words, "unused": unused, "confidence": round(max(0.0, 1.0 - share), 3)}
        return normal(brief).model_copy(update=told)


def _about_a_road(words: str, found: list[Token], lexemes: list[Lexeme], share: float) -> None:
    """Checks that the words are about a road and that enough of them was understood.

    Args:
        words: the description.
        found: its tokens.
        lexemes: the meanings of the tokens.
        share: share of words that were not understood, whether or not a vocabulary has them.

    Raises:
        BriefError: says which word may have been meant, or what to write instead.
    """
    names = {lexeme.name for lexeme in lexemes}
    said = [token.text for token in found if token.sort != "sign"]
    strange = [lexeme.text for lexeme in lexemes if lexeme.name == UNKNOWN and is_strange(lexeme.text)]
    likely = names & LIKELY and len(strange) <= LIKELY_SHARE * len(said)
    if share <= SURE_SHARE and (names & SURE or likely):
        return
    start = " ".join(words.split())
    start = start if len(start) <= 40 else f"{start[:40].rstrip()} ..."
    if "half" in said or names & {"half1", "half2"}:
        raise BriefError(
            f"'{start}' speaks of halves, which are not understood; give each part a length, as in"
            " 'flat for 100 m, then uphill for 100 m'"
        )
    meant = [(word, near) for word in strange if (near := similar(word))]
    if meant and names & (SURE | LIKELY) and len(meant) == len(strange):
        raise BriefError(f"'{meant[0][0]}' is not understood; did you mean '{meant[0][1]}'?")
    raise BriefError(f"'{start}' does not describe a road; {EXAMPLE}")


def _unused(
    found: list[Token], lexemes: list[Lexeme], items: list[Term], left_over: list[Term]
) -> tuple[str, ...]:
    """Returns the words that were not understood, as they were written and in order."""
    places = {at for lexeme in lexemes if lexeme.name == UNKNOWN for at in range(lexeme.start, lexeme.stop)}
    for item in [*left_over, *(item for item in items if item.name in ("speed", UNKNOWN))]:
        places |= set(range(item.start, item.stop))
    return tuple(found[at].raw for at in sorted(places) if found[at].sort != "sign" or found[at].text in "%°")
