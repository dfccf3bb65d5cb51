"""Small stand-ins for parts: designers that can be told what to do, and roads that cost nothing."""

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from roadgpt import design, plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign import Campaign
from roadgpt.campaign.model import Cell
from roadgpt.campaign.single_test import Task
from roadgpt.chat import Meter
from roadgpt.errors import DesignError
from roadgpt.road import Design, Segment, World
from roadgpt.run import Draw, Request, Run

STRAIGHT = Segment(distance=50, direction="straight", incline=2)


def a_design(seed: int = 0, segments: Sequence[Segment] = ()) -> Design:
    """A valid road: two straights and a left turn of a size that depends on the seed."""
    turn = Segment(distance=40 + seed % 7, direction="left", incline=1, turn_degrees=30 + seed % 31)
    return Design(starting_point=(60, 60, 0), theta=seed % 90, segments=(STRAIGHT, turn, STRAIGHT, *segments))


TOO_STEEP = Segment(distance=60, direction="straight", incline=22)


class FreshDesigner:
    """Drafts a fresh valid road each time, and keeps what it was told."""

    def __init__(self) -> None:
        self.calls: list[tuple[tuple[str, ...], int, int]] = []

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> Design:
        self.calls.append((notes, len(earlier), seed))
        return a_design(seed)


class Learner(FreshDesigner):
    """Builds too steeply until it is told so."""

    def draft(self, brief: Any, world: Any, notes: tuple[str, ...], earlier: Any, seed: int) -> Design:
        super().draft(brief, world, notes, earlier, seed)
        return a_design(seed, () if any("steep" in note for note in notes) else (TOO_STEEP,))


class Stubborn(FreshDesigner):
    """Builds too steeply, whatever it is told."""

    def draft(self, brief: Any, world: Any, notes: tuple[str, ...], earlier: Any, seed: int) -> Design:
        super().draft(brief, world, notes, earlier, seed)
        return a_design(seed, (TOO_STEEP,))


class Unable(FreshDesigner):
    """Can design nothing, or nothing but some roads."""

    def __init__(self, able: Callable[[int], bool] = lambda seed: False) -> None:
        super().__init__()
        self.able = able

    def draft(self, brief: Any, world: Any, notes: tuple[str, ...], earlier: Any, seed: int) -> Design:
        if not self.able(seed):
            raise DesignError("no road of 9 hairpins fits on this map; ask for fewer")
        return super().draft(brief, world, notes, earlier, seed)


def _place(name: str) -> tuple[ModuleType, str]:
    module, _, attribute = name.rpartition(".")
    return import_module(module), attribute


def folder_of(
    request: Request,
    roads: int,
    out: Path,
    one: Callable[[int, Sequence[Design]], Run],
    draw: Draw | None = None,
    patch: Callable[[str, object], None] | None = None,
) -> Campaign:
    """A campaign whose Runs ``one`` makes, of a road's number and the designs before it."""

    def drafted(task: Task, cell: Cell, earlier: Sequence[Design], meter: Meter) -> Run:
        return one(task.number, earlier)

    def run_test(task: Task, *rest: object) -> Run:
        assert task.drafted is not None
        return task.drafted

    put = patch or (lambda name, value: setattr(*_place(name), value))
    put("roadgpt.campaign.scheduler.draft", drafted)
    put("roadgpt.campaign.run_folder.run_test", run_test)
    return Campaign.opened(request, Brief(words=request.words), roads, out, draw=draw)


def put_on_shelf(monkeypatch: pytest.MonkeyPatch, **parts: Any) -> None:
    """Let these designers (one object each) be found and asked besides what is installed."""
    installed = plugins.find

    def find(shelf: str, name: str) -> Any:
        return (lambda: parts[name]) if shelf == "designers" and name in parts else installed(shelf, name)

    def designer_of(name: str, chat: Any = None) -> Any:
        return parts[name] if name in parts else design.designer_of(name, chat)

    monkeypatch.setattr(plugins, "find", find)
    monkeypatch.setattr("roadgpt.run.designer_of", designer_of)
    monkeypatch.setattr("roadgpt.campaign.run_folder.designer_of", designer_of)
