"""Whatever a driver does wrong costs one DriverError, and never the run."""

import json
import math
import signal
import threading
import time

import numpy as np
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


def ask(answer, limit=0.5):
    guard = DriverGuard(GivesAnswer(answer), one_answer=limit)
    with guard.watched():
        return guard.ask(VIEW)


def fails(error):
    def answer():
        raise error

    return answer


@pytest.mark.parametrize("answer", [Command(0.1, 0.5, 0.0), (0.1, 0.5, 0), [0.1, np.float32(0.5), False]])
def test_commands_and_plain_triples_are_understood(answer):
    assert ask(answer) == pytest.approx((0.1, 0.5, 0.0))


def test_pedals_are_held_to_their_range_and_the_steering_is_left_to_the_car():
    assert ask(Command(-9.0, 3.0, -1.0)) == (-9.0, 1.0, 0.0)


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


def test_the_error_names_the_line():
    with pytest.raises(DriverError, match=r"test_driver_guard.py, line \d+"):
        ask(fails(ValueError("oh no")))


def test_ctrl_c_is_not_the_drivers_fault():
    with pytest.raises(KeyboardInterrupt):
        ask(fails(KeyboardInterrupt()))


def test_who_cannot_steer_is_told_how():
    with pytest.raises(DriverError, match="give its class a method steer"):
        DriverGuard(object())


def endless():
    while True:
        pass


def stubborn():
    while True:
        try:
            while True:
                pass
        except Exception:
            continue


def asleep():
    time.sleep(60)


def in_thread(action):
    caught = []

    def body():
        try:
            action()
        except BaseException as error:
            caught.append(error)

    thread = threading.Thread(target=body)
    thread.start()
    thread.join(20)
    assert not thread.is_alive()
    return caught


@pytest.mark.parametrize("hang", [endless, stubborn, asleep])
def test_a_driver_that_hangs_is_stopped(hang):
    begun = time.perf_counter()
    with pytest.raises(DriverError, match=r"no answer within 0.5 s"):
        ask(hang)
    assert time.perf_counter() - begun < 5.0


@pytest.mark.parametrize("hang", [endless, stubborn])
def test_a_driver_that_hangs_in_another_thread_is_stopped(hang):
    caught = in_thread(lambda: ask(hang))
    assert len(caught) == 1
    assert isinstance(caught[0], DriverError)
    assert "no answer within" in str(caught[0])


def test_a_driver_of_our_own_may_wait_for_the_compiler():
    class Slow(GivesAnswer):
        def steer(self, view):
            time.sleep(0.3)
            return 0.1, 0.0, 0.0

    def asked() -> object:
        guard = DriverGuard(Slow(None), one_answer=0.1)
        with guard.watched():
            return guard.ask(VIEW)

    with pytest.raises(DriverError, match="no answer within"):
        asked()
    Slow.__module__ = "roadgpt.drive.drivers.slow"
    assert asked() == (0.1, 0.0, 0.0)


@pytest.mark.parametrize("does", [lambda: Command(0.0), fails(ValueError("oh no"))])
def test_no_thread_outlives_a_driver_that_was_asked_in_another_thread(does):
    left = []

    def asked():
        try:
            ask(does, limit=60.0)
        finally:
            left.extend(each.name for each in threading.enumerate() if each.name == "roadgpt-guard")

    begun = time.perf_counter()
    in_thread(asked)
    assert left == []
    assert time.perf_counter() - begun < 5.0


def test_start_is_watched_too():
    class Starts(GivesAnswer):
        def start(self, road, world, seed):
            raise ValueError("bad plan")

    guard = DriverGuard(Starts(Command(0.0)))
    with guard.watched(), pytest.raises(DriverError, match="bad plan"):
        guard.start(None, None, 0)


def test_a_driver_that_never_gets_ready_is_told_to_start_sooner():
    class Ponders(GivesAnswer):
        def start(self, road, world, seed):
            endless()

    guard = DriverGuard(Ponders(Command(0.0)), before_start=0.5)
    with guard.watched(), pytest.raises(DriverError, match=r"not ready within 0.5 s: make start\(\) return"):
        guard.start(None, None, 0)


def test_the_error_names_the_drivers_own_line_and_not_that_of_a_library():
    class Reads(GivesAnswer):
        def steer(self, view):
            return json.loads("no json")

    guard = DriverGuard(Reads(None))
    with guard.watched(), pytest.raises(DriverError, match=r"\(.*test_driver_guard.py, line \d+\)"):
        guard.ask(VIEW)


def test_an_alarm_of_a_library_in_c_is_left_alone():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(signal, "getsignal", lambda number: None)  # what Python says of a handler not its own
        patch.setattr(signal, "signal", lambda number, handler: pytest.fail("it was replaced"))
        with pytest.raises(DriverError, match="no answer within"):
            ask(endless)


def test_an_alarm_that_rings_at_once_finds_the_seat_ready():
    rung = []
    before = signal.signal(signal.SIGALRM, lambda *_: rung.append(True))
    install = signal.signal

    def ringing(number, handler):
        old = install(number, handler)
        signal.raise_signal(number)
        return old

    try:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(signal, "signal", ringing)
            assert ask(Command(0.1)) == (0.1, 0.0, 0.0)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_many_slow_answers_add_up():
    guard = DriverGuard(GivesAnswer(lambda: time.sleep(0.05) or Command(0.0)), whole_drive=0.2)

    def many():
        for _ in range(100):
            guard.ask(VIEW)

    with guard.watched(), pytest.raises(DriverError, match=r"more than 0.2 s for one drive"):
        many()


def test_somebody_elses_alarm_still_rings():
    rung = []
    before = signal.signal(signal.SIGALRM, lambda *_: rung.append(time.perf_counter()))
    outer = signal.setitimer(signal.ITIMER_REAL, 0.6)
    try:
        begun = time.perf_counter()
        ask(Command(0.0))
        left, _ = signal.getitimer(signal.ITIMER_REAL)
        assert 0.1 < left <= 0.6
        time.sleep(1.0)
        assert len(rung) == 1
        assert rung[0] - begun == pytest.approx(0.6, abs=0.35)
    finally:
        signal.setitimer(signal.ITIMER_REAL, *outer)
        signal.signal(signal.SIGALRM, before)
