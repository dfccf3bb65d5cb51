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
from roadgpt.drive.isolation import driver_of, proxy
from roadgpt.drive.isolation.proxy import IsolatedDriver
from roadgpt.drive.loading import load_driver
from roadgpt.errors import DriverError, RoadGPTError
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


NUISANCE = (
    "signal.signal(signal.SIGALRM, lambda *_: None); signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)",
    "signal.signal(signal.SIGINT, signal.SIG_IGN); signal.signal(signal.SIGTERM, signal.SIG_IGN)",
    "print('x' * 100); os.write(1, b'loud'); sys.stdin.read()",
    "threading.Thread(target=time.sleep, args=(3600,)).start()",
    "os.chdir(os.sep); os.environ.clear(); sys.path.clear(); os.umask(0o777)",
    "sys.stdout = sys.stderr = None; os.closerange(0, 3)",
)


def test_what_a_driver_does_to_its_process_is_its_own_affair(spec, undisturbed: bytes) -> None:
    here = Path.cwd(), {**os.environ}, [*sys.path], signal.getsignal(signal.SIGINT)
    does = "".join(f"\n        {line}" for line in NUISANCE)
    first = spec(f"    def start(self, road, world, seed):{does}\n{CALM}", "loud")
    assert went(first).to_bytes() == undisturbed
    assert (Path.cwd(), {**os.environ}, [*sys.path], signal.getsignal(signal.SIGINT)) == here
    seen = spec(
        "    def start(self, road, world, seed):\n"
        "        Path('seen').write_text(os.getcwd() + ' ' + str('PATH' in os.environ))\n" + CALM,
        "next",
    )
    assert went(seen).to_bytes() == undisturbed
    assert Path("seen").read_text() == f"{Path.cwd()} True"


def test_whatever_goes_wrong_is_one_error_of_that_drive(spec) -> None:
    for does, says in (
        ("sys.exit(3)", r"driver 'D' raised SystemExit at 0.00 s of its drive \(.*d.py, line \d+\): 3"),
        ("1 / 0", r"driver 'D' raised ZeroDivisionError at 0.00 s .*line \d+"),
        ("raise KeyboardInterrupt", r"the driver raised KeyboardInterrupt"),
        ("return 'left'", r"driver 'D' answered 'left' at 0.00 s"),
        ("os._exit(3)", r"driver 'D' ended its own process \(it ended with status 3\), at 0.00 s"),
        ("ctypes.string_at(0)", r"driver 'D' ended its own process \(it was ended by signal 11\)"),
    ):
        with pytest.raises(DriverError, match=says):
            went(spec(f"    def steer(self, view):\n        {does}"))
    assert went(spec(CALM)).ended == "goal"


HANGS = {  # who is stopped heeds no signal but one, as who catches all or runs no Python
    "stopped": "os.kill(os.getpid(), signal.SIGSTOP)",
    "with a child that holds its line": "(os.fork() or time.sleep(3600)) and os._exit(0)",
}


def gone(pid: int, seconds: float = 10.0) -> bool:
    """Whether a process ends within some time; one that nobody waited for counts as ended."""
    due = time.monotonic() + seconds
    while time.monotonic() < due:
        state = Path(f"/proc/{pid}/stat")
        if not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z":
            return True
        time.sleep(0.05)
    return False


linux = pytest.mark.skipif(sys.platform != "linux", reason="asks /proc")


@linux
@pytest.mark.parametrize("hang", HANGS.values(), ids=HANGS)
def test_a_driver_that_hangs_anywhere_is_ended(spec, hang: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roadgpt.drive.isolation.proxy.ONE_ANSWER", 0.5)
    driver = driver_of(spec(f"    def steer(self, view):\n        {hang}"))
    begun = time.perf_counter()
    with pytest.raises(DriverError, match=r"gave no answer within 0.5 s at 0.00 s|ended its own process"):
        simulate(STRAIGHT, World(), driver, 1)
    assert time.perf_counter() - begun < 10
    assert gone(driver._process.process.pid)


def test_one_that_hangs_or_ends_before_it_drives_costs_one_drive(
    spec, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also while its file is imported; the next drive has a new process."""
    monkeypatch.setattr(proxy, "BEFORE_START", 1.0)
    for body, patience, says in (
        ("def start(self, *given): time.sleep(3600)", 12.0, "driver 'D' was not ready within 1 s: make"),
        ("def start(self, *given): os._exit(7)", 12.0, "driver 'D' ended its own .*status 7"),
        ("time.sleep(3600)", 2.0, "the driver d.py:D was not made within 1 s: let its __init__"),
        (
            "def __init__(self): os._exit(7)",
            12.0,
            "the driver d.py:D cannot be made: .*status 7",
        ),
    ):
        monkeypatch.setattr(proxy, "MAKING", patience)
        with pytest.raises(RoadGPTError, match=says):
            simulate(STRAIGHT, World(), IsolatedDriver(spec(f"    {body}\n{CALM}"), 1.0), 1)
    assert went(spec(CALM)).ended == "goal"


def test_what_a_driver_imports_is_as_new_in_every_drive(spec) -> None:
    Path("part").mkdir()
    Path("part/gain.py").write_text("seen = []")
    counts = spec(
        "    from part import gain\n"
        "    def start(self, *given):\n"
        "        self.gain.seen.append(1)\n"
        "        Path('seen').open('a').write(f'{os.getpid()} {len(self.gain.seen)}\\n')\n" + CALM
    )
    drives = [went(counts).to_bytes() for _ in range(3)]
    assert len({*drives}) == 1
    lines = Path("seen").read_text().split("\n")[:-1]
    assert len(lines) == 3
    assert [*{*lines}] == [lines[0]]  # one process, and a new module each time
    assert lines[0].endswith(" 1")
    Path("part/gain.py").write_text("seen = [1, 2, 3]")
    went(counts)
    assert Path("seen").read_text().endswith(" 4\n")


@linux
def test_a_driver_that_eats_memory_is_ended(spec, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(children, "memory_limit", lambda: 600e6)
    monkeypatch.setattr(proxy, "_idle", [])
    eats = (
        "    eaten = []\n"
        "    def steer(self, view):\n"
        "        self.eaten.append(b'x' * 20_000_000)\n        time.sleep(0.05)\n        return keep(view)"
    )
    with pytest.raises(DriverError, match=r"driver 'D' took \d\.\d GB of memory, more than 50% of this"):
        went(spec(eats))


@linux
@pytest.mark.parametrize("work", ["while True: pass", "return keep(view)"], ids=["busy", "idle"])
def test_it_ends_with_whoever_asks_and_so_does_all_that_it_has_started(spec, work: str) -> None:
    path = spec(
        "    def start(self, *given):\n"
        "        child = os.fork()\n"
        "        if not child: time.sleep(3600)\n"
        "        Path('pids').write_text(f'{os.getpid()} {child} ')\n"
        f"    def steer(self, view):\n        {work}"
    )
    code = (
        "import time; from roadgpt.drive import simulate; from roadgpt.road import Road, World\n"
        f"simulate(Road.through([[0, 0], [25, 0], [50, 0]]), World(), {path!r}, 1)\nprint(1, flush=True)\n"
        "time.sleep(3600)"
    )
    asks = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    due = time.monotonic() + 60
    while not (Path("pids").exists() and Path("pids").read_text()) and time.monotonic() < due:
        time.sleep(0.05)
    if work != "while True: pass":
        assert asks.stdout is not None
        assert asks.stdout.readline() == b"1\n"
    asks.kill()
    asks.communicate()
    assert all(gone(int(pid)) for pid in Path("pids").read_text().split())
