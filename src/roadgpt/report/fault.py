"""Draws the picture of one failure: the road around the place where the car left its lane, and the cause."""

from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

from roadgpt.campaign.faults.reason import FailureReason
from roadgpt.report.birds_eye import birds_eye
from roadgpt.report.canvas import in_our_style, save
from roadgpt.report.plan_view import Frame
from roadgpt.run import Run

BEFORE, AFTER = 50.0, 20.0  # m of road that are shown
ROOM = 6.0  # m beside it
LEAST = 45.0  # m across


def fault_picture(run: Run, reason: FailureReason, more: str = "") -> Figure:
    """Returns a bird's-eye view of the place of a failure, with the cause in its header.

    Args:
        run: a Run that failed.
        reason: the reason for the failure.
        more: text to add after the reason, such as "fails every time (5 of 5 disturbed drives)"; may be
            empty.
    """
    assert run.road is not None
    s = run.road.sample(1.0)
    near = (s.s >= reason.station - BEFORE) & (s.s <= reason.station + AFTER)
    frame = Frame.around(
        s.points[near][:, :2],
        ROOM + run.world.profile_of(run.road).paved_reach,
        LEAST,
        run.world.site.map_size,
    )
    said = f"{reason.sentence}; {more}" if more else reason.sentence
    return birds_eye(replace(run, description=said), frame=frame)


@in_our_style
def draw_fault(run: Run, reason: FailureReason, more: str, path: Path) -> Path:
    """Writes the picture of a failure to ``path``, whose suffix gives the format; see ``fault_picture``."""
    return save(fault_picture(run, reason, more), path)
