"""Draws pictures of Runs and campaigns, and writes pages. Main function: ``draw``.

birds_eye.png          the road from above, the driven path coloured by speed, the place of a failure
height.png             distance against height
moments.png            among others: top views of the decisive moments; gap, time to collision, both speeds
curvature_grade.png    curvature, grade and speed along the road, with the limits of the rules; not among
                       others on a straight, even road
overview.png           all roads of a campaign

The packages ``view`` and ``page`` make the page with a road in 3-D, and reports on many roads."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from roadgpt.report.birds_eye import Scale, birds_eye
from roadgpt.report.canvas import FORMATS, PNG, Format, in_our_style, save_all
from roadgpt.report.height import height_profile, is_plain, strip
from roadgpt.report.moments import moments
from roadgpt.report.overview import overview
from roadgpt.run import Run

__all__ = [
    "FORMATS",
    "Drawing",
    "Format",
    "Scale",
    "birds_eye",
    "draw",
    "height_profile",
    "overview",
    "strip",
]


@in_our_style
def draw(run: Run, folder: Path | str, axes: Scale = "equal", formats: Sequence[Format] = PNG) -> list[Path]:
    """Draws all pictures of a Run into an existing folder, and returns their paths.

    A Run without a road has no pictures, so the list of paths is then empty. A map without a route is drawn
    from above only.

    Args:
        run: the Run; it may be invalid, and it need not have a drive.
        folder: the folder for the pictures; files of the same names are replaced.
        axes: "equal" for axes that fit the road and are to scale; "thesis" for the fixed axes of RoadGPT's
            thesis.
        formats: the file formats; each picture is written in all of them."""
    if run.road is None:
        return []
    folder = Path(folder)
    pictures = {"birds_eye.png": birds_eye(run, axes)}
    if run.road.has_way:
        pictures |= {"height.png": height_profile(run, axes)}
        met = moments(run)
        pictures |= {"moments.png": met} if met is not None else {}
        if met is None or not is_plain(run.road):
            pictures["curvature_grade.png"] = strip(run)
    return [path for name, figure in pictures.items() for path in save_all(figure, folder / name, formats)]


@dataclass(frozen=True)
class Drawing:
    """Draws the pictures of a campaign while it runs. Pass it to ``roadgpt.campaign`` as ``draw``."""

    axes: Scale = "equal"
    formats: Sequence[Format] = PNG

    def of_run(self, run: Run, folder: Path) -> list[Path]:
        """Draws all pictures of a Run, and returns their paths."""
        return draw(run, folder, self.axes, self.formats)

    def of_campaign(self, folder: Path) -> list[Path]:
        """Draws all roads of a campaign on one or more pages, and returns the paths of the pages."""
        return overview(folder, self.formats)
