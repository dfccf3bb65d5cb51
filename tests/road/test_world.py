"""A World has three parts, and files keep the flat table that earlier versions wrote."""

import json
import pickle
import warnings
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

import roadgpt
from roadgpt.road import CrossSection, Limits, Site, World

EARLIER = (
    '{"map_size":400.0,"lanes":"2+1","lane_width":3.5,"lane_width_end":3.0,"bank":0.05,"verge":1.5,'
    '"friction":0.6,"speed_limit":25.0,"oob_tolerance":0.5,"lane_departure":true,"min_radius":20.0,'
    '"max_grade":0.1,"z_floor":-30.0,"min_length":40.0}'
)
"""What version 0.1.0 wrote before a World had parts."""
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


def test_a_file_of_an_earlier_version_is_read_and_written_byte_for_byte() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert World.model_validate_json(EARLIER) == PARTS
        assert Holder.model_validate_json(f'{{"world":{EARLIER}}}').world == PARTS
    assert PARTS.model_dump_json() == EARLIER
    assert Holder(world=PARTS).model_dump_json() == f'{{"world":{EARLIER}}}'


def test_the_earlier_form_works_and_says_what_to_write() -> None:
    with pytest.warns(DeprecationWarning, match="is deprecated; write World") as told:
        world = roadgpt.World(friction=0.6, verge=1.0)
    assert world == World(site=Site(friction=0.6), section=CrossSection(shoulder=1.0))
    assert [str(each.message) for each in told] == [
        "World(friction=...) is deprecated; write World(site=Site(friction=...))",
        "World(verge=...) is deprecated; write World(section=CrossSection(shoulder=...))",
    ]
    assert all(each.filename == __file__ for each in told)
    with pytest.warns(DeprecationWarning, match=r"world\.verge is .* write world\.section\.shoulder"):
        assert world.verge == 1.0  # type: ignore[attr-defined]
    with pytest.warns(DeprecationWarning, match=r"world\.speed_limit is .* write world\.limits\.speed_limit"):
        assert world.speed_limit == pytest.approx(70 / 3.6)  # type: ignore[attr-defined]


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


def test_a_change_leaves_everything_else() -> None:
    icy = PARTS.changed(friction=0.1, shoulder=0.5)
    want = json.loads(EARLIER) | {"friction": 0.1, "verge": 0.5}
    assert json.loads(icy.model_dump_json()) == want
    assert PARTS.changed() == PARTS
    earlier = [name for name in PARTS.values() if name != "centre_line"]  # which is newer
    assert earlier == [name.replace("verge", "shoulder") for name in json.loads(EARLIER)]


def test_a_copy_in_the_earlier_form_changes_the_parts() -> None:
    with pytest.warns(DeprecationWarning, match=r"'verge'.* write world\.changed\(shoulder=\.\.\.\)"):
        copied = PARTS.model_copy(update={"verge": 0.5, "friction": 0.1})
    assert copied == PARTS.changed(shoulder=0.5, friction=0.1)
    assert PARTS.model_copy(update={"site": Site()}).site == Site()


def test_a_world_can_be_sent_to_a_worker_and_be_a_key() -> None:
    assert pickle.loads(pickle.dumps(PARTS)) == PARTS
    assert len({PARTS, PARTS.model_copy(), World()}) == 2
    with pytest.raises(ValidationError, match="frozen"):
        PARTS.site = Site()  # type: ignore[misc]
    with pytest.raises(AttributeError, match="has no attribute 'grip'"):
        PARTS.grip  # type: ignore[attr-defined]  # noqa: B018
