"""Every test begins without settings, without habits, and in a folder of its own."""

import os
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from chat.stub_server import StubServer, says, serving
from roadgpt import provenance
from roadgpt.chat.providers.openai import forget

KEY = "sk-canary-0123456789abcdefghijklmnop"
OURS = ("OPENAI_", "ROADGPT_", "AZURE_OPENAI_")


@pytest.fixture(autouse=True)
def alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for name in [name for name in os.environ if name.startswith(OURS)]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    place = tmp_path / "here"
    place.mkdir()
    monkeypatch.chdir(place)
    forget()
    provenance.SERVERS.forget()
    yield
    forget()
    provenance.SERVERS.forget()


@pytest.fixture
def stub() -> Iterator[StubServer]:
    with serving(says("{}")) as server:
        yield server


@pytest.fixture
def waits(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The pauses between tries, which nobody has to sit through."""
    taken: list[float] = []
    clock = SimpleNamespace(sleep=taken.append, time=time.time)
    monkeypatch.setattr("openai._base_client.time", clock)
    return taken
