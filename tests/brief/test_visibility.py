"""How far one sees: laws, and figures from elsewhere."""

import math
from typing import get_args

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from roadgpt.brief.plan import read_scene
from roadgpt.brief.visibility import clear_range, visual_range, weather_drawn
from roadgpt.language.names import ActorKind
from roadgpt.language.table import VEHICLES

KINDS = get_args(ActorKind)


def test_nobody_is_hidden_by_day_in_dry_and_clear_air_and_by_no_other_part_of_a_scene() -> None:
    for text in ("", "medium; wet", "low_sun", "ice; ego v=50; car ahead gap=20"):
        assert {visual_range(read_scene(text), kind) for kind in (*KINDS, "lane", "lights")} == {math.inf}


@given(
    st.floats(5, 1000), st.floats(5, 1000), st.floats(0.1, 200), st.floats(0.1, 200), st.sampled_from(KINDS)
)
def test_thicker_fog_heavier_rain_and_night_never_show_more(
    fog: float, thinner: float, rain: float, lighter: float, kind: ActorKind
) -> None:
    assume(fog < thinner and rain > lighter)

    def seen(text: str) -> float:
        return visual_range(read_scene(text), kind)

    assert seen(f"fog {fog:f}") == pytest.approx(fog, abs=1e-5)  # it is the visual range
    assert seen(f"fog {fog:f}; rain {rain:f}") < min(seen(f"fog {fog:f}"), seen(f"rain {rain:f}"))
    assert seen(f"rain {rain:f}") <= seen(f"rain {lighter:f}")
    assert seen(f"night; fog {fog:f}") <= min(seen("night"), seen(f"fog {fog:f}"))
    assert seen(f"fog {fog:f}") <= seen(f"fog {thinner:f}")


@pytest.mark.parametrize(("rain", "metres"), [(2.5, 6570), (10, 2600), (50, 880), (150, 420)])
def test_rain_weakens_light_as_the_power_law_of_its_authors_says(rain: float, metres: float) -> None:
    """Atlas, Optical extinction by rainfall, 1953, has 11.6 R^-0.63 km for steady rain: another law."""
    assert clear_range(read_scene(f"rain {rain}")) == pytest.approx(metres, rel=0.02)
    assert clear_range(read_scene(f"rain {rain}")) == pytest.approx(11600 * rain**-0.63, rel=0.15)


def test_at_night_lamps_are_seen_from_farther_than_what_has_none() -> None:
    night = read_scene("night")
    assert {visual_range(night, kind) for kind in VEHICLES} == {300}
    assert {visual_range(night, kind) for kind in KINDS if kind not in VEHICLES} == {50}
    # two headlamps of 5,100 cd at the point that the regulations call 50V: as bright as a cinema's aisle
    assert 3 < 2 * 5100 / visual_range(night, "adult") ** 2 < 5


def test_each_drive_draws_its_weather_evenly_from_the_range_and_keeps_what_is_exact() -> None:
    scene = read_scene("fog 50..150; rain 2..; medium")
    drawn = [weather_drawn(scene, seed) for seed in range(300)]
    assert drawn[7] == weather_drawn(scene, 7)
    fogs, rains = ([each.amount_of(kind).lo for each in drawn] for kind in ("fog", "rain"))
    assert 50 <= min(fogs) < 55 < 145 < max(fogs) <= 150
    assert 2 <= min(rains) < 6 < 190 < max(rains) <= 200  # a bound goes to the end of what is possible
    assert sum(fogs) / 300 == pytest.approx(100, abs=6)
    assert all(each.weather[0].amount.exact and each.flow == "medium" for each in drawn)
    exact = read_scene("fog 60; rain 5")
    assert weather_drawn(exact, 1) is exact
