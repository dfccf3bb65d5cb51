"""The grammar of scenes: what may stand behind the tokens of a road, a route or a map. Behind ``:`` stand the
wishes for it that a text tells among its story (its kind, its design speed, where one comes from), and behind
``&&`` the scene.

    | lanes= 1 against= 1 : country from= south speed= [2] && ego v= [1] ; truck ahead : brake ; night

What follows what comes from the tables of ``brief.scene``, by which plans are read."""

from collections.abc import Sequence
from functools import cache, partial
from typing import cast, get_args

from roadgpt.brief.amount import Frozen
from roadgpt.brief.plan import SCENE, TESTED_CAR
from roadgpt.brief.readers.model.grammar import (
    MORE_OR_LESS,
    MOST_CHANGES,
    Numbers,
    Stack,
    Symbol,
    any_of,
    change_request,
    description,
    factors,
    in_order,
    later,
    list_tail,
    one_of,
    sequel,
)
from roadgpt.brief.readers.model.vocabulary import RAINS, WISHES, value_of, written
from roadgpt.brief.scene import LAND_KINDS, ON_ITS_WAY, ONE_OF, Land, Lie, Patch, Role
from roadgpt.brief.words import Compass, Surroundings
from roadgpt.language.names import What, Where
from roadgpt.language.table import (
    CUES,
    FLOWS,
    LANDFORMS,
    LIGHTS,
    MANEUVERS,
    NUMBERS,
    PLACES,
    ROAD_USERS,
    SURFACES,
    WEATHER,
)  # fmt: skip

KINDS, WHATS, AIRS = written(ROAD_USERS), cast("list[What]", written(MANEUVERS)), written(WEATHER)
FORMS, WHERES = written(LANDFORMS), cast("list[Where]", written(PLACES))
STRUCTURES = written(form for form, row in LANDFORMS.items() if row.structure)
MOST_ACTORS, MOST_PATCHES, MOST_LANDS, MOST_ACTIONS = 6, 2, 5, 4
MOST_SAME = tuple(map(str, range(1, 10)))
SIDES = ("left", "right")
ONE_SIDE = one_of(*SIDES, "opposite")
WHICH = (
    *(any_of(one_of(*MOST_SAME), sequel(one_of("-"), one_of(*MOST_SAME))) for _ in range(3)),
    one_of("all"),
)
"""Which of several alike things are meant."""


def whole(numbers: Numbers) -> Symbol:
    """Returns the symbol for a road, a route or a map, with what is told beside it."""
    return sequel(description(numbers), told(numbers))


def told(numbers: Numbers) -> Symbol:
    """Returns the symbol for a scene and the wishes before it; all of it may be left out."""
    origin = sequel(one_of("from="), one_of(*get_args(Compass)))
    wishes = in_order(one_of(*get_args(Surroundings), "motorway"), origin, numbers.design_speed(), least=1)
    scene = sequel(one_of(SCENE), _joined([_tested_car(numbers), *_parts(numbers)]))
    both = any_of(sequel(one_of(WISHES), wishes, Symbol(scene.first, scene.after, True)), scene)
    return Symbol(both.first, both.after, may_be_empty=True)


def _tested_car(numbers: Numbers) -> Symbol:
    lane = sequel(one_of("lane="), any_of(one_of(*MOST_SAME[:4]), sequel(one_of("-"), one_of("1", "2", "3"))))
    ways = one_of(*SIDES, "straight")
    return sequel(one_of(TESTED_CAR), in_order(one_of("robot"), ways, numbers.keyed("v="), lane, least=1))


def _parts(numbers: Numbers) -> list[Symbol]:
    """Returns the symbols for the parts of a scene, in their order, but for the tested car."""
    key = numbers.keyed
    return [
        *[_actor(numbers)] * MOST_ACTORS,
        one_of(*FLOWS),
        sequel(one_of("oncoming"), one_of(*FLOWS, "none")),
        *(sequel(one_of("parked"), one_of(*SIDES)) for _ in SIDES),
        *(_air(kind, numbers) for kind in AIRS),
        one_of(*LIGHTS),
        one_of(*SURFACES),
        *[sequel(one_of("slippery"), in_order(*map(key, ("mu=", "s=", "len="))))] * MOST_PATCHES,
        *[_land(numbers)] * MOST_LANDS,
    ]


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


def _air(kind: str, numbers: Numbers) -> Symbol:
    """Returns the symbol for a kind of weather, with or without an amount of the text."""
    symbol = sequel(one_of(kind), numbers.amount(f"{kind}=", may_be_empty=True))
    return any_of(symbol, one_of(*RAINS)) if kind == "rain" else symbol


def _actor(numbers: Numbers) -> Symbol:
    def after_kind(kind: str) -> Stack:
        places = [where for where in WHERES if kind in PLACES[where].who]
        after = {str(where): partial(_after_place, kind, where, numbers) for where in places}
        return sequel(numbers.keyed("x"), is_open=True), Symbol(lambda: places, lambda where: after[where]())

    return Symbol(lambda: KINDS, after_kind)


def _after_place(kind: str, where: Where, numbers: Numbers) -> Stack:
    sides = [*SIDES, *(["opposite"] if where == "junction" else [])] if PLACES[where].side else []
    fields = [name for name in NUMBERS if name in Role.model_fields and where in NUMBERS[name].where]
    if kind not in MANEUVERS["keep"].who or where == "parked":
        fields = [name for name in fields if name not in ("speed", "faster")]
    if where == "crossing":  # the networks were not trained to write its gap to a part of the route
        fields.remove("gap")
    apart = (group for group in ONE_OF[:-1] if "at" not in group)
    groups = [[name for name in fields if name in group] for group in (*apart, ["away"])]
    keys = [_one_key(names, numbers) for names in groups]
    doings = [what for what in WHATS if kind in MANEUVERS[what].who]
    first = [what for what in doings if where in MANEUVERS[what].starts]
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
    doing = MANEUVERS[what]
    side = [one_of(*SIDES)] if doing.side else []
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
    event = sequel(one_of(*KINDS), one_of(*MOST_SAME), one_of(*WHATS))
    if not is_of_action:
        return sequel(one_of("after", "before", "in"), place)
    after = sequel(one_of("after"), any_of(place, event))
    return any_of(sequel(one_of("before", "in"), place), after, sequel(one_of("with"), event))


def _land(numbers: Numbers) -> Symbol:
    count, length = numbers.keyed("x"), numbers.keyed("len=")
    structures = sequel(one_of(*STRUCTURES), in_order(count, length))
    away = numbers.keyed("away=")
    lies = in_order(count, one_of(*get_args(Lie)), one_of(*SIDES), length, away)
    forms = [form for form in FORMS if form not in STRUCTURES]
    return any_of(structures, sequel(one_of(*forms), lies))


def any_change(numbers: Numbers) -> Symbol:
    """Returns the symbol for a request that changes the road, the scene or both."""
    change = _scene_change(numbers)
    scene = sequel(one_of(SCENE), change, list_tail(";", change, MOST_CHANGES - 1))
    road = sequel(change_request(numbers), Symbol(scene.first, scene.after, True))
    return any_of(road, scene)


def _scene_change(numbers: Numbers) -> Symbol:
    """Returns the symbol for one change of a scene: what is added, or something and what is to be of it."""
    actor = any_of(
        sequel(one_of("add"), _actions(WHATS, [], 1, numbers)),
        sequel(one_of("as"), in_order(one_of(*KINDS), one_of(*WHERES), ONE_SIDE, least=1)),
        Symbol(lambda: WHATS, lambda what: (_of_doing(cast(What, what), numbers),)),
        *_of_thing(Role, numbers),
    )
    levels = one_of(*FLOWS, "none")
    things: dict[tuple[str, ...], tuple[Sequence[Symbol], Symbol]] = {
        (*KINDS, "actor"): ((*WHICH, one_of(*WHERES), ONE_SIDE), actor),
        (*FORMS, "landscape"): ((*WHICH, one_of(*SIDES)), any_of(*_of_thing(Land, numbers))),
        ("slippery",): (WHICH, any_of(*_of_thing(Patch, numbers))),
        (TESTED_CAR,): ((), any_of(sequel(one_of("v="), _value("v=", numbers)), one_of("remove"))),
        ("traffic", "oncoming"): ((), any_of(one_of("remove"), levels, *MORE_OR_LESS)),
        ("land",): ((), any_of(*MORE_OR_LESS)),
        **{(kind,): ((), any_of(one_of("remove"), _value(f"{kind}=", numbers))) for kind in AIRS},
        ("parked",): ([one_of(*SIDES)], one_of("remove")),
        (*LIGHTS, *SURFACES, "scene"): ((), one_of("remove")),
    }
    known = [
        sequel(one_of(*names), in_order(*which), one_of(":"), wish) for names, (which, wish) in things.items()
    ]
    parts = {tuple(part.first()): part for part in _parts(numbers)}  # each kind once
    new = any_of(_tested_car(numbers), *parts.values(), one_of(*LAND_KINDS))
    return any_of(sequel(one_of("add"), new), *known)


def _of_thing(kind: type[Frozen], numbers: Numbers) -> list[Symbol]:
    """Returns the symbols for what can be changed of each thing of a kind: its numbers and how many it is."""
    keys = [NUMBERS[name].key for name in kind.model_fields if name in NUMBERS]
    count = one_of(*(each for each in numbers.of("x") if value_of(each, numbers.slots) >= 1))
    counted = any_of(sequel(one_of(".."), count), sequel(count, one_of("..", may_be_empty=True)))
    is_counted = "count" in kind.model_fields
    return [
        one_of("remove"),
        *([sequel(one_of("x"), counted)] if is_counted else []),
        *(sequel(one_of(f"{key}="), _value(f"{key}=", numbers)) for key in keys),
    ]


def _of_doing(what: What, numbers: Numbers) -> Symbol:
    names = [*MANEUVERS[what].numbers, *(name for name in CUES if name in NUMBERS)]
    keys = [f"{NUMBERS[name].key}=" for name in names]
    usual = [_value(keys[0], numbers)] if MANEUVERS[what].numbers else []
    return any_of(
        one_of("remove"), *usual, *(sequel(one_of(key), _value(key, numbers)) for key in dict.fromkeys(keys))
    )


def _value(key: str, numbers: Numbers) -> Symbol:
    """Returns the symbol for a change of a number: to a figure, by a figure or a factor, more or less."""
    found = numbers.of(key)
    name = key.removesuffix("=")
    is_signed = any(number.key == name and number.least < 0 for number in NUMBERS.values())
    below = [sequel(one_of("-"), one_of(*found))] if is_signed else []
    exact = sequel(one_of("="), any_of(one_of(*found), *below))
    figures = [exact, sequel(one_of("..", "+", "-"), one_of(*found))] if found else []
    bounds = [sequel(one_of(*found), one_of(".."))] if found else []
    return any_of(*figures, *bounds, *factors(numbers), *MORE_OR_LESS)
