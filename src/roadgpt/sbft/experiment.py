"""Defines the Experiment, which is a generator with its budget, and the Ending, which is how its work
ended."""

from typing import Annotated, Literal

from pydantic import Field

from roadgpt.brief.model import Frozen

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
How = Literal["done", "budget", "exit", "raised", "hung", "died", "unloadable", "unasked"]
FINE: tuple[How, ...] = ("done", "budget")
UNBEGUN: tuple[How, ...] = ("unloadable", "unasked")


class Experiment(Frozen):
    """One generator and its budget."""

    module_name: str
    """Name under which Python imports it."""
    class_name: str
    module_path: str | None = None
    """An additional folder in which Python searches for modules."""
    python: str | None = None
    """The interpreter that the generator runs in; None: RoadGPT's own."""
    time_budget: Positive | None = None
    """Seconds of wall time for generating and driving."""
    test_budget: Annotated[int, Field(ge=1)] | None = None
    """Number of tests, invalid ones included; a fair budget on every machine."""
    patience: Positive = 600.0
    """Seconds of wall time within which a generator must submit its next test."""
    grace: Positive = 30.0
    """Seconds of wall time within which a generator must notice that its budget is used up."""
    debug: bool = False
    """Whether its log is more detailed."""


class Ending(Frozen):
    """How a generator ended."""

    how: How
    sentence: str

    @property
    def is_fine(self) -> bool:
        """Whether it worked until it finished by itself, or until its budget was used up."""
        return self.how in FINE

    @property
    def is_of_a_generator(self) -> bool:
        """Whether a generator could be loaded at all."""
        return self.how not in UNBEGUN
