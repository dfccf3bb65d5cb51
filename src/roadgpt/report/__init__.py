"""Reports: makes pictures of Runs and campaigns. Verb: ``draw``; the only room that imports matplotlib.

birds_eye.png          the road from above, the driven path by speed, the place of a failure or objection
height.png             distance against height
curvature_grade.png    curvature, grade and speed along the road, with the limits of the rules
overview.png           all roads of a campaign

``view`` makes a page with the road in 3-D instead; its verb is ``view.write``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from roadgpt.report.birds_eye import Scale, birds_eye
from roadgpt.report.canvas import FORMATS, PNG, Format, in_our_style, save_all
from roadgpt.report.height import height_profile
from roadgpt.report.overview import overview
from roadgpt.report.plotting import plot
from roadgpt.report.strip import strip
from roadgpt.run import Run

__all__ = [
    "FORMATS",
    "Drawing",
    "Format",
    "Scale",
    "birds_eye",
    "draw",
    "drawing",
    "height_profile",
    "overview",
    "plot",
    "strip",
]


@in_our_style
def draw(run: Run, folder: Path | str, axes: Scale = "equal", formats: Sequence[Format] = PNG) -> list[Path]:
    """Draw all pictures of a Run into a folder that exists; none of a Run that has no road.

    Args:
        run: driven or not, valid or not.
        folder: where the pictures go; those of the same names are replaced.
        axes: "equal" fits and shows metres as metres; "thesis" gives the two plots RoadGPT's fixed axes.
        formats: of the files; each picture is written in every one of them.
    """
    if run.road is None:
        return []
    folder = Path(folder)
    pictures = {
        "birds_eye.png": birds_eye(run, axes),
        "height.png": height_profile(run, axes),
        "curvature_grade.png": strip(run),
    }
    return [path for name, figure in pictures.items() for path in save_all(figure, folder / name, formats)]


@dataclass(frozen=True)
class Drawing:
    """Draws for a campaign as it goes; hand it to ``run.campaign``."""

    axes: Scale = "equal"
    formats: tuple[Format, ...] = PNG

    def of_run(self, run: Run, folder: Path) -> list[Path]:
        """All pictures of a Run."""
        return draw(run, folder, self.axes, self.formats)

    def of_campaign(self, folder: Path) -> list[Path]:
        """All roads of a campaign on one page, or on several."""
        return overview(folder, self.formats)


def drawing(axes: Scale = "equal", formats: Sequence[Format] = PNG) -> Drawing:
    """Who draws a campaign's pictures, on axes to scale or on RoadGPT's, in these formats."""
    return Drawing(axes, tuple(formats))
