"""Shared by the generators that search: settings, candidates, and the proposals that are made of them."""

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, ValidationError, field_validator

from roadgpt.brief.model import Frozen
from roadgpt.campaign.behaviour import BOUNDS, bounds_of
from roadgpt.campaign.model import Cell, Pool, Proposal, Result
from roadgpt.campaign.variation import Candidate, VariationContext, VariationTask, make_candidate
from roadgpt.errors import UsageError
from roadgpt.run import seed_of

MOST_AXES = 4
DRIVEN = ("STD_SA", "MEAN_LP", "MAX_LP")
"""The features that a road has only after a drive."""


class SearchSettings(Frozen):
    """Settings of the generators that search.

    A plan has one table of settings for all its generators, so each of them knows all names and ignores those
    that it does not use: ``batch`` is for all, the others are for ``quality_diversity``.
    """

    batch: Annotated[int, Field(ge=1, le=1000)] = 10
    """Tests in a batch."""
    axes: Annotated[tuple[str, ...], Field(min_length=1, max_length=MOST_AXES)] = ("MAX_CURV", "STD_SA")
    """Features that span the map."""
    archive: Literal["grid", "cvt"] = "grid"
    """"grid": cells of a grid; "cvt": niches around evenly spread centroids."""
    cells: Annotated[int, Field(ge=2, le=10_000)] = 25
    """Number of cells along each axis of a grid, or number of niches."""
    candidates: Annotated[int, Field(ge=1, le=100)] = 8
    """Number of candidates for each road that is driven."""
    apart: Annotated[float, Field(ge=0, le=1000)] = 5.5
    """Smallest distance to every tested road: metres RMS after the best shift, rotation and reflection."""

    @field_validator("axes")
    @classmethod
    def _known(cls, axes: tuple[str, ...]) -> tuple[str, ...]:
        for axis in axes:
            try:
                bounds_of(axis)
            except KeyError:
                known = ", ".join(BOUNDS)
                raise ValueError(
                    f"there is no feature '{axis}'; there are {known}, and RADIUS_1, DEGREES_1 and so on"
                ) from None
        return axes


def settings_of(cell: Cell) -> SearchSettings:
    """Returns the settings of a generator.

    Raises:
        UsageError: a setting is unknown or out of range, or the cell builds splines.
    """
    if cell.request.setup.geometry != "arcs":
        raise UsageError(f"the generator '{cell.generator}' searches roads of arcs; say geometry = \"arcs\"")
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


def context_of(cell: Cell) -> VariationContext:
    """Returns what the candidates of a cell share."""
    return VariationContext(cell.brief, cell.request.world, cell.request.setup.rules)


def batch_rng(cell: Cell, batch: int) -> np.random.Generator:
    """Returns the random generator of one batch."""
    return np.random.default_rng([cell.request.seed, batch])


def make_candidates(tasks: Sequence[VariationTask], pool: Pool) -> list[Candidate]:
    """Makes candidates on the workers; returns those that could be made."""
    return [candidate for candidate in pool.map(make_candidate, tasks) if candidate is not None]


def proposals_of(cell: Cell, first: int, n: int, candidates: Sequence[Candidate]) -> list[Proposal]:
    """Returns proposals of candidates.

    Where there are fewer candidates than n, the workers draft the rest, if there is a description.
    """
    seed = cell.request.seed
    found = [
        Proposal(one.design, seed_of(seed, number), one.origin)
        for number, one in enumerate(candidates[:n], first)
    ]
    if cell.brief is not None:
        rest = range(first + len(found), first + n)
        found += [Proposal(None, seed_of(seed, number), "draft") for number in rest]
    return found


def is_usable(result: Result) -> bool:
    """Checks that a road was driven, so that a search can learn from the result."""
    is_judged = result.margin is not None and np.isfinite(result.margin)
    return result.design is not None and is_judged and bool(result.features)
