"""Whatever a driver does wrong costs one DriverError, and never the run."""

import math
import time

import pytest

from roadgpt.drive import Command, View
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.errors import DriverError

VIEW = View(1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, None, None, 0.0, 0.02, 0.0, 0.0)  # type: ignore[arg-type]


class GivesAnswer:
    def __init__(self, answer):
        self.answer = answer

    def steer(self, view):
        return self.answer() if callable(self.answer) else self.answer


def ask(answer):
    return DriverGuard(GivesAnswer(answer)).ask(VIEW)


def fails(error):
    def answer():
        raise error

    return answer


@pytest.mark.parametrize(
    "answer",
    [None, 0.3, "left", (1, 2), (1, 2, 3, 4), ("a", 0, 0), (math.nan, 0, 0), (0, math.inf, 0), {}, object()],
)
def test_an_answer_that_is_no_command_is_told_so(answer):
    with pytest.raises(DriverError, match=r"driver 'GivesAnswer' answered .* at 1.50 s"):
        ask(answer)


@pytest.mark.parametrize(
    "error", [ValueError("oh no"), ZeroDivisionError(), SystemExit(3), GeneratorExit(), RecursionError()]
)
def test_whatever_is_raised_becomes_one_error(error):
    with pytest.raises(DriverError, match=type(error).__name__):
        ask(fails(error))


def test_ctrl_c_is_not_the_drivers_fault():
    with pytest.raises(KeyboardInterrupt):
        ask(fails(KeyboardInterrupt()))


def test_many_slow_answers_add_up():
    guard = DriverGuard(GivesAnswer(lambda: time.sleep(0.05) or Command(0.0)), whole_drive=0.2)

    def many():
        for _ in range(100):
            guard.ask(VIEW)

    with pytest.raises(DriverError, match=r"more than 0.2 s for one drive"):
        many()
