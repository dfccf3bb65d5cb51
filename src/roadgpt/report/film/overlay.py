"""Writes text over the pictures of a film, such as speed, margin (the distance to failure) and outcome."""

from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb

from roadgpt.report.canvas import INK, LETTERS, OUTCOMES, SEVERE, VERMILLION, outcome_of
from roadgpt.report.film.glyphs import Frame, fill, shade, width_of, write
from roadgpt.report.film.trip import Readout
from roadgpt.report.text_width import POINTS, fitted
from roadgpt.run import Run
from roadgpt.verdict import percent, severity

TITLE, TEXT, SMALL, LARGE = 13, 12, 10, 27  # pixels in a picture 360 high
EDGE, LINE = 10, 17  # likewise: from the border, and from line to line
LEAST = 0.5  # of all sizes, in small pictures
WHOLE = 2.0  # m of margin that fill its bar
WHITE, PALE = (255, 255, 255), (206, 212, 218)


def _rgb(colour: str) -> tuple[int, int, int]:
    r, g, b = (round(255 * part) for part in to_rgb(colour))
    return r, g, b


@dataclass(frozen=True)
class Overlay:
    """Writes a Run's speed, outcome and other text into pictures of one size."""

    run: Run
    width: int
    height: int

    @property
    def scale(self) -> float:
        """Factor for the sizes of text and its distances from the edges; 1 in a picture of 640 by 360."""
        return max(LEAST, min(self.height / 360, self.width / 440))

    def _size(self, pixels: int) -> int:
        return max(7, round(pixels * self.scale))

    def lay(self, frame: Frame, readout: Readout, is_over: bool) -> None:
        """Writes the text into a frame; ``is_over`` adds the outcome, for frames after the drive."""
        self._title(frame)
        self._numbers(frame, readout)
        if is_over:
            self._outcome(frame)

    def _title(self, frame: Frame) -> None:
        """Writes the description at the top."""
        u, size = self.scale, self._size(TITLE)
        rows = fitted(self.run.title, (self.width - 2 * EDGE * u) / POINTS, size, True, 2).split("\n")
        shade(frame, 0, 0, self.width, (9 + LINE * len(rows)) * u)
        for k, row in enumerate(rows):
            write(frame, EDGE * u, (LINE * (k + 1)) * u, row, size, WHITE, "bold")

    def _numbers(self, frame: Frame, readout: Readout) -> None:
        """Writes speed, station and margin at the lower left."""
        u, edge = self.scale, EDGE * self.scale
        large, text, small = self._size(LARGE), self._size(TEXT), self._size(SMALL)
        wide, high = 148 * u, (78 if readout.margin is not None else 52) * u
        x, y = edge, self.height - edge - high
        shade(frame, x, y, x + wide, y + high)
        write(frame, x + 8 * u, y + 45 * u, f"at {readout.s:.0f} of {self.run.length:.0f} m", text, PALE)
        if readout.margin is None:  # the speed of the camera has no meaning
            write(frame, x + 8 * u, y + 24 * u, "not driven", self._size(TITLE), WHITE, "bold")
            return
        speed = f"{readout.speed * 3.6:.0f}"
        right = x + 62 * u
        write(frame, right - width_of(speed, large, "bold"), y + 29 * u, speed, large, WHITE, "bold")
        write(frame, right + 6 * u, y + 29 * u, "km/h", text, PALE)
        colour = _rgb(SEVERE[severity(readout.outside)] if readout.margin > 0 else VERMILLION)
        said = f"margin {readout.margin:.1f} m" if readout.margin > 0 else "out of its lane"
        if readout.outside > 0 and readout.margin > 0:
            said += f", {percent(readout.outside)} out"
        write(frame, x + 8 * u, y + 61 * u, said, small if readout.outside > 0 else text, WHITE)
        share = float(np.clip(readout.margin / WHOLE, 0.0, 1.0)) if readout.margin > 0 else 1.0
        left, wide = x + 8 * u, wide - 16 * u
        fill(frame, left, y + 67 * u, left + wide, y + 71 * u, (70, 76, 82))
        fill(frame, left, y + 67 * u, left + wide * share, y + 71 * u, colour)

    def _outcome(self, frame: Frame) -> None:
        """Writes the outcome and its sentence in the middle."""
        u, text, bold = self.scale, self._size(TEXT), self._size(LARGE)
        room = min(self.width - 2 * EDGE * u, 420 * u)
        rows = fitted(self.run.description, (room - 28 * u) / POINTS, text, lines=3).split("\n")
        outcome = outcome_of(self.run)
        if width_of(outcome, bold, "bold") > room - 28 * u:
            bold = text
        badge = width_of(outcome, bold, "bold")
        colour = OUTCOMES.get(outcome, INK)
        letters = _rgb(LETTERS[colour]) if colour in LETTERS else WHITE
        wide = max(badge, *(width_of(row, text) for row in rows)) + 28 * u
        high = (52 + LINE * len(rows)) * u
        x, y = (self.width - wide) / 2, self.height * 0.155
        fill(frame, x, y, x + wide, y + high, (255, 255, 255))
        fill(frame, x, y, x + wide, y + 38 * u, _rgb(colour))
        write(frame, x + (wide - badge) / 2, y + 29 * u, outcome, bold, letters, "bold")
        for k, row in enumerate(rows):
            start = x + (wide - width_of(row, text)) / 2
            write(frame, start, y + (38 + 5 + LINE * (k + 0.75)) * u, row, text, _rgb(INK))
