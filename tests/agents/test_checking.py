"""All objections to a plan come at once."""

import pytest

from roadgpt.brief import read
from roadgpt_mcp.checking import checked


def test_each_part_with_a_mistake_is_named_and_no_other() -> None:
    plan = (
        "curve left 20; turn rigt; straight 100 | len=300 bar && truck 30 ahead; car ahead gpa=30: brakes 6, "
        "cut_in foo, brake 3 to=2; foggy 20; wet"
    )
    told = checked(plan, "description")["objections"]
    about = ("'curve'", "'rigt'", "'bar'", "'30'", "'gpa=30'", "'brakes'", "'foo'", "'foggy 20'")
    assert len(told) == len(about)
    assert all(word in said for word, said in zip(about, told, strict=True))


@pytest.mark.parametrize(
    ("plan", "said"),
    [
        ("turn left 400; straight 100", "cross itself"),
        ("turn left left 90", "side twice"),
        ("", "the plan is empty"),
        ("straight 100 && wet; snow", "surface twice"),
        ("straight 100 && car ahead gap=30: brake 6 after turn 4", "needs turn 4"),
        ("turn x9 r400 | map_size=100", "no room"),
        ("map columns=3 rows=2 foo && dense", "'foo' for a map"),
        ("crossroads foo // turn", "'foo' for a junction"),
        ("t_junction || turns=3", "after ||"),
        ("!unclear", "what is wanted is not said"),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(plan: str, said: str) -> None:
    (told,) = checked(plan, "description")["objections"]
    assert said in told


def test_a_scene_that_has_no_room_on_the_road_that_is_built_is_refused() -> None:
    plan = "straight 60 | len=60 && ego v=90; truck ahead gap=30 v=80: brake 6 s=900"
    assert checked(plan, "description")["objections"]


@pytest.mark.parametrize("plan", ["turn left 90 r30 || hard", "&& fog"])
def test_a_valid_plan_is_told_in_a_sentence(plan: str) -> None:
    told = checked(plan, "description")
    assert told["objections"] == []
    assert told["sentence"].endswith(".")
    assert read(told["plan"], "plan") == read(plan, "plan").model_copy(update={"words": told["plan"]})


def test_changes_are_checked_too() -> None:
    good = "turn 2: radius x0.75; end: slope down && truck: brake more"
    assert checked(good, "change") == {"objections": [], "plan": good}
    told = checked("turn foo: radius x2; end: slop down && trck: brake more; add nigt", "change")[
        "objections"
    ]
    assert len(told) == 4
