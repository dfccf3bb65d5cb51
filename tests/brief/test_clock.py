"""The time of day that descriptions tell."""

import pytest

from roadgpt.brief.plan import read_scene, scene_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.clock import told_time
from roadgpt.brief.scene import scene_text
from roadgpt.errors import BriefError

READER = ModelReader()


@pytest.mark.parametrize(
    ("words", "time"),
    [
        ("Dry pavement, 2:15 p.m., posted limit 45 mph.", "14:15"),
        ("disengaged at 10:40 a.m.: the vehicle", "10:40"),
        ("at 0615 hrs in darkness", "06:15"),
        ("at around 7 pm in December", "19:00"),
        ("20 mph zone, 8:30 in the morning, four children", "08:30"),
        ("It was about four in the afternoon and dry.", "16:00"),
        ("17:20, heavy traffic", "17:20"),
        ("22:40 Uhr, Dunkelheit", "22:40"),
        ("um 7.45 Uhr", "07:45"),
        ("vers 17h20 sur la route", "17:20"),
        ("Ore 18:10, pioggia", "18:10"),
        ("at 12 am", "00:00"),
        ("at 12:30 pm", "12:30"),
        ("midday in February", "12:00"),
        # no times
        ("a slope of 1:20 and 3.5 m", None),
        ("curvature 1:50", None),
        ("10:05:33 start of log", None),
        ("from 8:00 to 9:30", None),
        ("two sharp turns, 40 m apart", None),
    ],
)
def test_a_time_is_told_once_and_as_a_time(words: str, time: str | None) -> None:
    assert told_time(words) == time


def test_the_time_stands_in_the_scene_and_small_hours_are_night() -> None:
    crash = "V1 was eastbound on a two-lane road at 45 mph when a deer ran out from the right. {} Dry."
    assert READER.read(crash.format("2:15 p.m.")).scene.clock == "14:15"
    assert READER.read(crash.format("2:15 p.m.")).scene.light is None
    assert READER.read(crash.format("1:50 a.m.")).scene.light == "night"
    assert READER.read(crash.format("")).scene.clock is None


def test_night_and_both_sides_are_read_by_their_words() -> None:
    read = READER.read("Di notte su strada ghiacciata in discesa, un'auto ferma dopo la curva a destra.")
    assert read.scene.light == "night"
    assert not {"notte", "Notte"} & {*read.unused}
    denied = "a car ahead brakes on a straight country road in good daylight, no night, 40 km/h"
    assert READER.read(denied).scene.light is None
    street = READER.read("a street with cars parked on both sides, a child runs out from the left")
    assert street.scene.parked == ("left", "right")


@pytest.mark.parametrize("text", ["clock 14:15", "truck ahead; clock 00:05; night"])
def test_a_clock_is_part_of_plans(text: str) -> None:
    assert scene_plan(read_scene(text)) == text
    assert f"at {text.split('clock ')[1][:5]}" in scene_text(read_scene(text))


@pytest.mark.parametrize("text", ["clock", "clock 25:00", "clock 7", "clock 07:00; clock 08:00"])
def test_a_clock_without_a_time_is_refused(text: str) -> None:
    with pytest.raises(BriefError):
        read_scene(text)
