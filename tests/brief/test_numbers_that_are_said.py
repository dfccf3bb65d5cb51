"""Numbers with a tolerance, slopes in degrees, and numbers below nothing."""

from math import degrees

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief import reader_of
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError
from tables import rows


@given(st.integers(2, 9), st.integers(1, 8), st.sampled_from(["± {}", "plus or minus {}", "give or take {}"]))
def test_any_tolerance_below_the_count(count: int, off: int, sign: str) -> None:
    if off < count:
        text = slotted(f"{count} turns {sign.format(off)}").text
        assert text == f"{count - off} to {count + off} turns"


@pytest.mark.parametrize("text", rows(__file__, "slope_degrees_tangent"))
@pytest.mark.parametrize("angle", [3, 5, 8])
def test_a_slope_in_degrees_is_the_tangent_in_percent(text: str, angle: int) -> None:
    from scipy.special import tandg

    (slot,) = slotted(text.format(angle)).slots
    assert slot.unit == "percent"
    assert slot.value == pytest.approx(100 * float(tandg(angle)), abs=0.051)
    assert degrees(slot.value / 100) == pytest.approx(angle, abs=0.1)  # for small angles both are alike


def test_a_negative_number_of_turns_is_refused_with_its_words() -> None:
    with pytest.raises(BriefError, match="'minus four bends'"):
        reader_of("model").read("I need a road with minus four bends, please.")


@pytest.mark.parametrize(
    "text", ["two million bends", "Bend left by a million degrees", "ochocientas horquillas"]
)
def test_absurd_numbers_in_words_are_refused(text: str) -> None:
    with pytest.raises(BriefError):
        reader_of("model").read(text)
