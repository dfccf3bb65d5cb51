"""When a simulator is given up: three losses in a row, and none that healed."""

import pickle

from hypothesis import given
from hypothesis import strategies as st

from roadgpt.errors import GivenUpError
from roadgpt.run.model import LostDrives


@given(st.lists(st.booleans(), max_size=30))
def test_it_is_given_up_at_the_third_in_a_row_and_never_before(lost: list[bool]) -> None:
    losses: LostDrives[int] = LostDrives()
    told = [losses.count(number, is_lost) for number, is_lost in enumerate(lost)]
    for number, given_up in enumerate(told):
        assert given_up == (number >= 2 and all(lost[number - 2 : number + 1]))
    if lost[-3:] == [True] * 3:
        assert losses.lost[-3:] == [len(lost) - 3, len(lost) - 2, len(lost) - 1]


def test_its_sentence_travels_between_processes() -> None:
    error = pickle.loads(pickle.dumps(LostDrives.given_up("it is gone", "say it again")))
    assert isinstance(error, GivenUpError)
    assert str(error) == "the simulator failed 3 times in a row and is given up (it is gone); say it again"
