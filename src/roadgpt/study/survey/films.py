"""Films for raters, by ``report.film``; where its libraries are missing a survey goes without."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from roadgpt.run import Run

WHY_NONE = (
    "there are no films, because the libraries for them are not installed; raters see plots and the 3-D "
    "view. For films: python -m pip install 'roadgpt[film]', and make the survey again"
)


def are_possible() -> bool:
    """Is there what films need?"""
    return find_spec("av") is not None and find_spec("roadgpt.report.film") is not None


def make_film(runs: Sequence[Run], path: Path, camera: str) -> None:
    """Film one drive, or two in a split screen."""
    from roadgpt.report.film import film_of, split_film

    if len(runs) == 1:
        film_of(runs[0], path, camera)
    else:
        split_film(runs[0], runs[1], path, camera)
