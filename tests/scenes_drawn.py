"""Scenes that Hypothesis draws: actors with what they do, the landscape, and whole scenes."""

from typing import Any, get_args

from hypothesis import strategies as st
from pydantic import ValidationError

from roadgpt.brief.amount import Amount, between, exactly
from roadgpt.brief.scene import ON_ITS_WAY, Action, Air, Land, Lie, Mark, Role, Scene, Side
from roadgpt.language.names import Flow, Landform, Light, Surface, What, Where
from roadgpt.language.table import LANDFORMS, MANEUVERS, NUMBERS, PLACES, WEATHER
from strategies import amounts, maybe


def numbers(model: type[Action] | type[Role]) -> dict[str, Any]:
    return {
        name: maybe(amounts(*each[1:3]), 3) for name, each in NUMBERS.items() if name in model.model_fields
    }


def one_of(*groups: tuple[str, ...], where: str) -> st.SearchStrategy[dict[str, Any]]:
    """At most one number of each group, of those that suit a place."""
    own = [[name for name in group if where in NUMBERS[name].where] for group in groups]
    of_groups = [
        st.one_of(
            st.just({}),
            *(amounts(*NUMBERS[name][1:3]).map(lambda it, n=name: {n: it}) for name in group),
        )
        for group in own
    ]
    return st.tuples(*of_groups).map(lambda found: {name: it for each in found for name, it in each.items()})


def drawn(model: Any, **fields: Any) -> st.SearchStrategy[Any]:
    """Those of the drawn values of which a valid thing can be made."""

    def made(values: dict[str, Any]) -> Any:
        try:
            return model(**values)
        except ValidationError:
            return None

    return st.fixed_dictionaries(fields).map(made).filter(lambda each: each is not None)


PARTS = st.builds(
    Mark,
    word=st.sampled_from(["after", "before", "in"]),
    of=st.sampled_from(["turn", "junction"]),
    number=st.sampled_from([-1, 1, 2, 12]),
)
SIDES = st.none() | st.sampled_from(get_args(Side))


CUES = {"at": PARTS} | {
    name: amounts(*NUMBERS[name][1:3]) for name in ("time", "distance", "ttc", "headway", "gap", "station")
}


def actions(whats: list[What]) -> st.SearchStrategy[Action]:
    """One action of these, with the numbers that it can have, on one condition or none."""
    cue = st.one_of(st.just({}), *(each.map(lambda it, n=name: {n: it}) for name, each in CUES.items()))
    return st.sampled_from(whats).flatmap(
        lambda what: st.builds(
            lambda cue, **own: Action(what=what, **own, **cue),
            cue=cue,
            side=SIDES if MANEUVERS[what].side else st.none(),
            **{name: each for name, each in numbers(Action).items() if name in MANEUVERS[what].numbers},
        )
    )


@st.composite
def roles(draw: st.DrawFn) -> Role:
    where = draw(st.sampled_from(get_args(Where)))
    kind = draw(st.sampled_from(PLACES[where].who))
    can = [what for what in get_args(What) if kind in MANEUVERS[what].who]
    first = [what for what in can if where in MANEUVERS[what].starts]
    later = [what for what in can if what not in ON_ITS_WAY or what in first]
    rest = st.lists(actions(later), max_size=2) if later else st.just([])
    acts = st.builds(lambda one, more: (one, *more), actions(first), rest) if first else st.just(())
    side = SIDES if PLACES[where].side else st.none()
    stands = where == "parked" or kind not in MANEUVERS["keep"].who
    speeds = () if stands else (("speed", "faster"),)
    more = draw(one_of(("gap", "headway", "station"), *speeds, ("overlap", "impact", "offset"), where=where))
    at = maybe(PARTS) if not more.keys() & {"gap", "headway", "station"} else st.none()
    fields = {
        "kind": st.just(kind),
        "count": st.sampled_from([exactly(1), exactly(3), between(1, 50), Amount(lo=2)]),
        "where": st.just(where),
        "side": side | st.just("opposite") if where == "junction" else side,
        "at": at,
        "actions": acts | st.just(()),
    }
    return draw(drawn(Role, **fields, **{name: st.just(it) for name, it in more.items()}))


@st.composite
def casts(draw: st.DrawFn) -> tuple[Role, ...]:
    """Several roles; the last may wait for what the first does."""
    cast = draw(st.lists(roles(), max_size=3))
    if len(cast) > 1 and cast[0].actions and cast[-1].actions and draw(st.booleans()):
        word, awaited = draw(st.sampled_from(["after", "with"])), cast[0].actions[-1].what
        mark = Mark(word=word, of=cast[0].kind, number=1, what=awaited)
        action = cast[-1].actions[-1]
        free = {name: getattr(action, name) for name in ("what", "side", *MANEUVERS[action.what].numbers)}
        waits = (*cast[-1].actions[:-1], Action(**free, at=mark))
        cast[-1] = cast[-1].model_copy(update={"actions": waits})
    return tuple(cast)


LANDS = st.sampled_from(get_args(Landform)).flatmap(
    lambda kind: st.builds(
        Land,
        kind=st.just(kind),
        lie=st.none() if LANDFORMS[kind].structure else st.none() | st.sampled_from(get_args(Lie)),
        side=st.none() if LANDFORMS[kind].structure else SIDES,
        count=st.sampled_from([exactly(1), exactly(3)]),
        length=maybe(amounts(1, 10_000)),
    )
)
WEATHERS = st.tuples(
    *(
        maybe(amounts(row.least, row.most).map(lambda amount, kind=kind: Air(kind=kind, amount=amount)))
        for kind, row in WEATHER.items()
    )
).map(lambda found: tuple(filter(None, found)))
SCENES = drawn(
    Scene,
    speed=maybe(amounts(0, 250)),
    person=st.sampled_from([None, "robot", "test_robot"]),
    lane=st.sampled_from([None, 1, 2, -1, -4]),
    landscape=st.lists(LANDS, max_size=2).map(tuple),
    actors=casts(),
    flow=st.none() | st.sampled_from(get_args(Flow)),
    oncoming=st.none() | st.sampled_from([*get_args(Flow), "none"]),
    parked=st.lists(st.sampled_from(get_args(Side))).map(tuple),
    weather=WEATHERS,
    light=st.none() | st.sampled_from(get_args(Light)),
    surface=st.none() | st.sampled_from(get_args(Surface)),
)
