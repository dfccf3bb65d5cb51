"""Scenes in plans: what is read, written, said and refused, and what the catalogues of others need."""

import re
from pathlib import Path
from typing import Any, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from roadgpt.brief import read
from roadgpt.brief.amount import Amount, at_most, between, exactly
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import plan, read_plan, read_scene, scene_plan
from roadgpt.brief.scene import (
    DOINGS,
    FLOWS,
    LIGHTS,
    NUMBERS,
    ON_ITS_WAY,
    SPOTS,
    STRUCTURES,
    WEATHER,
    Action,
    ActorKind,
    Flow,
    Land,
    Landform,
    Lie,
    Light,
    Mark,
    Role,
    Scene,
    Side,
    Surface,
    What,
    Where,
    scene_text,
)
from roadgpt.brief.sentence import sentence
from roadgpt.errors import BriefError
from strategies import amounts, briefs, maybe
from tables import rows

KINDS = get_args(ActorKind)
PAGE = Path(__file__).parents[2] / "docs" / "reference" / "plans.md"


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


PLACES = st.builds(
    Mark,
    word=st.sampled_from(["after", "before", "in"]),
    of=st.sampled_from(["turn", "junction"]),
    number=st.sampled_from([-1, 1, 2, 12]),
)
SIDES = st.none() | st.sampled_from(get_args(Side))


CUES = {"at": PLACES} | {
    name: amounts(*NUMBERS[name][1:3]) for name in ("time", "distance", "ttc", "headway", "gap", "station")
}


def actions(whats: list[What]) -> st.SearchStrategy[Action]:
    """One action of these, with the numbers that it can have, on one condition or none."""
    cue = st.one_of(st.just({}), *(each.map(lambda it, n=name: {n: it}) for name, each in CUES.items()))
    return st.sampled_from(whats).flatmap(
        lambda what: st.builds(
            lambda cue, **own: Action(what=what, **own, **cue),
            cue=cue,
            side=SIDES if DOINGS[what].has_side else st.none(),
            **{name: each for name, each in numbers(Action).items() if name in DOINGS[what].numbers},
        )
    )


@st.composite
def roles(draw: st.DrawFn) -> Role:
    where = draw(st.sampled_from(get_args(Where)))
    kind = draw(st.sampled_from(SPOTS[where].who))
    can = [what for what in get_args(What) if kind in DOINGS[what].who]
    first = [what for what in can if where in DOINGS[what].starts]
    later = [what for what in can if what not in ON_ITS_WAY or what in first]
    rest = st.lists(actions(later), max_size=2) if later else st.just([])
    acts = st.builds(lambda one, more: (one, *more), actions(first), rest) if first else st.just(())
    side = SIDES if SPOTS[where].before_side else st.none()
    stands = where == "parked" or kind not in DOINGS["keep"].who
    speeds = () if stands else (("speed", "faster"),)
    more = draw(one_of(("gap", "headway", "station"), *speeds, ("overlap", "impact", "offset"), where=where))
    at = maybe(PLACES) if not more.keys() & {"gap", "headway", "station"} else st.none()
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
        free = {name: getattr(action, name) for name in ("what", "side", *DOINGS[action.what].numbers)}
        waits = (*cast[-1].actions[:-1], Action(**free, at=mark))
        cast[-1] = cast[-1].model_copy(update={"actions": waits})
    return tuple(cast)


LANDS = st.sampled_from(get_args(Landform)).flatmap(
    lambda kind: st.builds(
        Land,
        kind=st.just(kind),
        lie=st.none() if kind in STRUCTURES else st.none() | st.sampled_from(get_args(Lie)),
        side=st.none() if kind in STRUCTURES else SIDES,
        count=st.sampled_from([exactly(1), exactly(3)]),
        length=maybe(amounts(1, 10_000)),
    )
)
SCENES = drawn(
    Scene,
    speed=maybe(amounts(0, 250)),
    person=st.none() | st.just("robot"),
    lane=st.sampled_from([None, 1, 2, -1, -4]),
    landscape=st.lists(LANDS, max_size=2).map(tuple),
    actors=casts(),
    flow=st.none() | st.sampled_from(get_args(Flow)),
    oncoming=st.none() | st.sampled_from([*get_args(Flow), "none"]),
    parked=st.lists(st.sampled_from(get_args(Side))).map(tuple),
    fog=maybe(amounts(5, 1000)),
    rain=maybe(amounts(0.1, 200)),
    light=st.none() | st.sampled_from(get_args(Light)),
    surface=st.none() | st.sampled_from(get_args(Surface)),
)


@given(briefs(), SCENES)
def test_a_scene_comes_back_from_its_plan_with_any_road(brief: Brief, scene: Scene) -> None:
    assert read_scene(scene_plan(scene)) == scene
    assert scene_plan(read_scene(scene_plan(scene))) == scene_plan(scene)
    whole = brief.model_copy(update={"scene": scene})
    assert read_plan(plan(whole)) == whole
    assert plan(whole).partition(" && ")[0].removesuffix("&&").strip() in (plan(brief), "", plan(whole))
    assert ("&&" in plan(whole)) == (scene != Scene())
    assert Brief.model_validate_json(whole.model_dump_json()) == whole


@given(SCENES)
def test_a_scene_is_said_in_plain_words(scene: Scene) -> None:
    said = scene_text(scene)
    assert not [part for part in ("None", "  ", "_", "..", "=", "{") if part in said]
    told = sentence(Brief(scene=scene))
    assert told == (f"A road; {said}." if said else "A road.")
    for number in {end for role in scene.actors if (gap := role.gap) for end in (gap.lo, gap.hi) if end}:
        assert f"{number:.4f}".rstrip("0").rstrip(".") in said


WORDS = (
    *("car", "truck x2", "adult", "cones", "ahead", "lane left", "crossing", "parked", "oncoming", ":", ","),
    *(";", "&&", "brake 6", "cut_in", "cross", "gap=30", "v=50", "ttc=2", "after turn 1", "with car 1 brake"),
    *("medium", "fog", "rain 5", "ego", "night", "wet", "x0", "turn", "5..3", "opposite"),
    *("lane=0", "lane=-1", "lake", "along", "bridge"),
)  # fmt: skip


@given(st.lists(st.sampled_from(WORDS), max_size=8).map(" ".join))
def test_any_order_of_words_is_a_scene_or_a_sentence(text: str) -> None:
    try:
        scene = read_plan(f"turn && {text}").scene
        told = scene_text(read_scene(scene_plan(scene)))
        same = told == scene_text(scene)
    except BriefError as error:
        told, same = str(error), "Input" not in str(error)
    assert same
    assert "\n" not in told


@pytest.mark.parametrize(("line", "normal"), rows(__file__, "same"))
def test_one_meaning_has_one_form(line: str, normal: str) -> None:
    assert plan(read_plan(line)) == normal


@pytest.mark.parametrize(("line", "said"), rows(__file__, "refused"))
def test_what_contradicts_itself_is_refused_in_one_sentence(line: str, said: str) -> None:
    with pytest.raises(BriefError, match=said) as refusal:
        read(line, "plan")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(("source", "line"), rows(__file__, "needed"))
def test_what_catalogues_need_can_be_said(source: str, line: str) -> None:
    assert source
    brief = read(line, "plan", is_map_fixed=False)
    assert brief.scene.actors or brief.scene.flow
    assert read_plan(plan(brief)).scene == brief.scene


def test_the_example_is_read_into_its_fields() -> None:
    line = (
        "straight 200; turn left 90 && ego v=50; truck ahead gap=30 v=40..50: brake 6 to=20 ttc=..3, keep 2"
    )
    brief = read_plan(line)
    brake = Action(what="brake", decel=exactly(6), to=exactly(20), ttc=at_most(3))
    truck = Role(
        kind="truck", where="ahead", gap=exactly(30), speed=between(40, 50),
        actions=(brake, Action(what="keep", duration=exactly(2))),
    )  # fmt: skip
    assert brief.scene == Scene(speed=exactly(50), actors=(truck,))
    assert brief.clauses == read_plan("straight 200; turn left 90").clauses


def test_the_page_has_every_word_and_every_bound() -> None:
    section = PAGE.read_text(encoding="utf-8").split("## Scenes\n")[1].split("\n## ")[0]
    words = {*re.findall(r"[a-z_]+", section)}
    keys = {number.key for number in NUMBERS.values()}
    known = {
        *KINDS,
        *SPOTS,
        *DOINGS,
        *FLOWS,
        *LIGHTS,
        *get_args(Surface),
        *get_args(Landform),
        *get_args(Lie),
    }
    assert not {*known, *keys} - words
    table = [
        line.split("|")[1:4]
        for line in section.splitlines()
        if re.match(r"\| `\w+`(, `\w+`)? \| [-\d]", line)
    ]
    said = {
        key: tuple(float(ends.split(",")[n % (ends.count(",") + 1)]) for ends in (low, high))
        for names, low, high in table
        for n, key in enumerate(re.findall(r"\w+", names))
    }
    assert said == {each.key: each[1:3] for name, each in NUMBERS.items() if name not in WEATHER}
    starts = {
        what: number
        for names, number in re.findall(r"^\| (`\w+`(?:, `\w+`)*) \| *`?(\w*)`? *\| ", section, re.MULTILINE)
        for what in re.findall(r"\w+", names)
        if what in DOINGS
    }
    assert starts == {
        what: NUMBERS[each.numbers[0]].key if each.numbers else "" for what, each in DOINGS.items()
    }


def test_rain_wets_the_road_and_a_surface_goes_before_it() -> None:
    lines = {
        "&& rain": 0.6,
        "&& rain; snow": 0.35,
        "&& ice": 0.1,
        "&& night": None,
        "| beside(ice) && wet": 0.1,
    }
    for more, friction in lines.items():
        assert read_plan(f"turn {more}").friction == friction
