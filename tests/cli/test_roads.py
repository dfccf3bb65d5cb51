"""check, drive, plot and show on roads that exist, good ones and those that strangers bring."""

import json
import math
from collections.abc import Sequence
from pathlib import Path

import pytest
from click.testing import Result

from command_line import invoke
from rows import rows as table

FIELDS = [
    "file", "is_valid", "validation_message", "findings", "test_outcome", "description", "max_oob",
    "beyond_m", "margin_m", "length_m", "own_share", "handed_to", "seconds",
]  # fmt: skip

STRAIGHT = [[60, 100], [100, 100], [140, 100]]
ARC = [math.pi / 2 * i / 8 for i in range(9)]
CORNER = [
    [60, 60],
    [75, 60],
    *([90 + 10 * math.sin(a), 70 - 10 * math.cos(a)] for a in ARC),
    [100, 85],
    [100, 110],
]
DESIGN = {
    "starting_point": [60, 100, 0],
    "theta": 0,
    "road_segment1": {"distance": 30, "direction": "straight", "incline": 0, "turn_degrees": 0},
    "road_segment2": {"distance": 40, "direction": "left", "incline": 4, "turn_degrees": -50},
    "road_segment3": {"distance": 20, "direction": "straight", "incline": 4, "turn_degrees": 0},
}
UNREADABLE = {
    "broken.json": '{"road_points": [[1, 2],',
    "empty.json": "",
    "number.json": "7",
    "words.json": '{"road_points": [["a", "b"], ["c", "d"]]}',
    "ragged.json": "[[1, 2], [3]]",
    "nan.json": "[[60, 60], [NaN, 80], [90, 90]]",
    "infinite.json": "[[60, 60], [Infinity, 80], [90, 90]]",
    "nothing.json": "[]",
    "other.json": '{"answer": 42}',
    "deep.json": "[" * 5000 + "]" * 5000,
    "image.json": "\x89PNG\r\n\x1a\n\x00\x00",
}


@pytest.fixture(autouse=True)
def in_a_folder_with_roads() -> None:
    roads = {"straight.json": STRAIGHT, "corner.json": CORNER, "design.json": DESIGN}
    roads["test.json"] = {"road_points": STRAIGHT, "interpolated_points": STRAIGHT, "is_valid": True}
    for name, data in roads.items():
        Path(name).write_text(json.dumps(data))
    for name, text in UNREADABLE.items():
        Path(name).write_text(text, encoding="latin-1")
    Path("folder").mkdir()


def rows(result: Result) -> list[dict[str, object]]:
    found = [json.loads(line) for line in result.stdout.splitlines()]
    assert all([*row] == FIELDS for row in found)
    return found


@pytest.mark.parametrize("rules", ["strict", "sbft"])
def test_check_tells_valid_from_invalid_and_ends_with_1(rules: str) -> None:
    good = invoke("check", "straight.json", "test.json", "design.json", "--json", "--rules", rules)
    assert good.exit_code == 0
    assert [row["test_outcome"] for row in rows(good)] == ["VALID"] * 3
    assert rows(good)[0]["length_m"] == pytest.approx(80, abs=1e-3)
    bad = invoke("check", "straight.json", "corner.json", "--json", "--rules", rules)
    assert bad.exit_code == 1
    assert [row["is_valid"] for row in rows(bad)] == [True, False]
    assert rows(bad)[1]["validation_message"]


@pytest.mark.parametrize("command", ["check", "drive", "view"])
@pytest.mark.parametrize("name", [*UNREADABLE, "folder", "there is none.json"])
def test_a_file_that_holds_no_road_gets_one_sentence_and_status_2(command: str, name: str) -> None:
    result = invoke(command, name)
    assert result.exit_code == 2
    assert result.stderr.startswith("roadgpt: ")
    assert name.removesuffix(".json") in result.stderr
    assert result.stdout == ""


@pytest.mark.parametrize("command", ["check", "drive"])
def test_a_file_that_holds_no_road_does_not_stop_the_others(command: str) -> None:
    result = invoke(command, "broken.json", "straight.json", "--json")
    assert [row["test_outcome"] == "ERROR" for row in rows(result)] == [True, False]
    assert result.exit_code == 2


def test_drive_drives_a_road_despite_what_the_rules_say_and_tells_it_beside_the_verdict() -> None:
    result = invoke("drive", "corner.json", "--json")
    assert result.exit_code == 0
    (row,) = rows(result)
    assert (row["test_outcome"], row["is_valid"]) == ("FAIL", False)
    said = str(row["validation_message"])
    assert said.endswith("is tighter than 14.33 m")
    assert row["findings"] == [said]
    assert said not in str(row["description"])
    told = invoke("drive", "corner.json", "straight.json").stdout
    assert f"finding: {said}" in told
    assert "driven despite findings of the rules: 1 (-v tells all of them)" in told
    assert "despite" not in invoke("drive", "straight.json").stdout


def test_the_competition_s_rules_still_stop_a_drive() -> None:
    (row,) = rows(invoke("drive", "corner.json", "--json", "--rules", "sbft"))
    assert (row["test_outcome"], row["is_valid"], row["max_oob"]) == ("INVALID", False, None)
    assert row["validation_message"] == row["description"]


@pytest.mark.parametrize(
    ("length", "outcome"), [(0.5, "INVALID"), (10.4, "INVALID"), (10.6, "PASS"), (19, "PASS")]
)
def test_a_road_without_room_for_a_car_says_so(length: float, outcome: str) -> None:
    Path("short.json").write_text(json.dumps([[60, 60], [60 + length, 60]]))
    (row,) = rows(invoke("drive", "short.json", "--json"))
    assert row["test_outcome"] == outcome
    said = (
        "too short to be driven: a car starts 2.5 m along a road"
        if outcome == "INVALID"
        else "longer than 20"
    )
    assert said in str(row["validation_message"])


@pytest.mark.parametrize("driver", ["nobody", "none.py:Driver", "empty.py:Driver", "empty.py"])
def test_a_driver_that_does_not_exist_is_a_usage_error(driver: str) -> None:
    Path("empty.py").write_text("")
    result = invoke("drive", "straight.json", "--driver", driver)
    assert result.exit_code == 2
    assert result.stderr.startswith("roadgpt: ")
    assert result.stdout == ""


def test_plot_draws_into_a_new_folder_each_time() -> None:
    for folder in ("straight", "straight-2"):
        result = invoke("view", "--format", "png", "straight.json", "--out", "here", "--axes", "thesis")
        pictures = [Path(line) for line in result.stdout.splitlines()]
        assert result.exit_code == 0
        assert len(pictures) >= 3
        assert all(picture.parent == Path("here", folder) for picture in pictures)
        assert all(picture.read_bytes()[:4] == b"\x89PNG" for picture in pictures)


@pytest.mark.parametrize(("given", "said"), table(__file__, "lane_options"))
def test_lane_options_that_a_road_overrules_are_told_even_as_defaults(
    given: Sequence[str], said: str
) -> None:
    made = invoke(
        "run", "--plan", "turn left 60", "--lanes", "2+1", "-n", "1", "--no-drive", "--no-plot", "--out", "r"
    )
    assert made.exit_code == 0
    checked = invoke("check", "r/runs/0001/road.json", *given)
    assert checked.exit_code == 0
    assert ("lanes of its own" in checked.output) == bool(said)
    assert said in checked.output
