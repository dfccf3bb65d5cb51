"""What searching generators share: settings, tasks for candidates, and proposals made of them."""

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
"""Features that a road has only once somebody drove it."""


class SearchSettings(Frozen):
    """Settings of searches. A plan has one table of them for all its generators, so all know the names, and
    leave alone what they do not need: only ``batch`` is for all, the rest is ``quality_diversity``'s."""

    batch: Annotated[int, Field(ge=1, le=1000)] = 10
    """Tests in a batch."""
    axes: Annotated[tuple[str, ...], Field(min_length=1, max_length=MOST_AXES)] = ("MAX_CURV", "STD_SA")
    """Features that span the map."""
    archive: Literal["grid", "cvt"] = "grid"
    """Cells of a grid, or niches around evenly spread centres."""
    cells: Annotated[int, Field(ge=2, le=10_000)] = 25
    """Along each axis of a grid; niches altogether."""
    candidates: Annotated[int, Field(ge=1, le=100)] = 8
    """Roads that are thought of for each that is driven."""
    apart: Annotated[float, Field(ge=0, le=1000)] = 5.5
    """Metres RMS, after the best shift, turn and mirror, that a road keeps from every tested one."""

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
    """A generator's settings.

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
            said = f"is unknown; there are {known}"
        else:
            said = str(first["msg"]).removeprefix("Value error, ")
        raise UsageError(f"setting '{name}' of the generator '{cell.generator}': {said}") from error


def context_of(cell: Cell) -> VariationContext:
    """What the candidates of a cell share."""
    return VariationContext(cell.brief, cell.request.world, cell.request.setup.rules)


def batch_rng(cell: Cell, batch: int) -> np.random.Generator:
    """The chance of one batch."""
    return np.random.default_rng([cell.request.seed, batch])


def make_candidates(tasks: Sequence[VariationTask], pool: Pool) -> list[Candidate]:
    """The candidates that could be made."""
    return [candidate for candidate in pool.map(make_candidate, tasks) if candidate is not None]


def proposals_of(cell: Cell, first: int, n: int, candidates: Sequence[Candidate]) -> list[Proposal]:
    """Proposals of candidates; where they are too few, the workers draft the rest, if there are words."""
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
    """Was the road driven, so that something can be learnt of it?"""
    is_judged = result.margin is not None and np.isfinite(result.margin)
    return result.design is not None and is_judged and bool(result.features)
