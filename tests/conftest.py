"""Hypothesis looks at the same examples every time, so that a change is blamed only for what it broke.

To hunt for new ones: HYPOTHESIS_PROFILE=hunt python -m pytest
"""

import gc
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from click.testing import CliRunner, Result
from hypothesis import settings

from hints import HintCollector
from named_files import watch_commands
from roadgpt import provenance
from roadgpt.campaign.workers import InProcess

settings.register_profile("steady", derandomize=True, deadline=None, max_examples=12)
settings.register_profile("hunt", deadline=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "steady"))


def _no_telemetry(event: str, told: tuple[object, ...]) -> None:
    if event == "import" and told[0] == "onnxruntime" and os.environ.get("ORT_DISABLE_TELEMETRY") != "1":
        raise AssertionError("onnxruntime is imported with its telemetry on")


sys.addaudithook(_no_telemetry)
watch_commands()

# Tests that a shell started in the background ignore Ctrl-C, and all that they start would inherit that.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """Ten thousand tests and all that they import stay until the end; to look at them again and again takes
    seconds."""
    gc.freeze()


@pytest.fixture
def no_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Campaigns run their tests in this process; to start another one takes seconds."""
    monkeypatch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)


OF_LIBRARIES = ("PYTHONBREAKPOINT", "PYGAME_HIDE_SUPPORT_PROMPT")  # set by Ray and by Gymnasium
WATCHES = ("roadgpt-beamng", "roadgpt.campaign.workers")
FOR_GOOD = ("PYTEST_", "ORT_DISABLE_TELEMETRY", "RAY_USAGE_STATS_ENABLED", *OF_LIBRARIES)


@pytest.fixture(autouse=True)
def environment_is_left_as_it_was() -> Iterator[None]:
    """What a test leaves in the environment, such as a port, would decide about the tests behind it."""
    before = dict(os.environ)
    yield
    left = {name for name, _ in {*os.environ.items()} ^ {*before.items()} if not name.startswith(FOR_GOOD)}
    for name in left:
        os.environ.pop(name, None)
        if name in before:
            os.environ[name] = before[name]
    assert not left, f"this test leaves {', '.join(sorted(left))} in the environment"


@pytest.fixture(autouse=True)
def nothing_was_named() -> Iterator[None]:
    """What a test named as its own, a driver or a server, is a stranger's again in the next one."""
    yield
    for names in (provenance.CODE, provenance.SERVERS):
        names.forget()


@pytest.fixture(autouse=True)
def no_watch_is_left() -> Iterator[None]:
    """Threads that watch a driver, a simulator or workers end with what they watch."""
    before = {*threading.enumerate()}
    yield
    due = time.monotonic() + 5.0
    while left := [each.name for each in {*threading.enumerate()} - before if each.name in WATCHES]:
        assert time.monotonic() < due, f"this test leaves {', '.join(left)}"
        time.sleep(0.02)


@pytest.fixture(scope="session", autouse=True)
def hints(tmp_path_factory: pytest.TempPathFactory) -> Iterator[HintCollector]:
    """Each command line that a command prints in any test is looked at; see ``hints.py``."""
    base = tmp_path_factory.getbasetemp()
    seen = (base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base) / "hints"
    seen.mkdir(exist_ok=True)
    found, invoke = HintCollector(seen, base), CliRunner.invoke

    def looked_at(self: CliRunner, cli: Any, args: Any = None, *more: Any, **rest: Any) -> Result:
        result = invoke(self, cli, args, *more, **rest)
        if args is not None and not isinstance(args, str):
            found.look([str(word) for word in args], result)
        return result

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(CliRunner, "invoke", looked_at)
        yield found
