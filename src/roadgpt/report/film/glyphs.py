"""Writes text into frames; the raster image of each letter is computed once."""

from functools import cache
from typing import Literal, NamedTuple

import numpy as np
from matplotlib.font_manager import FontProperties, findfont, get_font
from numpy.typing import NDArray

from roadgpt.report.text_width import POINTS

Frame = NDArray[np.uint8]
Weight = Literal["normal", "bold"]


class Glyph(NamedTuple):
    """The raster image of one letter at one size."""

    cover: NDArray[np.uint8]
    """Coverage of each pixel, ``(height, width)``, 0 to 255."""
    top: int
    """Pixels from the baseline up to the first row of the image."""
    left: int
    """Pixels from the start of the letter to the first column of the image."""
    advance: float
    """Pixels from the start of the letter to the start of the next one."""


@cache
def glyph(letter: str, size: int, weight: Weight) -> Glyph:
    """Returns the raster image of a letter; ``size`` is the font size in pixels."""
    font = get_font(findfont(FontProperties(family="DejaVu Sans", weight=weight)))
    font.set_size(float(size), POINTS)
    advance = float(font.load_char(ord(letter)).linearHoriAdvance) / 65536
    font.set_text(letter)
    font.draw_glyphs_to_bitmap(antialiased=True)
    cover = np.array(font.get_image())
    left, _ = font.get_bitmap_offset()
    top = len(cover) - 1 - int(np.ceil(font.get_descent() / 64))  # its last row is empty
    return Glyph(cover, top, int(np.floor(left / 64)), advance)


def width_of(text: str, size: int, weight: Weight = "normal") -> int:
    """Returns the width of a line of text in pixels."""
    return int(np.ceil(sum(glyph(letter, size, weight).advance for letter in text)))


def write(
    frame: Frame, x: float, y: float, text: str, size: int, colour: tuple[int, int, int] = (255, 255, 255),
    weight: Weight = "normal",
) -> None:  # fmt: skip
    """Writes one line of text into a frame from (x, y) on the baseline; text beyond the frame is cut off."""
    for letter in text:
        shape = glyph(letter, size, weight)
        _blend(frame, round(x) + shape.left, round(y) - shape.top, shape.cover, colour)
        x += shape.advance


def _blend(frame: Frame, x: int, y: int, cover: NDArray[np.uint8], colour: tuple[int, int, int]) -> None:
    x0, y0 = max(x, 0), max(y, 0)
    x1, y1 = min(x + cover.shape[1], frame.shape[1]), min(y + cover.shape[0], frame.shape[0])
    if x0 >= x1 or y0 >= y1:
        return
    part = frame[y0:y1, x0:x1].astype(np.int32)
    share = cover[y0 - y : y1 - y, x0 - x : x1 - x, None].astype(np.int32)
    part += ((np.array(colour) - part) * share + 127) // 255
    frame[y0:y1, x0:x1] = part


def shade(frame: Frame, x0: float, y0: float, x1: float, y1: float, left: int = 110) -> None:
    """Multiplies the brightness of a rectangle by ``left`` / 256, so that text on it can be read."""
    part = frame[max(round(y0), 0) : max(round(y1), 0), max(round(x0), 0) : max(round(x1), 0)]
    part[:] = (part.astype(np.uint16) * left) >> 8


def fill(frame: Frame, x0: float, y0: float, x1: float, y1: float, colour: tuple[int, int, int]) -> None:
    """Fills a rectangle of a frame with a colour."""
    frame[max(round(y0), 0) : max(round(y1), 0), max(round(x0), 0) : max(round(x1), 0)] = colour
