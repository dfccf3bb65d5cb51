"""Reads what land somebody wants: 'a valley between two ridges', 'hilly land with a lake'."""

import re
from typing import NamedTuple

from roadgpt.brief.amount import exactly
from roadgpt.brief.scene import Land, Lie
from roadgpt.brief.words import LandKind
from roadgpt.language.names import Landform

KINDS: dict[str, LandKind] = {
    "flat": "flat", "level": "flat", "plain": "flat", "rolling": "rolling", "gentle": "rolling",
    "hills": "hilly", "hilly": "hilly", "hill": "hilly", "mountain": "mountain", "mountains": "mountain",
    "mountainous": "mountain", "alpine": "mountain", "steep": "mountain",
}  # fmt: skip
FORMS: dict[str, Landform] = {
    "valley": "valley", "ridge": "ridge", "cliff": "ridge", "lake": "lake", "pond": "lake", "river": "river",
    "stream": "river", "coast": "coast", "sea": "coast", "shore": "coast", "forest": "forest",
    "wood": "forest", "trees": "forest",
}  # fmt: skip
NUMBERS = {"two": 2, "three": 3, "four": 4}
LIES: dict[str, Lie] = {"along": "along", "across": "across", "through": "through", "crossed": "across"}
SMALL = {
    "a", "an", "the", "with", "of", "in", "on", "by", "to", "at", "land", "terrain", "country", "landscape",
}  # fmt: skip


class LandWish(NamedTuple):
    """What was read."""

    kind: LandKind | None
    lands: tuple[Land, ...]
    unused: tuple[str, ...]  # words that mean nothing here


def land_in(words: str) -> LandWish:
    """Reads English words, or the landscape of a plan such as 'lake left; ridge right'. How a way leads, as
    in 'across', belongs to what stands before it in the same part of the text, or else to what comes next."""
    kind: LandKind | None = None
    lands, unused = list[Land](), list[str]()
    for part in re.split(r"[;,.]|\band\b", words.lower()):
        own, lie, count, is_between = list[Land](), None, 1, False
        for word in re.findall(r"[a-z]+\d*", part):
            form = FORMS.get(word) or FORMS.get(word.removesuffix("s"))
            if word in KINDS:
                kind = KINDS[word]
            elif form is not None and is_between and form == "ridge":
                own += [Land(kind=form, side="left"), Land(kind=form, side="right")]
            elif form is not None:
                own.append(Land(kind=form, lie=lie, count=exactly(count)))
                lie, count = None, 1
            elif word in NUMBERS:
                count = NUMBERS[word]
            elif re.fullmatch(r"x[1-9]", word) and own:
                own[-1] = own[-1].model_copy(update={"count": exactly(int(word[1:]))})
            elif word in LIES and own and own[-1].lie is None:
                own[-1] = own[-1].model_copy(update={"lie": LIES[word]})
            elif word in LIES:
                lie = LIES[word]
            elif word == "between":
                is_between, count = True, 1
            elif word in ("left", "right") and own:
                own[-1] = own[-1].model_copy(update={"side": word})
            elif word not in SMALL:
                unused.append(word)
        lands += own
    return LandWish(kind, tuple(lands), tuple(unused))
