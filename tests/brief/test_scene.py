"""Scenes in plans: what is read, written, said and refused, and what the catalogues of others need."""

import re
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief import read
from roadgpt.brief.amount import at_most, between, exactly
from roadgpt.brief.beside import remarks
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import plan, read_plan, read_scene, scene_plan
from roadgpt.brief.readers.chat import RULES
from roadgpt.brief.scene import Action, Lie, Role, Scene, scene_text, with_named
from roadgpt.brief.scene_fit import fitted
from roadgpt.brief.sentence import sentence
from roadgpt.errors import BriefError
from roadgpt.language.names import ActorKind, Landform, Surface
from roadgpt.language.table import FLOWS, LIGHTS, MANEUVERS, NUMBERS, PLACES, WEATHER
from scenes_drawn import SCENES
from strategies import briefs
from tables import rows

KINDS = get_args(ActorKind)
PAGE = Path(__file__).parents[2] / "docs" / "reference" / "plans.md"


@given(briefs(), SCENES)
def test_a_scene_comes_back_from_its_plan_with_any_road(brief: Brief, scene: Scene) -> None:
    assert read_scene(scene_plan(scene)) == scene
    assert scene_plan(read_scene(scene_plan(scene))) == scene_plan(scene)
    whole = brief.model_copy(update={"scene": scene})
    assert read_plan(plan(whole)) == whole
    assert plan(whole).partition(" && ")[0].removesuffix("&&").strip() in (plan(brief), "", plan(whole))
    assert ("&&" in plan(whole)) == (scene != Scene())
    assert Brief.model_validate_json(whole.model_dump_json()) == whole


@pytest.mark.parametrize(
    ("scene", "last"),
    [
        ("ego v=30: stop s=350", 350.0),
        ("ego v=50; slippery s=340", 340.0),
        ("ego v=30; car ahead s=350", 350.0),
    ],
)
def test_a_road_whose_length_is_told_reaches_the_places_that_are_told(scene: str, last: float) -> None:
    """A length that is told may be 15 % shorter."""
    brief = read_plan(f"straight 400 && {scene}")
    length = fitted(brief, brief.scene, 50 / 3.6).length
    assert length is not None
    assert last < (length.lo or 0.0) <= 400.0
    free = read_plan("straight 400 && ego v=30: stop s=200")
    assert fitted(free, free.scene, 50 / 3.6).length is None


@given(SCENES)
def test_a_scene_is_said_in_plain_words(scene: Scene) -> None:
    said = scene_text(scene)
    assert not [part for part in ("None", "  ", "_", "..", "=", "{") if part in said]
    told = sentence(Brief(scene=scene))
    assert told == (f"A road; {said}." if said else "A road.")
    for number in {end for role in scene.actors if (gap := role.gap) for end in (gap.lo, gap.hi) if end}:
        assert f"{number:.4f}".rstrip("0").rstrip(".") in said


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("ego lane=1 v=50", "the tested car starts at 50 km/h in lane 1 from the kerb"),
        ("ego lane=2 left", "the tested car starts in lane 2 from the kerb; it goes left at the junction"),
        ("ego lane=-1", "the tested car starts in the innermost lane"),
        ("ego lane=-2", "the tested car starts in lane 2 from the inside"),
        ("parked left; parked right", "cars parked on both sides"),
        ("parked right; wet", "cars parked on the right; on a wet road"),
        ("roadworks len=80", "roadworks that narrow a lane on 80 metres"),
        (
            "roadworks closed left s=90..120 len=50",
            "roadworks that close a lane on the left at 90 to 120 metres from the start on 50 metres",
        ),
        ("low_sun; mountain", "a low sun ahead; mountain land"),
    ],
)
def test_the_parts_of_a_scene_are_said_by_name(line: str, said: str) -> None:
    assert scene_text(read_scene(line)) == said


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
    users = PAGE.with_name("road-users.md").read_text(encoding="utf-8")
    assert {*KINDS, *WEATHER} <= {*re.findall(r"`(\w+)`", users)}
    known = {
        *PLACES,
        *MANEUVERS,
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
        if what in MANEUVERS
    }
    assert starts == {
        what: NUMBERS[each.numbers[0]].key if each.numbers else "" for what, each in MANEUVERS.items()
    }


def test_the_grammar_and_the_prompt_give_a_side_to_whom_the_language_gives_one() -> None:
    def takes(part: str) -> bool:
        try:
            scene = read_scene(part)
            return bool(scene.actors or scene.actions)
        except BriefError:
            return False

    starts = {what: doing.starts[0] for what, doing in MANEUVERS.items()}
    sided = {what for what in MANEUVERS if takes(f"car {starts[what]}: {what} left")}
    beside = {where for where in PLACES if takes(f"car {where} left")}
    page = PAGE.read_text(encoding="utf-8")
    line = re.search(r"^ +WHAT +=(.*)\|", page, re.MULTILINE)
    assert line is not None
    assert {*re.findall(r"\w+_?\w+", line[1])} == {*sided, "left", "right"}
    wheres = re.search(r"^ +WHERE +=(.*\n.*)\n", page, re.MULTILINE)
    assert wheres is not None
    (lone, opposite), more = re.findall(r"(.*)\| (\w+) \[", wheres[1])[0], wheres[1].split("\n")[1]
    assert {opposite, *re.findall(r"[a-z]+", more)} - {"left", "right"} == beside
    assert {*re.findall(r"[a-z]+", lone)} == {*PLACES} - beside
    own = {what for what in MANEUVERS if takes(f"ego: {what} left")}
    assert {*re.findall(r"(\w+)(?: car 1)? left\|right", RULES)} == sided | own


def test_who_leaves_the_next_lane_away_from_the_tested_car_gets_a_lane_to_go_to() -> None:
    said = read_scene("car lane left: change_lane left")
    assert said.lanes_needed(left_hand=False) == 3
    assert read_scene("car lane left: change_lane right").lanes_needed(left_hand=False) == 2
    assert read_scene("car lane left: cut_in, change_lane left").lanes_needed(left_hand=False) == 2
    with pytest.raises(BriefError, match="needs 3 lanes"):
        read("| lanes=2 && car lane left: change_lane left", "plan", map_size=None)


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


def test_words_beside_the_road_ask_for_roadworks_unless_the_scene_has_some():
    named = with_named(read_scene("night"), ["roadworks", "bridge"])
    assert scene_plan(named) == "night; roadworks narrowed len=50; bridge"
    own = read_scene("roadworks closed s=90 len=50")
    assert with_named(own, ["roadworks"]) == own
    assert [*remarks(["roadworks"])] == [
        "a construction site: the road gets roadworks that narrow a lane on 50 metres"
    ]
