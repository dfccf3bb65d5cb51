"""A designer that asks a language model for one number a road: small enough to see through."""

from collections.abc import Callable
from typing import Any

import pytest
from pydantic import BaseModel

from roadgpt import plugins
from roadgpt.chat import ChatSettings, Message, configured, open_chat
from roadgpt.road import Design, Segment


class Turn(BaseModel):
    degrees: float


class Asker:
    """Asks how far the only turn turns."""

    redrafts = False
    vary: Callable[[int], str] = staticmethod(lambda seed: f"road {seed}")

    def __init__(self, settings: ChatSettings | None = None) -> None:
        self.chat = open_chat(settings or configured())

    def draft(self, brief: Any, world: Any, notes: Any, earlier: Any, seed: int) -> Design:
        reply = self.chat.ask([Message(role="user", text=f"How far does it turn? {self.vary(seed)}")], Turn)
        straight = Segment(distance=40, direction="straight", incline=1)
        turn = Segment(distance=50, direction="left", incline=1, turn_degrees=reply.data.degrees)
        return Design(starting_point=(60, 60, 0), theta=10, segments=(straight, turn, straight))


class Repeater(Asker):
    """Asks the same for every road, as the thesis did."""

    vary = staticmethod(lambda seed: "")


def on_shelf(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let both be found."""
    installed = plugins.find
    ours = {("designers", "asker"): Asker, ("designers", "repeater"): Repeater}
    monkeypatch.setattr(
        plugins, "find", lambda shelf, name: ours.get((shelf, name)) or installed(shelf, name)
    )
