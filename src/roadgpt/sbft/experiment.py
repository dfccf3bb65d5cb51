"""The Experiment: which generator is let loose, for how long; and the Ending: how that ended."""

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
    """As Python imports it."""
    class_name: str
    module_path: str | None = None
    """A folder that Python is to look for modules in, too."""
    python: str | None = None
    """The interpreter that it runs in; None: RoadGPT's own."""
    time_budget: Positive | None = None
    """Seconds of wall time for generating and driving."""
    test_budget: Annotated[int, Field(ge=1)] | None = None
    """How many tests, invalid ones included; a fair budget on every machine."""
    patience: Positive = 600.0
    """Seconds of wall time in which a generator must bring its next test."""
    grace: Positive = 30.0
    """Seconds of wall time for a generator to notice that its budget is over."""
    debug: bool = False
    """Its log holds more."""


class Ending(Frozen):
    """How a generator ended."""

    how: How
    sentence: str

    @property
    def is_fine(self) -> bool:
        """Did it work until it had enough, or until its budget was over?"""
        return self.how in FINE

    @property
    def is_of_a_generator(self) -> bool:
        """Was there a generator that could work at all?"""
        return self.how not in UNBEGUN
