"""A World has four parts, and files have one flat table."""

import json
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from roadgpt.brief.plan import read_plan, read_scene
from roadgpt.road import CrossSection, Limits, Site, World

FILE = (
    '{"map_size":400.0,"lanes":"2+1","lane_width":3.5,"lane_width_end":3.0,"bank":0.05,"verge":1.5,'
    '"friction":0.6,"speed_limit":25.0,"oob_tolerance":0.5,"lane_departure":true,"min_radius":20.0,'
    '"max_grade":0.1,"z_floor":-30.0,"min_length":40.0}'
)
PARTS = World(
    site=Site(map_size=400, friction=0.6, z_floor=-30),
    section=CrossSection(lanes="2+1", lane_width=3.5, lane_width_end=3, bank=0.05, shoulder=1.5),
    limits=Limits(
        speed_limit=25, oob_tolerance=0.5, lane_departure=True, min_radius=20, max_grade=0.1, min_length=40
    ),
)


class Holder(BaseModel):
    """Holds a World, as a Request does."""

    world: World = World()


def test_a_file_is_read_and_written_byte_for_byte() -> None:
    assert World.model_validate_json(FILE) == PARTS
    assert Holder.model_validate_json(f'{{"world":{FILE}}}').world == PARTS
    assert PARTS.model_dump_json() == FILE
    assert Holder(world=PARTS).model_dump_json() == f'{{"world":{FILE}}}'


@pytest.mark.parametrize(
    "values",
    [
        {"friction": 9},
        {"lanes": "0+1"},
        {"grip": 0.5},
        {"site": {"map_size": 300}, "friction": 0.5},
        {"verge": 1.0, "shoulder": 1.0},
        {"site": {"speed_limit": 20}},
    ],
)
def test_a_wrong_value_is_refused_in_a_file_and_in_a_change(values: dict[str, Any]) -> None:
    name = [*values][-1]
    with pytest.raises(ValidationError, match=name):
        World.model_validate(values)
    with pytest.raises(ValidationError):
        World().changed(**values)


def test_a_scene_is_one_text_of_a_file_and_absent_without_one() -> None:
    text = "truck ahead gap=30: brake decel=6; medium; wet"
    busy = PARTS.changed(scene="medium;wet", friction=0.6).changed(scene=text.replace("decel=6", "6"))
    assert busy.model_dump_json() == f'{FILE[:-1]},"scene":"{text}"}}'
    assert World.model_validate_json(busy.model_dump_json()) == busy
    assert busy.changed(scene="").model_dump_json() == FILE
    assert busy.changed(friction=0.3).scene == read_scene(text)
    with pytest.raises(ValidationError, match="no manoeuvre 'jump'"):
        World.model_validate({"scene": "truck ahead: jump"})


@pytest.mark.parametrize(
    ("given", "stands", "friction"),
    [
        ("", "", 1.0),  # an empty scene takes all that the words say away
        ("light", "light; night; ice", 0.1),
        ("snow", "medium; night; snow", 0.35),
        ("rain 5", "medium; rain 5; night; ice", 0.1),
        ("car ahead; low_sun", "car ahead; medium; low_sun; ice", 0.1),
    ],
)
def test_what_a_scene_of_words_says_stands_unless_that_of_the_world_says_it(
    given: str, stands: str, friction: float
) -> None:
    brief = read_plan("turn | beside(wet) && medium; night; ice")
    assert World().in_scene_of(brief).scene == brief.scene
    assert World().in_scene_of(brief).on_surface_of(brief).site.friction == 0.1
    kept = World().changed(scene=given).in_scene_of(brief)
    assert kept.scene == read_scene(stands)
    assert kept.on_surface_of(brief).site.friction == friction
    assert kept.in_scene_of(brief) == kept


def test_a_scene_without_words_sets_the_friction() -> None:
    assert World().changed(scene="rain").on_surface_of(None).site.friction == 0.6
    assert World().changed(scene="rain", friction=1.0).on_surface_of(None).site.friction == 1.0


def test_a_change_leaves_everything_else() -> None:
    icy = PARTS.changed(friction=0.1, shoulder=0.5)
    want = json.loads(FILE) | {"friction": 0.1, "verge": 0.5}
    assert json.loads(icy.model_dump_json()) == want
    assert PARTS.changed() == PARTS
    newer = ("centre_line", "scene", "ground", "avoidable", "limit_stated")
    earlier = [name for name in PARTS.values() if name not in newer]
    assert earlier == [name.replace("verge", "shoulder") for name in json.loads(FILE)]
