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
    if not (SHARED / "referee_networks.py").exists():
        pytest.skip("the referee of networks is not at hand")
    sys.path.insert(0, str(SHARED))
    try:
        return importlib.import_module("referee_networks")
    finally:
        sys.path.remove(str(SHARED))
