"""One Ctrl-C is enough, wherever it strikes; SIGTERM alike; a second one ends the program at once."""

import os
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.skipif(os.name != "posix", reason="sends signals")

HEAD = """
import sys, time, weakref
from roadgpt import stopping
stopping.install()
print("begun", flush=True)
"""
# Python spends nearly all of its time in a callback from which it drops what is raised.
DROPS = (
    HEAD
    + """
class Thing: ...
def callback(_):
    due = time.perf_counter() + 0.05
    while time.perf_counter() < due: pass
def work():
    while True:
        thing = Thing()
        kept = weakref.ref(thing, callback)
        del thing
        {between}
try:
    work()
except KeyboardInterrupt:
    print("told", flush=True)
    time.sleep(0.3)  # cleaning up is left alone
    print("clean", flush=True)
    sys.exit(stopping.status())
"""
)
HANGS = (
    HEAD.partition("print")[0]
    + """
try:
    print("begun", flush=True)
    time.sleep(60)
finally:
    print("cleaning", flush=True)
    time.sleep(60)
"""
)


def begun(code: str) -> "subprocess.Popen[str]":
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    return process


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("between", ["stopping.look()", "time.sleep(0.02)"])
def test_one_that_python_drops_is_told_all_the_same(sent: signal.Signals, between: str) -> None:
    processes = [begun(DROPS.replace("{between}", between)) for _ in range(2)]
    for process in processes:  # at two moments
        time.sleep(0.12)
        process.send_signal(sent)
    for process in processes:
        said, complained = process.communicate(timeout=20)
        assert (process.returncode, said, complained) == (128 + sent, "told\nclean\n", "")


def test_a_second_one_ends_it_at_once() -> None:
    process = begun(HANGS)
    process.send_signal(signal.SIGINT)
    assert process.stdout is not None
    assert process.stdout.readline() == "cleaning\n"
    process.send_signal(signal.SIGINT)  # one press may come twice, from the terminal and from a wrapper
    time.sleep(0.5)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    assert process.wait(5) == 130
    process.communicate()


def test_signals_that_whoever_started_us_had_ignored_stay_so() -> None:
    code = HEAD + "time.sleep(1); print('end')"
    ignoring = (
        f"import os, signal; signal.signal(signal.SIGINT, signal.SIG_IGN); os.execv({sys.executable!r}, "
    )
    process = begun(ignoring + f"[{sys.executable!r}, '-c', {code!r}])")
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=20)
    assert (process.returncode, said) == (0, "end\n")


def test_the_status_is_that_of_the_signal_whatever_a_library_has_seen() -> None:
    # what compiles code in C remembers the exception, and Python then ends the process by SIGINT
    seen = "import ctypes, os; ctypes.pythonapi.PyRun_SimpleString(b'raise KeyboardInterrupt')\n"
    waits = "try: time.sleep(60)\nexcept KeyboardInterrupt: sys.exit(stopping.status())\n"
    body = "".join(f"    {line}\n" for line in (seen + waits).splitlines())
    process = begun(f"{HEAD}\ntry:\n{body}finally:\n    stopping.leave()")
    time.sleep(0.5)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=20)
    assert process.returncode == 143


def test_objects_that_were_half_made_end_in_silence() -> None:
    code = (
        HEAD
        + """
class Thing:
    def __del__(self): self.half
try: time.sleep(60)
except KeyboardInterrupt:
    Thing()
    stopping.leave()
"""
    )
    process = begun(code)
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    _, complained = process.communicate(timeout=20)
    assert (process.returncode, complained) == (130, "")
