"""Writes a Brief as one short line, called a plan, and reads it back. Plans are written by models, by people
who label data, and by users who want to state requirements without words that a reader has to interpret.

    turn x3 left up; straight long down; hairpin right | len=300 hard beside(traffic, night)

The clauses are in driving order, separated by ``;``. The requirements for the whole road follow after ``|``.
A number is exact (``3``), a bound (``3..`` or ``..3``) or a range (``3..5``), in the units of the Brief. The
page docs/reference/plans.md describes the language.
"""

import re
from typing import TypeVar, get_args

from pydantic import ValidationError

from roadgpt.brief.model import Amount, Brief, Clause, Kind
from roadgpt.brief.refusal import refused
from roadgpt.errors import BriefError

NUMBER = r"-?\d+(?:\.\d+)?"
AMOUNT = re.compile(rf"({NUMBER})?(\.\.)?({NUMBER})?")
KINDS = frozenset(get_args(Kind))
WORDS = {
    **dict.fromkeys(("left", "right"), "side"),
    **dict.fromkeys(("gentle", "sweeping", "sharp"), "sharpness"),
    **dict.fromkeys(("long", "short"), "size"),
    **dict.fromkeys(("up", "down", "flat", "nearly_flat", "gently_up", "gently_down"), "slope"),
    **dict.fromkeys(("steeply_up", "steeply_down"), "slope"),
}
BARE = dict.fromkeys(("straight", "crest", "dip"), "length")
"""The field that a number without a key sets, by kind of clause; for turns, the number is their angle."""
FLAGS = ("alternating", "hard", "motorway")
KEYS = {"deg": "degrees", "r": "radius", "len": "length", "pct": "incline"}
ROAD_KEYS = {
    "turns": "turns",
    "lefts": "left",
    "rights": "right",
    "turning": "turning",
    "steepest": "steepest",
    "climb": "climb",
    "hills": "hills",
    **KEYS,
}
PLACES = ("starts", "ends")
INNER = "(starts|ends|beside)"
ONE = Amount(lo=1, hi=1)
Model = TypeVar("Model", Brief, Clause)


def plan(brief: Brief) -> str:
    """Returns the plan of a Brief, without ``words``, ``unused``, ``confidence`` and ``other``."""
    wishes = _mods(brief, ROAD_KEYS)
    for place in PLACES:
        clause = getattr(brief, place)
        if clause:
            wishes.append(f"{place}({_clause(clause)})")
    if brief.beside:
        wishes.append(f"beside({', '.join(brief.beside)})")
    line = "; ".join(_clause(clause) for clause in brief.clauses)
    return f"{line} | {' '.join(wishes)}".strip() if wishes else line


def _clause(clause: Clause) -> str:
    count = [] if clause.count == ONE else [f"x{_amount(clause.count)}"]
    return " ".join([clause.kind, *count, *_mods(clause, KEYS)])


def _mods(thing: Clause | Brief, keys: dict[str, str]) -> list[str]:
    """Returns the words, flags and numbers of a clause or of the whole road, in one fixed order."""
    fields = ("side", "sharpness", "size", "slope")
    out = [value for name in fields if (value := getattr(thing, name, None))]
    out += [flag for flag in FLAGS if getattr(thing, flag, False)]
    return out + [
        f"{key}={_amount(a)}" for key, name in keys.items() if (a := getattr(thing, name)) is not None
    ]


def _amount(amount: Amount) -> str:
    if amount.exact:
        return _number(amount.lo)
    low, high = (_number(bound) for bound in (amount.lo, amount.hi))
    return f"{low}..{high}"


def read_plan(line: str) -> Brief:
    """Returns the Brief that a plan describes.

    Raises:
        BriefError: a word, key or number is not part of the plan language, a field is given twice, or the
            plan is a refusal.
    """
    if line.lstrip().startswith("!"):
        raise refused(line)
    clauses, _, wishes = line.partition("|")
    fields: dict[str, object] = {
        "clauses": tuple(_read_clause(part) for part in clauses.split(";") if part.strip())
    }
    for place, inner in re.findall(rf"{INNER}\(([^()]*)\)", wishes):
        names = tuple(name.strip() for name in inner.split(","))
        _set(fields, place, names if place == "beside" else _read_clause(inner))
    for word in re.sub(rf"{INNER}\([^()]*\)", " ", wishes).split():
        _read_mod(fields, word, ROAD_KEYS)
    return _made(Brief, fields, line)


def _read_clause(text: str) -> Clause:
    kind, *words = text.split() or [""]
    if kind not in KINDS:
        raise BriefError(
            f"a plan has no clause '{kind[:40]}'; a clause begins with one of {', '.join(sorted(KINDS))}"
        )
    fields: dict[str, object] = {"kind": kind}
    for word in words:
        if word.startswith("x") and word[1:2] in "0123456789.":
            _set(fields, "count", _read_amount(word[1:]))
        elif word[0] in "0123456789.":
            _set(fields, BARE.get(kind, "degrees"), _read_amount(word))
        elif word[0] == "r" and word[1:2] in "0123456789." and word[1:]:
            _set(fields, "radius", _read_amount(word[1:]))
        else:
            _read_mod(fields, word, KEYS)
    return _made(Clause, fields, text)


def _read_mod(fields: dict[str, object], word: str, keys: dict[str, str]) -> None:
    key, equals, value = word.partition("=")
    if equals and key in keys:
        _set(fields, keys[key], _read_amount(value))
    elif word in FLAGS:
        _set(fields, word, True)
    elif word in WORDS:
        _set(fields, WORDS[word], word)
    else:
        raise BriefError(
            f"a plan has no word '{word[:40]}' here; what is asked of the whole road stands behind |, and "
            "the page 'Plans' of the reference describes the language"
        )


def _set(fields: dict[str, object], name: str, value: object) -> None:
    if name in fields:
        raise BriefError(f"a plan gives {name} twice: '{value}'; give it once")
    fields[name] = value


def _read_amount(text: str) -> Amount:
    match = AMOUNT.fullmatch(text)
    if not match or not (match[1] or match[3]) or (match[1] and match[3] and not match[2]):
        raise BriefError(f"'{text[:40]}' is not a number in a plan; write 3, 3.., ..3 or 3..5")
    low, high = (float(bound) if bound else None for bound in (match[1], match[3]))
    try:
        return Amount(lo=low, hi=high if match[2] else low)
    except ValidationError as error:
        raise BriefError(
            f"the range '{text[:40]}' in a plan is reversed; write the smaller number first"
        ) from error


def _made(model: type[Model], fields: dict[str, object], text: str) -> Model:
    try:
        return model.model_validate(fields)
    except ValidationError as error:
        problem = error.errors()[0]["msg"].removeprefix("Value error, ")
        raise BriefError(f"the plan '{text.strip()[:60]}' is not a Brief: {problem}") from error


def _number(value: float | None) -> str:
    """Returns a number in plain decimals, never with an exponent; an empty string for None."""
    return "" if value is None else f"{value:.6f}".rstrip("0").rstrip(".")
