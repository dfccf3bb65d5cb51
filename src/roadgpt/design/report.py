"""What happened while a design was made: kept with the Run, so that nothing about it is hidden."""

from typing import Any

from roadgpt.brief.model import Frozen
from roadgpt.chat import Usage


class DesignReport(Frozen):
    """A report of one draft by a designer that asks a language model."""

    rounds: int = 0
    """Number of questions that the model was asked."""
    changes: tuple[str, ...] = ()
    """What was changed of the proposal, one sentence each."""
    tokens: Usage = Usage()
    seconds: float = 0.0
    """Time that the model took, in seconds."""
    cost: float | None = None
    """Cost in USD; None if the price is not known."""
    model: str = ""
    """Name of the model, as the server gives it."""
    proposed: dict[str, Any] | None = None
    """The model's own design, before any change, in RoadGPT's format."""
