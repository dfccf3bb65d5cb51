"""The project's referee, an outside judge of roads, where it is at hand."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

SHARED = Path(__file__).resolve().parents[2] / "shared"


def load_referee() -> ModuleType | None:
    """As a module; None where it is not there."""
    file = SHARED / "referee.py"
    if not file.exists():
        return None
    spec = importlib.util.spec_from_file_location("referee_of_truths", file)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["referee_of_truths"] = module
    spec.loader.exec_module(module)
    return module


def networks_referee() -> ModuleType:
    """The outside referee of networks; where it is not at hand, the test is skipped."""
    return _referee_of("networks")


def traffic_referee() -> ModuleType:
    """That of scenes with others on the road."""
    return _referee_of("traffic")


def _referee_of(what: str) -> ModuleType:
    if not (SHARED / f"referee_{what}.py").exists():
        pytest.skip(f"the referee of {what} is not at hand")
    sys.path.insert(0, str(SHARED))
    try:
        return importlib.import_module(f"referee_{what}")
    finally:
        sys.path.remove(str(SHARED))
