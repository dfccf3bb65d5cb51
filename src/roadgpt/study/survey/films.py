"""Makes films for raters with ``report.film``; a survey can do without them."""

from collections.abc import Sequence
from pathlib import Path

from roadgpt.errors import UsageError
from roadgpt.report.film import Settings, film_of, split_film
from roadgpt.report.film.encoding import encoder
from roadgpt.run import Run

BEFORE_THE_END = 0.1  # s; at the end of a drive films tell its outcome, which raters should not know
WHY_NONE = (
    "there are no films, because the library for them is not installed; raters see plots and the 3-D view. "
    "To add films, run python -m pip install 'roadgpt[film]' and make the survey again"
)


def are_possible() -> bool:
    """Returns whether the libraries for films are installed."""
    try:
        encoder()
    except UsageError:
        return False
    return True


def make_film(runs: Sequence[Run], path: Path, view: str) -> None:
    """Makes a film of one drive, or of two in a split screen."""
    longest = max(run.drive.duration for run in runs if run.drive is not None)
    settings = Settings(seconds=max(longest - BEFORE_THE_END, BEFORE_THE_END))
    if len(runs) == 1:
        film_of(runs[0], path, view, settings)
    else:
        split_film(runs[0], runs[1], path, view, settings)
