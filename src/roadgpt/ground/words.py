"""Reads what land somebody wants: 'a valley between two ridges', 'hilly land with a lake'."""

import re
from typing import NamedTuple

from roadgpt.brief.amount import exactly
from roadgpt.brief.scene import Land, Landform, Lie
from roadgpt.ground.relief import LOOKS, Kind

KINDS: dict[str, Kind] = {
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
SMALL = {"a", "an", "the", "and", "with", "of", "in", "on", "by", "land", "terrain", "country", "landscape"}


class LandWish(NamedTuple):
    """What was read."""

    kind: Kind | None
    lands: tuple[Land, ...]
    unused: tuple[str, ...]  # words that mean nothing here


def land_in(words: str) -> LandWish:
    """Reads English words, or the landscape of a plan such as 'lake left; ridge right'."""
    kind: Kind | None = None
    lands, unused = list[Land](), list[str]()
    count, lie, is_between, side = 1, None, False, None
    for word in re.findall(r"[a-z]+", words.lower()):
        single = (
            word.removesuffix("s") if word.removesuffix("s") in FORMS else word.replace("valleys", "valley")
        )
        if word in KINDS:
            kind = KINDS[word]
        elif word in LOOKS:
            kind = word
        elif single in FORMS:
            form = FORMS[single]
            if is_between and form == "ridge":
                lands += [Land(kind=form, side="left"), Land(kind=form, side="right")]
            else:
                lands.append(Land(kind=form, lie=lie, side=side, count=exactly(count)))
            count, lie, is_between, side = 1, None, False, None
        elif word in NUMBERS:
            count = NUMBERS[word]
        elif word in LIES:
            lie = LIES[word]
        elif word == "between":
            is_between = True
        elif word in ("left", "right") and lands:
            lands[-1] = lands[-1].model_copy(update={"side": word})
        elif word not in SMALL:
            unused.append(word)
    return LandWish(kind, tuple(lands), tuple(unused))
