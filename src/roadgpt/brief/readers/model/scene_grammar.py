"""The grammar of scenes: what may stand behind the tokens of a road, a route or a map. Behind ``:`` stand the
wishes for it that a text tells among its story (its kind, its design speed, where one comes from), and behind
``&&`` the scene.

    | lanes= 1 against= 1 : country from= south speed= [2] && ego v= [1] ; truck ahead : brake ; night

What follows what comes from the tables of ``brief.scene``, by which plans are read."""

from collections.abc import Sequence
from functools import cache, partial
from typing import get_args

from roadgpt.brief.plan import SCENE, TESTED_CAR
from roadgpt.brief.readers.model.grammar import (
    Numbers,
    Stack,
    Symbol,
    any_of,
    description,
    in_order,
    later,
    one_of,
    sequel,
)
from roadgpt.brief.readers.model.vocabulary import RAINS, WISHES
from roadgpt.brief.scene import (
    ANYTHING,
    CUES,
    DOINGS,
    NUMBERS,
    ON_ITS_WAY,
    ONE_OF,
    SPOTS,
    STRUCTURES,
    ActorKind,
    Flow,
    Landform,
    Lie,
    Light,
    Role,
    Surface,
    What,
    Where,
)
from roadgpt.brief.words import Compass, Surroundings

MOST_ACTORS, MOST_PATCHES, MOST_LANDS, MOST_ACTIONS = 6, 2, 5, 4
MOST_SAME = tuple(map(str, range(1, 10)))
SIDES = ("left", "right")


def whole(numbers: Numbers) -> Symbol:
    """Returns the symbol for a road, a route or a map, with what is told beside it."""
    return sequel(description(numbers), told(numbers))


def told(numbers: Numbers) -> Symbol:
    """Returns the symbol for a scene and the wishes before it; all of it may be left out."""
    key = numbers.keyed
    origin = sequel(one_of("from="), one_of(*get_args(Compass)))
    wishes = in_order(one_of(*get_args(Surroundings), "motorway"), origin, numbers.design_speed(), least=1)
    lane = sequel(one_of("lane="), any_of(one_of(*MOST_SAME[:4]), sequel(one_of("-"), one_of("1", "2", "3"))))
    itself = sequel(one_of(TESTED_CAR), in_order(one_of(*SIDES, "straight"), key("v="), lane, least=1))
    parts = [
        itself,
        *[_actor(numbers)] * MOST_ACTORS,
        one_of(*get_args(Flow)),
        sequel(one_of("oncoming"), one_of(*get_args(Flow), "none")),
        *(sequel(one_of("parked"), one_of(*SIDES)) for _ in SIDES),
        _with_amount("fog", numbers),
        any_of(_with_amount("rain", numbers), one_of(*RAINS)),
        one_of(*get_args(Light)),
        one_of(*get_args(Surface)),
        *[sequel(one_of("slippery"), in_order(*map(key, ("mu=", "s=", "len="))))] * MOST_PATCHES,
        *[_land(numbers)] * MOST_LANDS,
    ]
    scene = sequel(one_of(SCENE), _joined(parts))
    both = any_of(sequel(one_of(WISHES), wishes, Symbol(scene.first, scene.after, True)), scene)
    return Symbol(both.first, both.after, may_be_empty=True)


def _joined(parts: Sequence[Symbol]) -> Symbol:
    """Returns the symbol for one or more of the parts, each at most once, in this order, and ';' between."""

    @cache
    def behind(index: int) -> Symbol:
        if index == len(parts):
            return one_of(may_be_empty=True)
        return sequel(one_of(";"), later(lambda: since(index)), is_open=True)

    @cache
    def since(index: int) -> Symbol:
        return any_of(
            *(sequel(part, behind(place + 1)) for place, part in enumerate(parts) if place >= index)
        )

    return since(0)


def _with_amount(name: str, numbers: Numbers) -> Symbol:
    """Returns the symbol for a condition, with or without an amount of the text."""
    return sequel(one_of(name), numbers.amount(f"{name}=", may_be_empty=True))


def _actor(numbers: Numbers) -> Symbol:
    def after_kind(kind: str) -> Stack:
        places = {where: spot for where, spot in SPOTS.items() if kind in spot.who}
        after = {str(where): partial(_after_place, kind, where, numbers) for where in places}
        return sequel(numbers.keyed("x"), is_open=True), Symbol(lambda: places, lambda where: after[where]())

    return Symbol(lambda: ANYTHING, after_kind)


def _after_place(kind: str, where: Where, numbers: Numbers) -> Stack:
    sides = [*SIDES, *(["opposite"] if where == "junction" else [])] if SPOTS[where].before_side else []
    fields = [name for name in NUMBERS if name in Role.model_fields and where in NUMBERS[name].where]
    if kind not in DOINGS["keep"].who or where == "parked":
        fields = [name for name in fields if name not in ("speed", "faster")]
    groups = [[name for name in fields if name in group] for group in (*ONE_OF[:3], ["away"])]
    keys = [_one_key(names, numbers) for names in groups]
    doings = [what for what, doing in DOINGS.items() if kind in doing.who]
    first = [what for what in doings if where in DOINGS[what].starts]
    later_on = [what for what in doings if what not in ON_ITS_WAY or what in first]
    actions = _actions(first, later_on, MOST_ACTIONS, numbers)
    return (
        in_order(*([one_of(*sides)] if sides else []), *keys, _mark()),
        sequel(one_of(":"), actions, is_open=True) if first else one_of(may_be_empty=True),
    )


def _actions(first: Sequence[What], later_on: Sequence[What], most: int, numbers: Numbers) -> Symbol:
    after = {str(what): partial(_after_doing, what, numbers) for what in first}
    head = Symbol(lambda: first, lambda what: after[what]())
    if most == 1:
        return head
    return sequel(
        head,
        sequel(one_of(","), later(lambda: _actions(later_on, later_on, most - 1, numbers)), is_open=True),
    )


def _after_doing(what: What, numbers: Numbers) -> Stack:
    doing = DOINGS[what]
    side = [one_of(*SIDES)] if doing.has_side else []
    keys = [_one_key([name], numbers) for name in NUMBERS if name in doing.numbers]
    cue = any_of(_one_key([name for name in CUES if name in NUMBERS], numbers), _mark(is_of_action=True))
    return (in_order(*side, *keys, cue),)


def _one_key(names: Sequence[str], numbers: Numbers) -> Symbol:
    """Returns the symbol for one of several numbers with its key."""
    given = [NUMBERS[name] for name in names if name in NUMBERS]
    return any_of(*(numbers.keyed(f"{each.key}=", is_signed=each.least < 0) for each in given))


@cache
def _mark(is_of_action: bool = False) -> Symbol:
    """Returns the symbol for a part of the route, such as "after turn 1", and, for when an action begins,
    also for what another actor does, such as "with truck 1 brake"."""
    last = sequel(one_of("-"), one_of("1"))
    place = sequel(one_of("turn", "junction"), any_of(one_of(*MOST_SAME), last))
    event = sequel(one_of(*get_args(ActorKind)), one_of(*MOST_SAME), one_of(*DOINGS))
    if not is_of_action:
        return sequel(one_of("after", "before", "in"), place)
    after = sequel(one_of("after"), any_of(place, event))
    return any_of(sequel(one_of("before", "in"), place), after, sequel(one_of("with"), event))


def _land(numbers: Numbers) -> Symbol:
    count, length = numbers.keyed("x"), numbers.keyed("len=")
    structures = sequel(one_of(*STRUCTURES), in_order(count, length))
    lies = in_order(count, one_of(*get_args(Lie)), one_of(*SIDES), length)
    forms = [form for form in get_args(Landform) if form not in STRUCTURES]
    return any_of(structures, sequel(one_of(*forms), lies))
