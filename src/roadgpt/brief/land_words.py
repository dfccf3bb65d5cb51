"""Reads what land somebody wants: 'a valley between two ridges', 'hilly land with a lake'."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from roadgpt.brief.amount import exactly
from roadgpt.brief.scene import LAND_KINDS, Land, Lie
from roadgpt.brief.words import LandKind
from roadgpt.language.names import Landform
from roadgpt.language.table import LANDFORMS, SCENES

SAID: Mapping[str, str] = SCENES["words_of_land"]
KINDS: dict[str, LandKind] = {word: kind for kind in LAND_KINDS for word in SAID[kind].split()}
FORMS: dict[str, Landform] = {word: form for form in LANDFORMS for word in SAID.get(form, "").split()}
NUMBERS = {"two": 2, "three": 3, "four": 4}
LIES: dict[str, Lie] = {"along": "along", "across": "across", "through": "through", "crossed": "across"}


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
            elif word not in SAID["small"].split():
                unused.append(word)
        lands += own
    return LandWish(kind, tuple(lands), tuple(unused))
