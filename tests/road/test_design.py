"""RoadGPT's format, read and written exactly."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.errors import UsageError
from roadgpt.road import Design, read_design
from tables import rows

THESIS = """{"starting_point": [50, 30, 0], "theta": 90,
 "road_segment1": {"distance": 50, "direction": "right", "incline": 5, "turn_degrees": 40},
 "road_segment2": {"distance": 40, "direction": "left", "incline": 3, "turn_degrees": -20},
 "road_segment3": {"distance": 30, "direction": "straight", "incline": 0, "turn_degrees": 0}}"""


def good() -> dict[str, object]:
    return json.loads(THESIS)


def test_the_direction_wins_and_the_conflict_is_reported() -> None:
    design, remarks = read_design(good())
    assert [s.turn_degrees for s in design.segments] == [-40, 20, 0]
    assert len(remarks) == 2
    assert "segment 1" in remarks[0]
    assert "direction wins" in remarks[0]


def test_what_was_read_is_written_alike() -> None:
    data = good()
    data["road_segment1"]["turn_degrees"] = -40  # type: ignore[index]
    data["road_segment2"]["turn_degrees"] = 20  # type: ignore[index]
    assert json.dumps(read_design(data)[0].to_json()) == json.dumps(data)


def test_steep_inclines_and_wide_turns_are_kept_and_remarked_on() -> None:
    data = good()
    data["road_segment3"] = {"distance": 30, "direction": "left", "incline": -17, "turn_degrees": 95}
    design, remarks = read_design(data)
    assert design.segments[2].turn_degrees == 95
    assert any("95 degrees" in r for r in remarks)
    assert any("-17 %" in r for r in remarks)


def test_a_gap_in_the_numbers_is_remarked_on() -> None:
    data = good()
    data["road_segment7"] = data.pop("road_segment3")
    design, remarks = read_design(data)
    assert [s.distance for s in design.segments] == [50, 40, 30]
    assert remarks[0].startswith("segments are numbered 1, 2, 7 instead of 1, 2, 3")


SEGMENT = {"distance": 50, "direction": "left", "incline": 5, "turn_degrees": 40}


@pytest.mark.parametrize(
    ("change", "hint"),
    rows(__file__, "bad_fields_get_one_sentence_that_names_them"),
)
def test_bad_fields_get_one_sentence_that_names_them(change: dict[str, object], hint: str) -> None:
    with pytest.raises(UsageError, match=hint) as caught:
        read_design({**good(), **change})
    assert "\n" not in str(caught.value)


junk = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from([*SEGMENT, "starting_point", "theta", "road_segment1"]), inner, max_size=5
        )
    ),
    max_leaves=12,
)


@given(junk)
def test_anything_else_is_a_design_or_a_sentence(data: object) -> None:
    try:
        design, _ = read_design(data)  # type: ignore[arg-type]
    except UsageError:
        return
    assert isinstance(design, Design)


def test_a_vertical_radius_that_does_not_fit_is_remarked_on() -> None:
    def written(radius: float) -> tuple[str, ...]:
        level = {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0}
        steep = {**level, "incline": 10, "vertical_radius": radius}
        data = {"starting_point": [10, 10, 0], "theta": 0, "road_segment1": level, "road_segment2": steep}
        return read_design(data)[1]

    assert written(300) == ()  # 15 m to either side
    (remark,) = written(2000)
    assert remark == (
        "segment 2: a vertical radius of 2000 m does not fit between the neighbouring changes of grade; "
        "it becomes 784 m"
    )
