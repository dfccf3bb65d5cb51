"""README, the tutorial and the how-tos show what their commands print and draw today."""

import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def figures() -> Iterator[ModuleType]:
    spec = importlib.util.spec_from_file_location("figures", ROOT / "docs" / "figures.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["figures"] = module
    spec.loader.exec_module(module)
    monkeypatch = pytest.MonkeyPatch()
    monkeypatch.setattr(module.subprocess, "run", run_here)
    yield module
    monkeypatch.undo()


def run_here(words: list[str], cwd: Path, **_: object) -> SimpleNamespace:
    """A command in this process, which has imported and compiled what every new one would again."""
    assert words[:3] == [sys.executable, "-m", "roadgpt"]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(cwd)
        patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
        done = CliRunner().invoke(app, words[3:], "roadgpt", catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return SimpleNamespace(stdout=done.stdout)


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("figures")


def test_pages_show_what_their_quick_commands_print(figures: ModuleType, work: Path) -> None:
    shown = 0
    for page in figures.PAGES:
        there = (ROOT / page).read_text(encoding="utf-8")
        shown += sum(not match["slow"] for match in figures.BLOCK.finditer(there))
        now = figures.renewed(work, page, is_quick=True)
        assert figures.TIMES.sub("", now) == figures.TIMES.sub("", there), (
            f"{page} is stale: say make figures"
        )
    assert shown >= 5


def test_every_command_that_makes_a_picture_stands_on_a_page(figures: ModuleType) -> None:
    text = "\n".join((ROOT / page).read_text(encoding="utf-8") for page in figures.PAGES)
    assert [command for command in figures.COMMANDS.values() if command not in text] == []


def test_a_picture_is_of_the_road_that_its_command_makes(figures: ModuleType, work: Path) -> None:
    """Coarsely: fonts and renderers differ between machines, roads must not."""
    name = "ramp"
    now = figures.framed(figures.PICTURES[name](work), name)
    kept = Image.open(figures.IMAGES / f"{name}.png")
    one, other = (np.asarray(each.convert("L").resize((96, 64)), float) for each in (now, kept))
    away = np.abs(one - other).mean()
    turned = np.abs(one - other[:, ::-1]).mean()
    assert away < 3, f"docs/images/{name}.png is stale: say make figures"
    assert away < turned / 3  # so a picture of another road would be noticed
