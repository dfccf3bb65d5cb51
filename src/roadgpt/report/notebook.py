"""Makes the pictures with which notebooks display roads, designs, Runs and campaigns; ``roadgpt`` registers
``png_of`` with IPython.
"""

from typing import Any

from matplotlib.figure import Figure

from roadgpt.campaign import Campaign
from roadgpt.errors import RoadGPTError
from roadgpt.report.birds_eye import birds_eye
from roadgpt.report.canvas import encoded, in_our_style
from roadgpt.report.overview import pages
from roadgpt.report.plotting import plot
from roadgpt.road import Design, Road
from roadgpt.run import Run

SIDE = 5.0  # inches


@in_our_style
def png_of(value: Any) -> bytes | None:
    """Returns the bytes of a PNG file with a picture of the value, or None if there is nothing to show.

    Args:
        value: a Road, a Design, a Run, or a Campaign. For a Campaign, the first page of ``overview`` is
            shown.
    """
    figure = _figure(value)
    return None if figure is None else encoded(figure, "png")


def _figure(value: Any) -> Figure | None:
    if isinstance(value, Run):
        return None if value.road is None else birds_eye(value)
    if isinstance(value, Road | Design):
        figure = Figure(figsize=(SIDE, SIDE), facecolor="white", layout="constrained")
        plot(value, figure.add_subplot())
        return figure
    if isinstance(value, Campaign):
        try:
            return next(iter(pages(value.folder)), None)
        except RoadGPTError:  # of a campaign that has not begun, its one line is enough
            return None
    return None
