"""Reads limits from phrases with 'no' or 'not', such as 'no steeper than 6 %'. Main function: ``bounded``."""

from dataclasses import replace

from roadgpt.design.edit.lexing import RequestLexeme

Row = list[RequestLexeme]
THINGS = {"turn", "straight", "slope_noun"}
BOUNDS = {
    "steeper": ("at_most", "slope_noun"),
    "flatter": ("at_least", "slope_noun"),
    "longer": ("at_most", "length_noun"),
    "shorter": ("at_least", "length_noun"),
    "sharper": ("at_most", "angle_noun"),
    "gentler": ("at_least", "angle_noun"),
    "tighter": ("at_least", "radius"),
    "wider": ("at_most", "radius"),
    "more": ("at_most", ""),
    "less": ("at_least", ""),
    "over": ("at_most", ""),
}
"""What 'no steeper than' sets."""


def _name(row: Row, at: int) -> str:
    return row[at].name if 0 <= at < len(row) else ""


def _apart(lexeme: RequestLexeme, behind: str) -> tuple[RequestLexeme, ...]:
    """'No slope' is level, 'no slope over 3 %' is none."""
    if lexeme.text.lower() != "no slope" or behind not in BOUNDS:
        return (lexeme,)
    return RequestLexeme("not", "no"), RequestLexeme("slope_noun", "slope")


def bounded(row: Row) -> Row:
    """Returns the lexemes with negated comparisons, such as 'no steeper than', replaced by 'at most' or
    'at least'.
    """
    row = [y for at, x in enumerate(row) for y in _apart(x, _name(row, at + 1))]
    out: Row = []
    at = 0
    while at < len(row):
        noun = row[at + 1] if row[at].name == "not" and _name(row, at + 1) in THINGS else None
        if (
            noun and _name(row, at + 2) in BOUNDS and "#" in (_name(row, at + 3), _name(row, at + 4))
        ):  # 'no straight longer than'
            every = [RequestLexeme("every", "all"), replace(noun, text=f"{noun.text}s")]
            out += [noun] if noun.name == "slope_noun" else every
            row = [*row[:at], row[at], *row[at + 2 :]]
        is_over = _name(row, at + 1) == "over"
        than = is_over or _name(row, at + 2) in ("not", "as")
        bound = BOUNDS.get(_name(row, at + 1)) if row[at].name == "not" and than else None
        stop = at + (2 if is_over else 3)
        if bound and _name(row, stop) == "#":
            words = " ".join(x.text for x in row[at:stop])
            out += [RequestLexeme(bound[0], words), *([RequestLexeme(bound[1], "")] if bound[1] else [])]
            at = stop
            continue
        out.append(row[at])
        at += 1
    return out
