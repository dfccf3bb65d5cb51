"""Fake BeamNGs for tests; no BeamNG that a test started outlives it."""

import logging
import os
import socket
from collections.abc import Iterator

import pytest

from roadgpt_beamng.session import leave_all


@pytest.fixture(autouse=True)
def _left() -> Iterator[None]:
    yield
    leave_all()


@pytest.fixture(autouse=True)
def _environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing of the user's own settings."""
    for name in list(os.environ):
        if name.startswith("ROADGPT_BEAMNG_") or name == "BNG_HOME":
            monkeypatch.delenv(name)


@pytest.fixture(autouse=True)
def _quiet() -> Iterator[None]:
    """The client logs every message; to have them kept costs more than to exchange them."""
    logger = logging.getLogger("beamngpy")
    logger.propagate = False
    yield
    logger.propagate = True


@pytest.fixture
def port() -> int:
    """One that nobody listens on; of a range in which the system hands out none, and other processes of these
    tests look at none."""
    process = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")) % 5
    first = 21000 + 2100 * process
    for number in range(first, first + 2100, 7):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", number))
            except OSError:
                continue
            return number
    raise AssertionError
