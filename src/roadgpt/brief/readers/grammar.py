"""The grammar reader: deterministic, instant, and plain about what it did not understand."""

from roadgpt.brief.feasible import check
from roadgpt.brief.grammar.brief_builder import build_brief
from roadgpt.brief.grammar.chunking import chunk
from roadgpt.brief.grammar.context import TURNING, settle
from roadgpt.brief.grammar.lexicon import UNKNOWN, Lexeme, is_strange, lex, similar
from roadgpt.brief.grammar.quantities import Term, quantities
from roadgpt.brief.grammar.tokens import Token, tokens
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.errors import BriefError

MOST_CHARACTERS = 2000
EXAMPLE = "say for example 'an uphill road with 3 turns'"
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
"""Words that speak of roads and of little else."""
LIKELY = frozenset(
    {"straight", "crest", "dip", "hill", "left", "right", "up", "down", "up~", "down~", "flat", "flat~"}
    | {"steep", "hard", "hard_road", "slope", "hills", "height", "radius", "%"}
)
LIKELY_SHARE = 0.2  # of words not understood, above which such words alone are taken for chance
SURE_SHARE = 0.75  # above which even one word about roads is


class GrammarReader:
    """Reads descriptions by rules."""

    def read(self, words: str) -> Brief:
        """The Brief of a description, in normal form.

        Raises:
            BriefError: empty, too long, not about a road, or in contradiction with itself.
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
        check(brief, map_size=None, min_radius=0.0)  # what a world allows is asked in brief.read
        told = {"words": words, "unused": unused, "confidence": round(max(0.0, 1.0 - share), 3)}
        return normal(brief).model_copy(update=told)


def _about_a_road(words: str, found: list[Token], lexemes: list[Lexeme], share: float) -> None:
    """Passes words that speak of roads, and of which enough was understood.

    Args:
        words: as they were written.
        found: their tokens.
        lexemes: their meanings.
        share: of words that were not understood, whether they are known or not.

    Raises:
        BriefError: with the word that may have been meant, or what is wrong with those that are known.
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
            f"'{start}' has halves, which are not understood; give each part a length, as in"
            " 'flat for 100 m, then uphill for 100 m'"
        )
    meant = [(word, near) for word in strange if (near := similar(word))]
    if meant and names & (SURE | LIKELY) and len(meant) == len(strange):
        raise BriefError(f"'{meant[0][0]}' is not understood; did you mean '{meant[0][1]}'?")
    raise BriefError(f"'{start}' does not describe a road; {EXAMPLE}")


def _unused(
    found: list[Token], lexemes: list[Lexeme], items: list[Term], left_over: list[Term]
) -> tuple[str, ...]:
    """The words that were not understood, as they were written and in order."""
    places = {at for lexeme in lexemes if lexeme.name == UNKNOWN for at in range(lexeme.start, lexeme.stop)}
    for item in [*left_over, *(item for item in items if item.name in ("speed", UNKNOWN))]:
        places |= set(range(item.start, item.stop))
    return tuple(found[at].raw for at in sorted(places) if found[at].sort != "sign" or found[at].text in "%°")
