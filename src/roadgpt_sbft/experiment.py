"""Defines the Experiment (a generator with its budget) and the Ending (how and why the generator ended)."""

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
    """Name under which Python imports the generator's module."""
    class_name: str
    module_path: str | None = None
    """An additional folder in which Python searches for modules."""
    python: str | None = None
    """The Python interpreter in which the generator runs; None: the interpreter that runs RoadGPT."""
    time_budget: Positive | None = None
    """Seconds of wall time for generating and driving."""
    test_budget: Annotated[int, Field(ge=1)] | None = None
    """Number of tests, including invalid ones. Unlike a time budget, this number does not depend on the
    speed of the machine.
    """
    patience: Positive = 600.0
    """Seconds of wall time within which the generator must submit its next test."""
    grace: Positive = 30.0
    """Seconds of wall time within which the generator must stop after its budget is used up."""
    debug: bool = False
    """Whether the generator writes a more detailed log."""


class Ending(Frozen):
    """How and why a generator ended."""

    how: How
    sentence: str

    @property
    def is_fine(self) -> bool:
        """Whether the generator ended normally: it finished by itself or used up its budget."""
        return self.how in FINE

    @property
    def is_of_a_generator(self) -> bool:
        """Whether the generator was loaded before the end. The answer is also False if the chosen Python
        interpreter cannot run generators."""
        return self.how not in UNBEGUN
