"""Writes and reads the junctions in a plan.

    straight 80 // crossroads left lights // | up // roundabout exit=3 arms=4 || len=300

Junctions and the roads between them alternate, separated by ``//``. Each road is a plan of its own; a road
without requirements is left out. Requirements for the whole route follow after ``||``.
"""

from typing import get_args

from pydantic import ValidationError

from roadgpt.brief.amount import amount_text, read_amount
from roadgpt.brief.junctions import Control, IslandSize, JunctionClause, Side, Take, Way
from roadgpt.errors import BriefError

WORDS = {
    **dict.fromkeys(get_args(Take), "take"),
    **dict.fromkeys(get_args(IslandSize), "size"),
    **dict.fromkeys(get_args(Control), "control"),
}
KEYS = {
    "deg": "degrees",
    "angle": "angle",
    "exit": "exit",
    "arms": "arms",
    "r": "radius",
    "outer": "outer",
    "lanes": "lanes",
    "len": "length",
    "taper": "taper",
}
SIDES = {"ways": "ways", "in": "only_in", "out": "only_out"}
"""The keys of a plan that list sides, with their fields of a JunctionClause."""
KEY_OF = {name: key for key, name in (KEYS | SIDES).items()}
DIAMETER = "d"
FLAGS = ("skew", "all_way", "crosswalk", "others_stop")


def junction_plan(junction: JunctionClause) -> str:
    """Returns a junction as part of a plan, such as "crossroads left lights"."""
    words: list[str] = [junction.kind]
    words += [value for name in ("take", "size", "control") if (value := getattr(junction, name))]
    words += [flag for flag in FLAGS if getattr(junction, flag)]
    words += [f"side={junction.side}"] if junction.side else []
    words += [f"{key}={'+'.join(ways)}" for key, name in SIDES.items() if (ways := getattr(junction, name))]
    for key, name in KEYS.items():
        if (amount := getattr(junction, name)) is not None:
            words.append(f"{key}={amount_text(amount)}")
    return " ".join(words)


def read_junction(text: str) -> JunctionClause:
    """Returns the junction that a non-empty part of a plan describes. Raises BriefError if a word or number
    is not part of the plan language, or a field is given twice.
    """
    kind, *words = text.split()
    fields: dict[str, object] = {"kind": kind}
    for word in words:
        key, equals, value = word.partition("=")
        name = KEYS.get(key, key)
        if equals and name in KEYS.values():
            found: tuple[str, object] = (name, read_amount(value))
        elif equals and key == DIAMETER:
            found = ("radius", read_amount(value).times(0.5))
        elif equals and key in SIDES:
            found = (SIDES[key], tuple(value.split("+")))
        elif equals and key == "side":
            found = ("side", value)
        elif word in FLAGS:
            found = (word, True)
        elif word in WORDS:
            found = (WORDS[word], word)
        else:
            keys = (f"{key}=" for key in (*KEYS, *SIDES, "side"))
            known = ", ".join(sorted((*WORDS, *FLAGS, *keys)))
            raise BriefError(f"a plan has no word '{word[:40]}' for a junction; there are {known}")
        if found[0] in fields:
            said = KEY_OF.get(found[0], found[0])
            raise BriefError(f"a plan gives {said} of a junction twice: '{word[:40]}'; give it once")
        fields[found[0]] = found[1]
    try:
        return JunctionClause.model_validate(fields)
    except ValidationError as error:
        ways, sides = (" or ".join(get_args(words)) for words in (Way, Side))
        raise BriefError(
            f"the junction '{text.strip()[:60]}' in a plan cannot be read; ways are {ways}, joined by +, and "
            f"a side is {sides}"
        ) from error
