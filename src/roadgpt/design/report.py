"""What happened while a design was made: kept with the Run, so that nothing about it is hidden."""

from typing import Any

from roadgpt.brief.model import Frozen
from roadgpt.chat import Usage


class DesignReport(Frozen):
    """A report of one draft by a designer that asks a language model."""

    rounds: int = 0
    """Questions that it took."""
    changes: tuple[str, ...] = ()
    """What was changed of the proposal, one sentence each."""
    tokens: Usage = Usage()
    seconds: float = 0.0
    """That the model took."""
    cost: float | None = None
    """USD; None: the price is not known."""
    model: str = ""
    """As the server calls it."""
    proposed: dict[str, Any] | None = None
    """The model's own design, before any change, in RoadGPT's format."""
