"""Writes and reads the junctions in a plan.

    straight 80 // crossroads left lights // | up // roundabout exit=3 arms=4 || len=300

Junctions and the roads between them alternate, separated by ``//``. Each road is a plan of its own; a road
without requirements is left out. Requirements for the whole route follow after ``||``.
"""

from typing import get_args

from pydantic import ValidationError

from roadgpt.brief.amount import Amount
from roadgpt.brief.junctions import Control, IslandSize, JunctionClause, Side, Take, Way
from roadgpt.brief.plan_amount import amount_text, read_amount
from roadgpt.errors import BriefError

WORDS = {
    **dict.fromkeys(get_args(Take), "take"),
    **dict.fromkeys(get_args(IslandSize), "size"),
    **dict.fromkeys(get_args(Control), "control"),
}
KEYS = ("degrees", "angle", "exit", "arms", "radius", "outer", "lanes", "length", "taper")
SHORT = {"degrees": "deg", "radius": "r", "length": "len"}
LONG = {short: name for name, short in SHORT.items()}
SIDES = {"ways": "ways", "only_in": "in", "only_out": "out"}
"""The fields of a JunctionClause that list sides, with their keys in a plan."""
FIELDS = {key: name for name, key in SIDES.items()}
SIDE = "side="
DIAMETER = "d"
FLAGS = ("skew", "all_way", "crosswalk", "others_stop")


def junction_plan(junction: JunctionClause) -> str:
    """Returns a junction as part of a plan, such as "crossroads left lights"."""
    words: list[str] = [junction.kind]
    words += [value for name in ("take", "size", "control") if (value := getattr(junction, name))]
    words += [flag for flag in FLAGS if getattr(junction, flag)]
    words += [f"{SIDE}{junction.side}"] if junction.side else []
    words += [f"{key}={'+'.join(ways)}" for name, key in SIDES.items() if (ways := getattr(junction, name))]
    for name in KEYS:
        if (amount := getattr(junction, name)) is not None:
            words.append(f"{SHORT.get(name, name)}={amount_text(amount)}")
    return " ".join(words)


def word_of(field: str) -> str:
    """Returns the key with which plans write a field of JunctionClause, such as "len" for "length"."""
    return SHORT.get(field, SIDES.get(field, field))


def _half(amount: Amount) -> Amount:
    lo, hi = (None if bound is None else bound / 2 for bound in (amount.lo, amount.hi))
    return Amount(lo=lo, hi=hi)


def read_junction(text: str) -> JunctionClause:
    """Returns the junction that a part of a plan describes; the part must not be empty.

    Raises:
        BriefError: A word or number is not part of the plan language, or a field is given twice.
    """
    kind, *words = text.split()
    fields: dict[str, object] = {"kind": kind}
    for word in words:
        key, equals, value = word.partition("=")
        name = LONG.get(key, key)
        if equals and name in KEYS:
            found: tuple[str, object] = (name, read_amount(value))
        elif equals and key == DIAMETER:
            found = ("radius", _half(read_amount(value)))
        elif equals and key in SIDES.values():
            found = (FIELDS[key], tuple(value.split("+")))
        elif word.startswith(SIDE):
            found = ("side", value)
        elif word in FLAGS:
            found = (word, True)
        elif word in WORDS:
            found = (WORDS[word], word)
        else:
            keys = (f"{key}=" for key in (*(SHORT.get(name, name) for name in KEYS), *FIELDS))
            known = ", ".join(sorted((*WORDS, *FLAGS, *keys, SIDE)))
            raise BriefError(f"a plan has no word '{word[:40]}' for a junction; there are {known}")
        if found[0] in fields:
            raise BriefError(
                f"a plan gives {word_of(found[0])} of a junction twice: '{word[:40]}'; give it once"
            )
        fields[found[0]] = found[1]
    try:
        return JunctionClause.model_validate(fields)
    except ValidationError as error:
        ways, sides = (" or ".join(get_args(words)) for words in (Way, Side))
        raise BriefError(
            f"the junction '{text.strip()[:60]}' in a plan cannot be read; ways are {ways}, joined by +, and "
            f"a side is {sides}"
        ) from error
