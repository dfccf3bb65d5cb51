"""The grammar reader: deterministic, instant, and plain about what it did not understand."""

from roadgpt.brief.feasible import check
from roadgpt.brief.grammar.context import TURNING, settle
from roadgpt.brief.grammar.lexicon import UNKNOWN, Lexeme, lex
from roadgpt.brief.grammar.phrases import phrases
from roadgpt.brief.grammar.promises import promises
from roadgpt.brief.grammar.quantities import Item, quantities
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
    | {"steep", "hard", "hard_road"}
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
        brief, left_over = promises(phrases(items))
        unused = _unused(found, lexemes, items, left_over)
        share = len(unused) / max(sum(token.sort != "sign" for token in found), 1)
        _about_a_road(words, lexemes, share)
        check(brief, map_size=None)
        told = {"words": words, "unused": unused, "confidence": round(max(0.0, 1.0 - share), 3)}
        return normal(brief).model_copy(update=told)


def _about_a_road(words: str, lexemes: list[Lexeme], share: float) -> None:
    names = {lexeme.name for lexeme in lexemes}
    if (names & SURE and share <= SURE_SHARE) or (names & LIKELY and share <= LIKELY_SHARE):
        return
    start = " ".join(words.split())[:40]
    raise BriefError(f"'{start}' does not describe a road; {EXAMPLE}")


def _unused(
    found: list[Token], lexemes: list[Lexeme], items: list[Item], left_over: list[Item]
) -> tuple[str, ...]:
    """The words that were not understood, as they were written and in order."""
    places = {at for lexeme in lexemes if lexeme.name == UNKNOWN for at in range(lexeme.start, lexeme.stop)}
    for item in [*left_over, *(item for item in items if item.name == "speed")]:
        places |= set(range(item.start, item.stop))
    return tuple(found[at].raw for at in sorted(places) if found[at].sort != "sign" or found[at].raw in "%°")
