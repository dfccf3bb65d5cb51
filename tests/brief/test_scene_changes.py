"""Changes of scenes: their plans come back, do what they say, and are refused in one sentence."""

import re
from typing import Any, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edit_truth import roads
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.change.request import EditRequest, SceneChange, Things
from roadgpt.brief.change.staging import changed_scene
from roadgpt.brief.plan import read_scene, scene_plan
from roadgpt.brief.scene import Role, Scene, SlipperyPlace
from roadgpt.errors import EditError, IdleEditError
from roadgpt.language.names import ActorKind, Landform, What, Where
from roadgpt.language.table import MANEUVERS, NUMBERS
from roadgpt.road import World
from roadgpt_edit.editing import edit
from scenes_drawn import LANDS, actions, roles

FIGURES = st.integers(1, 4000).map(lambda n: n / 20)
WAYS = st.sampled_from([-1, 1])
VALUES: st.SearchStrategy[dict[str, Any]] = (
    st.fixed_dictionaries({"to": FIGURES | FIGURES.map(lambda n: -n), "bound": st.sampled_from([-1, 0, 1])})
    | st.fixed_dictionaries({"by": FIGURES, "more": WAYS})
    | st.fixed_dictionaries({"times": FIGURES})
    | st.fixed_dictionaries({"more": WAYS, "dose": st.sampled_from([0.5, 1.0, 1.8])})
)
COUNTS = st.fixed_dictionaries({"to": st.integers(1, 50), "bound": st.sampled_from([-1, 0, 1])})
MAYBE_SIDE = st.none() | st.sampled_from(["left", "right"])
WHERES = st.none() | st.sampled_from(get_args(Where))
NUMBERED = {
    "numbers": st.lists(st.sampled_from([1, 2, 7, -1]), max_size=2).map(tuple),
    "every": st.booleans(),
}
ACTORS = st.builds(
    Things, st.sampled_from([*get_args(ActorKind), "actor"]), **NUMBERED, where=WHERES, side=MAYBE_SIDE
)
LANDSCAPE = st.builds(
    Things, st.sampled_from([*get_args(Landform), "landscape"]), **NUMBERED, side=MAYBE_SIDE
)
PLACES = st.builds(Things, st.just("slippery"), **NUMBERED)
FORMS = st.builds(Things, st.sampled_from(["", *get_args(ActorKind)]), where=WHERES, side=MAYBE_SIDE)
PARTS = (
    st.builds(lambda role: {"actors": (role,)}, roles())
    | st.builds(lambda land: {"landscape": (land,)}, LANDS)
    | st.sampled_from([{"light": "night"}, {"flow": "dense"}, {"oncoming": "none"}, {"surface": "ice"}])
    | st.sampled_from([{"parked": ("left",)}, {"lane": 2}, {"turn": "left"}, {"person": "robot"}])
    | st.sampled_from([{"land": "hilly"}, {"land": "flat"}])
).map(lambda fields: Scene().model_copy(update=fields))


def numbers_of(things: st.SearchStrategy[Things], *keys: str) -> st.SearchStrategy[SceneChange]:
    return st.builds(
        lambda target, key, value: SceneChange("number", target, key=key, **value),
        things,
        st.sampled_from(keys),
        VALUES,
    )


def single(*names: str) -> st.SearchStrategy[Things]:
    return st.sampled_from(names).map(Things)


OF_ACTORS = [name for name in NUMBERS if name in Role.model_fields]
DEEDS = st.sampled_from(get_args(What)).flatmap(
    lambda what: st.builds(
        lambda target, key, value: SceneChange("number", target, doing=what, key=key, **value),
        ACTORS,
        st.sampled_from([*MANEUVERS[what].numbers, "time", "gap", "ttc"]),
        VALUES,
    )
)
CHANGES = (
    st.builds(SceneChange, st.just("add"), new=PARTS)
    | st.builds(SceneChange, st.just("add"), ACTORS, new=actions([*get_args(What)]))
    | st.builds(SceneChange, st.just("as"), ACTORS, form=FORMS.filter(lambda form: form != Things("")))
    | st.builds(
        SceneChange,
        st.just("remove"),
        ACTORS
        | LANDSCAPE
        | PLACES
        | single("ego", "fog", "traffic", "oncoming", "parked", "night", "land", "hilly", "scene"),
    )
    | st.builds(SceneChange, st.just("remove"), ACTORS, doing=st.sampled_from(get_args(What)))
    | st.builds(lambda target, n: SceneChange("count", target, **n), ACTORS | LANDSCAPE, COUNTS)
    | numbers_of(ACTORS, *OF_ACTORS)
    | numbers_of(LANDSCAPE, "length", "away")
    | numbers_of(PLACES, *(name for name in NUMBERS if name in SlipperyPlace.model_fields))
    | numbers_of(single("ego"), "speed")
    | numbers_of(single("fog"), "fog")
    | numbers_of(single("rain"), "rain")
    | st.builds(
        SceneChange, st.just("number"), single("traffic"), key=st.just("flow"), more=WAYS, dose=st.just(1.8)
    )
    | st.builds(SceneChange, st.just("number"), single("land"), key=st.just("land"), more=WAYS)
    | DEEDS
)


@given(st.lists(CHANGES, min_size=1, max_size=3), st.booleans())
def test_changes_of_a_scene_come_back_from_their_plan(changes: list[SceneChange], has_road: bool) -> None:
    road = read_change_plan("turn 2: radius x0.75").changes if has_road else ()
    line = change_plan(EditRequest("", road, scene=tuple(changes)))
    again = read_change_plan(line)
    assert (again.changes, again.scene) == (road, tuple(changes)), line
    assert change_plan(again) == line


@given(st.lists(CHANGES, min_size=1, max_size=2), st.lists(roles(), max_size=3))
def test_any_change_makes_a_scene_that_can_be_stored_or_is_refused(
    changes: list[SceneChange], cast: list[Role]
) -> None:
    try:
        after = changed_scene(Scene(actors=tuple(cast)), changes, 90.0)
    except EditError:
        return
    assert scene_plan(read_scene(scene_plan(after))) == scene_plan(after)


BEFORE = (
    "ego v=50; truck ahead gap=30 v=50: brake 6; adult crossing right; car ahead gap=20;"
    " car oncoming v=40..60; medium; fog 60; night; tunnel len=90; bridge"
)


@pytest.mark.parametrize(
    ("line", "old", "new"),
    [
        ("truck: brake more", "brake 6", "brake 9"),  # half as much again
        ("truck: brake less", "brake 6", "brake 4"),  # less undoes more
        ("truck: brake slightly more", "brake 6", "brake 7.5"),
        ("truck: brake ttc =2; truck: gap -5", "gap=30 v=50: brake 6", "gap=25 v=50: brake 6 ttc=2"),
        ("truck: thw =1.5", "gap=30", "thw=1.5"),
        ("truck: as bus lane left", "truck ahead", "bus lane left"),
        ("truck: add cut_out right; truck: brake remove", "brake 6", "cut_out right"),
        ("truck: x2..", "truck ahead", "truck x2 ahead"),
        ("car oncoming: v x0.5", "v=40..60", "v=20..30"),
        ("car 2: v ..50; car -1: gap =80", "oncoming v=40..60", "oncoming gap=80 v=40..50"),
        ("car 1: remove; adult: remove", " adult crossing right; car ahead gap=20;", ""),
        ("adult: v more", "crossing right", "crossing right v=7.5"),  # 5 km/h is a person's usual speed
        ("add bicycle crossing right v=15: cross", "medium", "bicycle crossing right v=15: cross; medium"),
        ("traffic: more", "medium", "dense"),
        ("oncoming: less", "medium", "medium; oncoming light"),
        ("traffic: none; add parked right", "medium", "parked right"),
        ("fog: more", "fog 60", "fog 40"),  # one sees less far
        ("low_sun; night: remove; fog: remove; rain 5", "fog 60; night", "rain 5; low_sun"),
        ("tunnel: len less; bridge: x3", "len=90; bridge", "len=60; bridge x3"),
        ("landscape all: remove; add bridge len=60", "tunnel len=90; bridge", "bridge len=60"),
        ("ego: v +30; add ego lane=1", "ego v=50", "ego v=80 lane=1"),
        ("bridge: len more", "bridge", "bridge len=75"),  # 50 m is a usual bridge
        ("land: more", "night; tunnel", "night; hilly; tunnel"),  # rolling where nothing is said
        ("land: much less", "night; tunnel", "night; flat; tunnel"),
        ("add mountain", "night; tunnel", "night; mountain; tunnel"),
        ("scene: remove; add light", BEFORE, "light"),
    ],
)
def test_a_change_makes_the_scene_that_it_says(line: str, old: str, new: str) -> None:
    after = changed_scene(read_scene(BEFORE), read_change_plan(f"&& {line}").scene, 90.0)
    assert old in BEFORE
    assert after == read_scene(BEFORE.replace(old, new, 1))


WAITING = "car ahead gap=20; car behind gap=9: brake 3; truck lane left: cut_in with car 2 brake"


def test_who_waits_for_somebody_waits_for_the_same_one_afterwards() -> None:
    def after(line: str) -> Scene:
        return changed_scene(read_scene(WAITING), read_change_plan(f"&& {line}").scene, 90.0)

    behind = "behind gap=9: brake 3; truck lane left: cut_in with"
    assert after("car 1: remove") == read_scene(f"car {behind} car 1 brake")
    assert after("car 2: as bus") == read_scene(f"car ahead gap=20; bus {behind} bus 1 brake")
    for line in ("car 2: remove", "car 2: brake remove"):
        with pytest.raises(EditError, match="car"):
            after(line)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("bus: remove", "the scene has no bus; there is: a truck ahead"),
        ("car: remove", "which car is meant: a car ahead, .*; a car oncoming"),
        ("car 3: remove", "the scene has 2"),
        ("car 1: v less", "does not say v of 'a car ahead"),
        ("truck: cut_in more", "nobody does 'cut_in'"),
        ("truck: brake =20", "decel of brake is from 0.1 to 12, not 20"),
        ("truck: as parked right", "truck parked stands; leave its speed out"),
        ("truck: brake more; truck: brake less", "asked for twice"),
        ("truck: v =50; truck: dv =3", "asked for twice"),
        ("truck: gap less; truck: remove", "to be removed, and something else"),
        ("add night; add low_sun", "light of the scene is asked for twice"),
        ("fog: =40; fog: remove", "no fog in the scene"),
        ("rain: more", "no rain in the scene"),
        ("low_sun: remove", "no low sun"),
        ("parked: remove", "no row of parked cars"),
        ("traffic: much more; traffic: more", "asked for twice"),
        ("land: =3", "no level of land; write more or less, or add for example hilly"),
        ("bridge: away =30", "'bridge' has no away= here"),
        ("truck: colour blue", "'colour' is not expected"),
        ("lorry: remove", "'lorry' is not expected"),
        ("truck: gap =turn 1", "'turn' is not expected"),
        ("add dragon ahead", "a scene has no 'dragon ahead'"),
        ("", "the plan names no change"),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(line: str, told: str) -> None:
    with pytest.raises(EditError, match=told) as refusal:
        changed_scene(read_scene(BEFORE), read_change_plan(f"&& {line}").scene, 90.0)
    assert not re.search(r"\n|Value error", str(refusal.value))


def test_a_change_of_the_scene_alone_keeps_the_road_and_is_said() -> None:
    road, world = (
        roads()["r01"],
        World.model_validate({"scene": "truck ahead: brake 4; rain 5", "friction": 0.6}),
    )
    made = edit(road, read_change_plan("&& truck: brake more; rain: remove; add lake along left"), world)
    assert made.design is road
    assert scene_plan(made.world.scene) == "truck ahead: brake decel=6; lake along left"
    assert made.world == world.changed(scene=made.world.scene, friction=1.0)  # dry again
    assert any(
        "that brakes with 4 m/s2" in said and "that brakes with 6 m/s2" in said for said in made.changes
    )
    assert any("a lake along the road on the left" in said for said in made.changes)
    both = edit(road, read_change_plan("turn 2: radius x0.9 && rain: remove"), world)
    assert both.design == edit(road, read_change_plan("turn 2: radius x0.9"), world).design != road
    with pytest.raises(IdleEditError, match="so already"):
        edit(road, read_change_plan("&& truck: brake =4"), world)


@pytest.mark.parametrize(
    ("scene", "line", "after"),
    [
        ("hilly; lake left", "land: more", "mountain; lake left"),
        ("valley along", "land: more", "mountain; valley along"),  # hilly where there are valleys
        ("lake left", "lake: away more", "lake left away=45"),  # 30 m is usual
        ("lake left away=60", "lake: away less", "lake left away=40"),
        ("river along right; ridge left", "ridge: away +15", "river along right; ridge left away=100"),
        ("mountain", "hilly: remove", ""),
        ("mountain", "land: remove", ""),
        ("mountain", "land: more", ""),
    ],
)
def test_land_changes_by_levels_and_metres(scene: str, line: str, after: str) -> None:
    def changed() -> str:
        return scene_plan(changed_scene(read_scene(scene), read_change_plan(f"&& {line}").scene, 90.0))

    if after or line == "land: remove":
        assert changed() == after
    else:  # there is no hilly land, and nothing higher than mountains
        with pytest.raises(EditError, match=r"no hilly|mountain land already"):
            changed()


def test_the_land_of_an_option_changes_and_keeps_its_seed() -> None:
    road, world = roads()["r01"], World().changed(ground="hilly:7", scene="lake left")
    made = edit(road, read_change_plan("&& land: less"), world)
    assert made.world == World().changed(ground="rolling:7", scene="lake left")
    assert any("hilly land" in said and "rolling land" in said for said in made.changes)
    assert edit(road, read_change_plan("&& lake: remove"), world).world.site.ground == "hilly:7"
