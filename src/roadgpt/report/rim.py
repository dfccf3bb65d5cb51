"""A rim around the driven path where the car was outside its lane, coloured by how far, and its key."""

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from roadgpt.drive import Drive
from roadgpt.report.canvas import SEVERE, SOFT
from roadgpt.report.plan_view import Array
from roadgpt.report.text_width import inches
from roadgpt.verdict import SEVERITIES, Severity, severity

WIDTH = 8.0  # points
SIZE, FOOT = 9, 0.14  # points; inches above the foot of the figure
SWATCH, GAP = 0.25, 0.11  # inches
OUTSIDE: tuple[Severity, ...] = SEVERITIES[1:]


def severities(drive: Drive | None) -> list[Severity]:
    """Returns how far outside its lane the car was at each step that counts; empty without a drive."""
    return [] if drive is None else [severity(share) for share in drive["outside"][: drive.lane_steps]]


def draw_rim(axes: Axes, pieces: Array, found: list[Severity]) -> None:
    """Draws the rim around pieces ``(n, 2, 2)`` of a path; ``found`` is the severity of each."""
    for name in OUTSIDE:
        some = [piece for piece, where in zip(pieces, found, strict=False) if where == name]
        if not some:
            continue
        rim = LineCollection(some, colors=SEVERE[name], linewidths=WIDTH, zorder=5.5, capstyle="round")
        axes.add_collection(rim)


def draw_key(figure: Figure, left: float, found: list[Severity]) -> None:
    """Writes what the colours of the rim mean at the foot of a figure, from ``left`` inches on."""
    wide, high = figure.get_size_inches()
    for name in OUTSIDE:
        if name not in found:
            continue
        ends = (left / wide, (left + SWATCH) / wide)
        figure.add_artist(Line2D(ends, (FOOT / high, FOOT / high), lw=WIDTH, color=SEVERE[name]))
        text = f"{name} its lane"
        figure.text((left + SWATCH + GAP) / wide, FOOT / high, text, size=SIZE, color=SOFT, va="center")
        left += SWATCH + 3 * GAP + inches(text, SIZE)
