"""Records how a language model made a design; the record is kept with the Run."""

from typing import Any

from roadgpt.brief.model import Frozen
from roadgpt.chat import Usage


class DesignReport(Frozen):
    """How a language model made one draft: its proposal, the changes to it, requests, time and cost."""

    rounds: int = 0
    """Number of requests to the model."""
    changes: tuple[str, ...] = ()
    """Sentences that say what was changed in the model's proposal."""
    tokens: Usage = Usage()
    """Tokens that the model read and wrote."""
    seconds: float = 0.0
    """Time in seconds that the model took."""
    cost: float | None = None
    """Cost in USD; None if the price is not known."""
    model: str = ""
    """Name of the model as reported by its server."""
    proposed: dict[str, Any] | None = None
    """The model's proposal before any change, in RoadGPT's segment format; None if there was none."""
