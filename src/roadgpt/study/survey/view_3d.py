"""Writes the 3-D view for raters, without verdict, measurements or marks that would suggest answers."""

from collections.abc import Sequence
from pathlib import Path

from roadgpt.report.view import page_of, scene
from roadgpt.run import Run
from roadgpt.run.atomic import write_whole

HIDDEN = {"outcome": "", "description": "", "about": "", "words": "", "places": []}


def write_view(runs: Sequence[Run], titles: Sequence[str], path: Path) -> None:
    """Writes the page of one road or of two."""
    write_whole(
        path,
        page_of([scene(run) | {"title": title} | HIDDEN for run, title in zip(runs, titles, strict=True)]),
    )
