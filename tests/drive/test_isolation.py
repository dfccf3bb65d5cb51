"""Drivers of other people's files: what they do to their process costs their own drive, and never ours."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from road_parts import road_of
from roadgpt import children
from roadgpt.drive import simulate
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.isolation import driver_of, process
from roadgpt.drive.isolation.proxy import IsolatedDriver
from roadgpt.drive.loading import load_driver
from roadgpt.errors import DriverError
from roadgpt.road import Road, Site, World

HEAD = """
import ctypes, os, signal, sys, threading, time
from pathlib import Path
from roadgpt.drive import Camera, Command

def keep(view):
    return Command(-0.2 * (view.t + 2), 0.3 if view.speed < 9 else 0.0, 0.0)
"""
CALM = "    def steer(self, view): return keep(view)"
STRAIGHT = Road.through([[0, 0], [25, 0], [50, 0]])


@pytest.fixture
def spec(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> "object":
    monkeypatch.chdir(tmp_path)

    def written(body: str, name: str = "d") -> str:
        Path(f"{name}.py").write_text(f"{HEAD}\nclass D:\n{body}")
        return f"{name}.py:D"

    return written


def went(spec: str) -> object:
    return simulate(STRAIGHT, World(), spec, 1)


def test_ours_sit_here_and_all_others_apart(spec) -> None:
    assert isinstance(driver_of("reference"), Reference)
    assert isinstance(driver_of(spec("    def steer(self, view): return keep(view)")), IsolatedDriver)


def test_a_driver_apart_drives_the_same_bytes_as_here(tmp_path: Path) -> None:
    copy = tmp_path / "copy.py"
    copy.write_text(Path(sys.modules[Reference.__module__].__file__).read_text())
    road, world = road_of((40, 0, 3), (50, 60, 6), (50, -50, -4)), World(site=Site(friction=0.8))
    apart = simulate(road, world, driver_of(f"{copy}:Reference"), 3)
    assert apart.to_bytes() == simulate(road, world, Reference(), 3).to_bytes()


def test_a_driver_that_sees_has_the_same_pictures(spec) -> None:
    seeing = spec(
        "    camera = Camera(width=32, height=16, every=2)\n"
        "    def steer(self, view):\n"
        "        shape = view.image.shape == (16, 32, 3)\n"
        "        view.image[0, 0] = 255\n"
        "        return Command(1e-5 * float(view.image.sum() % 997), 0.3 * shape, 0.0)"
    )
    here = simulate(STRAIGHT, World(), load_driver(seeing), 1)
    assert went(seeing).to_bytes() == here.to_bytes()
    assert len(np.unique(here["steer"])) > 10


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The drive of a driver that does nothing to its process."""
    file = tmp_path_factory.mktemp("calm") / "calm.py"
    file.write_text(f"{HEAD}\nclass D:\n{CALM}")
    return went(f"{file}:D").to_bytes()


@pytest.mark.parametrize(
    "nuisance",
    [
        "signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001); signal.signal(signal.SIGALRM, lambda *_: None)",
        "os.chdir(os.sep); os.environ.clear(); sys.path.clear(); os.umask(0o777)",
        "signal.signal(signal.SIGINT, signal.SIG_IGN); signal.signal(signal.SIGTERM, signal.SIG_IGN)",
        "threading.Thread(target=time.sleep, args=(3600,)).start()",
        "print('x' * 100); os.write(1, b'loud'); sys.stdin.read()",
        "sys.stdout = sys.stderr = None; os.closerange(0, 3)",
    ],
)
def test_what_a_driver_does_to_its_process_is_its_own_affair(spec, nuisance: str, undisturbed: bytes) -> None:
    here = Path.cwd(), {**os.environ}, [*sys.path], signal.getsignal(signal.SIGINT)
    first = spec(f"    def start(self, road, world, seed):\n        {nuisance}\n{CALM}", "loud")
    assert went(first).to_bytes() == undisturbed
    assert (Path.cwd(), {**os.environ}, [*sys.path], signal.getsignal(signal.SIGINT)) == here
    seen = spec(
        "    def start(self, road, world, seed):\n"
        "        Path('seen').write_text(os.getcwd() + ' ' + str('PATH' in os.environ))\n" + CALM,
        "next",
    )
    assert went(seen).to_bytes() == undisturbed
    assert Path("seen").read_text() == f"{Path.cwd()} True"


@pytest.mark.parametrize(
    ("does", "says"),
    [
        ("sys.exit(3)", r"driver 'D' raised SystemExit at 0.00 s of its drive \(.*d.py, line \d+\): 3"),
        ("1 / 0", r"driver 'D' raised ZeroDivisionError at 0.00 s .*line \d+"),
        ("os._exit(3)", r"driver 'D' ended its own process \(it ended with status 3\), at 0.00 s"),
        ("ctypes.string_at(0)", r"driver 'D' ended its own process \(it was ended by signal 11\)"),
        ("os.kill(os.getpid(), 9)", r"driver 'D' ended its own process \(it was ended by signal 9\)"),
        ("raise KeyboardInterrupt", r"the driver raised KeyboardInterrupt"),
        ("return 'left'", r"driver 'D' answered 'left' at 0.00 s"),
    ],
)
def test_whatever_goes_wrong_is_one_error_of_that_drive(spec, does: str, says: str) -> None:
    with pytest.raises(DriverError, match=says):
        went(spec(f"    def steer(self, view):\n        {does}"))
    assert went(spec("    def steer(self, view): return keep(view)")).ended == "goal"


HANGS = {
    "in Python": "while True: pass",
    "and catches all": "while True:\n            try: time.sleep(1)\n            except: pass",
    "in compiled code": "ctypes.PyDLL(None).sleep(3600)",  # which keeps Python from running
    "stopped": "os.kill(os.getpid(), signal.SIGSTOP)",
    "with a child that holds its line": "(os.fork() or time.sleep(3600)) and os._exit(0)",
}


@pytest.mark.skipif(os.name != "posix", reason="uses the system's C library")
@pytest.mark.parametrize("hang", HANGS.values(), ids=HANGS)
def test_a_driver_that_hangs_anywhere_is_ended(spec, hang: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roadgpt.drive.isolation.proxy.ONE_ANSWER", 0.5)
    driver = driver_of(spec(f"    def steer(self, view):\n        {hang}"))
    pid = driver._process._process.pid
    begun = time.perf_counter()
    with pytest.raises(DriverError, match=r"gave no answer within 0.5 s at 0.00 s|ended its own process"):
        simulate(STRAIGHT, World(), driver, 1)
    assert time.perf_counter() - begun < 10
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc")
def test_a_driver_that_eats_memory_is_ended(spec, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "memory_limit", lambda: 600e6)
    monkeypatch.setattr(process, "_idle", [])
    eats = (
        "    eaten = []\n"
        "    def steer(self, view):\n"
        "        self.eaten.append(b'x' * 20_000_000)\n        time.sleep(0.05)\n        return keep(view)"
    )
    with pytest.raises(DriverError, match=r"driver 'D' took \d\.\d GB of memory, more than 50% of this"):
        went(spec(eats))


def test_the_same_process_serves_many_drives_and_each_has_a_new_driver(spec) -> None:
    counts = spec(
        "    n = 0\n"
        "    def steer(self, view):\n"
        "        D.n += 1\n"
        "        Path('pids').open('a').write(f'{os.getpid()} {D.n}\\n') if D.n == 1 else None\n"
        "        return keep(view)"
    )
    for _ in range(3):
        assert went(counts).ended == "goal"
    lines = Path("pids").read_text().split("\n")[:-1]
    assert len(lines) == 3
    assert len(set(lines)) == 1


def test_it_ends_with_whoever_asks(spec, tmp_path: Path) -> None:
    path = spec(
        "    def steer(self, view):\n"
        "        Path('pid').write_text(str(os.getpid()))\n        while True: pass"
    )
    code = (
        "from roadgpt.drive import simulate; from roadgpt.road import Road, World\n"
        f"simulate(Road.through([[0, 0], [50, 0], [100, 0]]), World(), {path!r}, 1)"
    )
    asks = subprocess.Popen([sys.executable, "-c", code])
    due = time.monotonic() + 60
    while not (Path("pid").exists() and Path("pid").read_text()) and time.monotonic() < due:
        time.sleep(0.05)
    pid = int(Path("pid").read_text())
    asks.kill()
    asks.wait()
    while time.monotonic() < due:
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    children.kill(asks)
    pytest.fail("it goes on without anybody who asks")
