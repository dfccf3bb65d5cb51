"""What the generators that search share: their settings, and the class that they inherit from."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import Field, ValidationError, field_validator

from roadgpt.brief.model import Frozen
from roadgpt.campaign.model import Cell, Pool, Proposal, Result
from roadgpt.errors import UsageError
from roadgpt.run import seed_of
from roadgpt_search.behaviour import BOUNDS, bounds_of
from roadgpt_search.variation import Candidate, VariationContext, VariationTask, make_candidate

MOST_AXES = 4


USUAL_AXES, USUAL_ALSO = ("MAX_CURV", "STD_SA"), ("MAX_CURV", "DIR_COV")


class SearchSettings(Frozen):
    """Settings of the generators that search. A plan has one table for all of them, so each accepts all
    settings; all three use ``batch``, and only ``quality_diversity`` the others."""

    batch: Annotated[int, Field(ge=1, le=1000)] = 5
    """Number of tests in a batch. At most two batches are driven at the same time."""
    axes: Annotated[tuple[str, ...], Field(min_length=1, max_length=MOST_AXES)] = USUAL_AXES
    """Names of the features that are the axes of the feature map."""
    also: Annotated[tuple[str, ...], Field(max_length=MOST_AXES)] | None = None
    """Names of the features that are the axes of a second feature map; failures in new cells of either map
    count the same. Empty: there is no second map. None: MAX_CURV and DIR_COV if ``axes`` has its default
    value, otherwise no second map.
    """
    cells: Annotated[int, Field(ge=2, le=10_000)] = 25
    """Number of cells along each axis of a map."""
    candidates: Annotated[int, Field(ge=1, le=1000)] = 40
    """Number of sketches for each road that is driven; the surrogate predicts the outcome on each."""
    apart: Annotated[float, Field(ge=0, le=1000)] = 5.5
    """Smallest allowed distance between the shape of a candidate and that of every tested road, metres RMS
    after the best shift, rotation and reflection.
    """

    @field_validator("axes", "also")
    @classmethod
    def _known(cls, axes: tuple[str, ...] | None) -> tuple[str, ...] | None:
        for axis in axes or ():
            try:
                bounds_of(axis)
            except KeyError:
                known = ", ".join(BOUNDS)
                raise ValueError(
                    f"there is no feature '{axis}'; there are {known}, and RADIUS_1, DEGREES_1 and so on"
                ) from None
        return axes

    @property
    def maps(self) -> tuple[tuple[str, ...], ...]:
        """The axes of each feature map."""
        usual = USUAL_ALSO if self.axes == USUAL_AXES else ()
        also = usual if self.also is None else self.also
        return tuple(axes for axes in dict.fromkeys((self.axes, also)) if axes)


def settings_of(cell: Cell) -> SearchSettings:
    """Returns the settings of a generator."""
    if cell.request.setup.geometry != "arcs":
        raise UsageError(f"the generator '{cell.generator}' searches roads of arcs; say geometry = \"arcs\"")
    if cell.brief is not None and cell.brief.is_of_network:
        raise UsageError(
            f"the generator '{cell.generator}' searches single roads without medians and with traffic on "
            "the right; leave out --goal and --generator, or what only networks have"
        )
    try:
        return SearchSettings.model_validate(dict(cell.settings))
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(str(part) for part in first["loc"])
        if first["type"] == "extra_forbidden":
            known = ", ".join(SearchSettings.model_fields)
            problem = f"is unknown; there are {known}"
        else:
            problem = str(first["msg"]).removeprefix("Value error, ")
        raise UsageError(f"setting '{name}' of the generator '{cell.generator}': {problem}") from error


class SearchGenerator:
    """What the generators that search share: settings, requirements, candidate roads, and proposals."""

    def __init__(self, cell: Cell) -> None:
        """Reads the settings; raises UsageError if one cannot be used."""
        self._cell, self._wanted = cell, settings_of(cell)
        self.batch_size = self._wanted.batch
        axes = tuple(dict.fromkeys(axis for each in self._wanted.maps for axis in each))
        self._setting = VariationContext(cell.brief, cell.request.world, cell.request.setup.rules, axes)

    def tell(self, results: Sequence[Result]) -> None:
        """Learns from the results that have a design, a finite margin and features."""
        for result in results:
            is_judged = result.margin is not None and np.isfinite(result.margin)
            if result.design is not None and is_judged and result.features:
                self._learn(result)

    def _learn(self, result: Result) -> None:
        """Learns nothing, unless a search overrides this."""

    def _rng(self, batch: int) -> np.random.Generator:
        return np.random.default_rng([self._cell.request.seed, batch])

    def _candidates(self, tasks: Sequence[VariationTask], pool: Pool) -> list[Candidate]:
        """Makes candidate roads on the workers, and returns those that satisfy all rules and requirements."""
        return [candidate for candidate in pool.map(make_candidate, tasks) if candidate is not None]

    def _proposals(self, first: int, n: int, candidates: Sequence[Candidate]) -> list[Proposal]:
        """Returns up to n proposals made from candidates. If there are too few and the cell has a Brief, the
        workers design the roads of the remaining ones."""
        seed = self._cell.request.seed
        found = [
            Proposal(one.design, seed_of(seed, number), one.origin)
            for number, one in enumerate(candidates[:n], first)
        ]
        if self._cell.brief is not None:
            rest = range(first + len(found), first + n)
            found += [Proposal(None, seed_of(seed, number), "draft") for number in rest]
        return found
