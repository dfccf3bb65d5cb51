"""Lines that do not meet to the last digit: nothing stops, nothing wriggles, and what is told is measured."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from roadgpt.errors import UsageError
from roadgpt.network import ImportedRoad, read_opendrive

LANES = """<lanes>{offset}<laneSection s="0"><left>
<lane id="1" type="driving"><width sOffset="0" a="3"/></lane></left>
<center><lane id="0" type="none"><roadMark sOffset="0" type="broken"/></lane></center>
<right>{right}</right></laneSection></lanes>"""
ROUNDED = "its line has kinks or gaps, and is rounded off there"
RIGHT = '<lane id="-1" type="driving"><width sOffset="0" a="3"/></lane>'


class Pen:
    """Writes a reference line and remembers where it is."""

    def __init__(self, x: float = 0.0, y: float = 0.0, heading: float = 0.0) -> None:
        self.s, self.x, self.y, self.heading = 0.0, x, y, heading
        self.text = ""
        self.points: list[tuple[float, float]] = []

    def line(self, length: float, turn: float = 0.0, aside: float = 0.0, shape: str = "<line/>") -> "Pen":
        """A straight element that begins with a kink, or so far to the left of where the last one ended."""
        self.heading += turn
        self.x -= aside * math.sin(self.heading)
        self.y += aside * math.cos(self.heading)
        return self._write(length, shape, 0.0)

    def arc(self, length: float, curvature: float) -> "Pen":
        return self._write(length, f'<arc curvature="{curvature!r}"/>', curvature)

    def tiny(self, length: float, heading: float, shape: str = "<line/>") -> "Pen":
        """An element that nobody would see, and whose direction is noise."""
        self.text += (
            f'<geometry s="{self.s!r}" x="{self.x!r}" y="{self.y!r}" hdg="{heading!r}" length="{length!r}">'
            f"{shape}</geometry>"
        )
        self.s += length
        return self

    def _write(self, length: float, shape: str, curvature: float) -> "Pen":
        self.text += (
            f'<geometry s="{self.s!r}" x="{self.x!r}" y="{self.y!r}" hdg="{self.heading!r}" '
            f'length="{length!r}">{shape}</geometry>'
        )
        u = np.linspace(0, length, max(2, math.ceil(length * 50)))
        turned = self.heading + curvature * u / 2
        chord = u * np.sinc(curvature * u / 2 / np.pi)
        x, y = self.x + chord * np.cos(turned), self.y + chord * np.sin(turned)
        self.points += zip(x.tolist(), y.tolist(), strict=True)
        self.s, self.x, self.y = self.s + length, float(x[-1]), float(y[-1])
        self.heading += curvature * length
        return self

    def read(self, folder: Path, rest: str = "", right: str = RIGHT, offset: str = "") -> ImportedRoad:
        path = folder / "joins.xodr"
        lanes = LANES.format(right=right, offset=offset)
        path.write_text(
            f'<OpenDRIVE><road id="1" length="{self.s!r}"><planView>{self.text}</planView>{rest}{lanes}'
            "</road></OpenDRIVE>"
        )
        return read_opendrive(path)

    def away(self, found: ImportedRoad) -> float:
        """The largest distance from the file's line to the road, by brute force."""
        road = cKDTree(found.road.at(np.linspace(0, found.road.length, 40_000))[:, :2])
        return float(road.query(np.array(self.points))[0].max())


def tightest(found: ImportedRoad) -> float:
    bend = np.abs(found.road.curvature(np.linspace(0, found.road.length, 20_000)))
    return float(1 / max(bend.max(), 1e-9))


@pytest.mark.parametrize("length", [1e-9, 4e-4, 2e-3])
@pytest.mark.parametrize("heading", [0.3, -2.0])
@pytest.mark.parametrize("place", ["start", "middle", "end", "many"])
def test_an_element_of_a_millimetre_is_made_one_with_its_neighbours(
    tmp_path: Path, length: float, heading: float, place: str
) -> None:
    pen = Pen()
    for _ in range(place == "start"):
        pen.tiny(length, heading)
    pen.line(30)
    for i in range({"middle": 1, "many": 40}.get(place, 0)):
        pen.tiny(length, heading * (-1) ** i)
    pen.arc(30, 0.02)
    for _ in range(place == "end"):
        pen.tiny(length, heading)
    found = pen.read(tmp_path)
    assert found.road.length == pytest.approx(60, abs=0.1)
    assert pen.away(found) < 0.05
    if length < 1e-3 and place in ("start", "middle", "end"):
        assert tightest(found) > 45
        assert pen.away(found) < 2e-3


def test_a_spiral_without_a_length_is_passed_over(tmp_path: Path) -> None:
    pen = Pen().line(30).tiny(0.0, 0.0, '<spiral curvStart="0" curvEnd="0.5"/>')
    pen.tiny(6e-5, 0.0, '<spiral curvStart="126" curvEnd="-247"/>').line(30)
    found = pen.read(tmp_path)
    assert found.remarks == ()
    assert found.road.length == pytest.approx(60, abs=1e-3)


def test_a_tight_spiral_of_a_few_centimetres_is_a_kink(tmp_path: Path) -> None:
    """As tools leave them where two bends do not quite meet: 3.8 cm that turn by 15 degrees."""
    pen = Pen().line(22)
    pen.tiny(0.0377, 0.0, '<spiral curvStart="0.11" curvEnd="13.8553"/>')
    pen.x += 0.0377
    found = pen.line(30, math.radians(15)).read(tmp_path)
    assert found.remarks[0].startswith(f"{ROUNDED} (1 kink of 15.0 degrees (at s = 22.0), at most")
    assert tightest(found) > 8
    assert pen.away(found) < 0.2


@pytest.mark.parametrize("degrees", [0.2, 3.0, 12.0, 40.0])
def test_what_is_told_of_a_kink_is_measured(tmp_path: Path, degrees: float) -> None:
    pen = Pen(3, 4, 0.7).line(40).line(50, math.radians(degrees))
    found = pen.read(tmp_path)
    away = pen.away(found)
    assert away < 0.05 + 0.013 * degrees
    if degrees < 0.5:
        assert found.remarks == ()
        assert tightest(found) > 200
        return
    (remark,) = found.remarks
    assert remark.startswith(f"{ROUNDED} (1 kink of {degrees:.1f} degrees (at s = 40.0), at most")
    told = float(re.findall(r"at most ([\d.]+) m from the file's line", remark)[0])
    assert told == pytest.approx(away, abs=0.011)
    assert tightest(found) > 1 / (2 * math.radians(degrees) / 5)  # twice as tight as an arc over 5 m


@pytest.mark.parametrize(("aside", "least"), [(0.0005, 500), (0.005, 300), (0.05, 60), (0.25, 12)])
def test_a_gap_becomes_no_wriggle(tmp_path: Path, aside: float, least: float) -> None:
    pen = Pen().line(40).line(50, aside=aside)
    found = pen.read(tmp_path)
    assert tightest(found) > least
    assert pen.away(found) < aside + 0.002  # brute force sees 1 mm
    if aside > 0.01:
        assert found.remarks[0].startswith(f"{ROUNDED} (1 gap of {aside:.2f} m (at s = 40.0)")
        told = float(re.findall(r"at most ([\d.]+) m from", found.remarks[0])[0])
        assert told == pytest.approx(pen.away(found), abs=0.007)
    else:
        assert found.remarks == ()


@st.composite
def pens(draw: st.DrawFn) -> Pen:
    """Lines and arcs with misses of every size between them, and tiny elements."""
    pen = Pen(draw(st.floats(-1e6, 1e6)), draw(st.floats(-1e6, 1e6)), draw(st.floats(-3, 3)))
    for _ in range(draw(st.integers(1, 12))):
        match draw(st.sampled_from(["line", "arc", "tiny"])):
            case "line":
                pen.line(draw(st.floats(0.01, 40)), draw(st.floats(-0.3, 0.3)), draw(st.floats(-0.05, 0.05)))
            case "arc":
                pen.arc(draw(st.floats(0.01, 40)), draw(st.floats(-0.08, 0.08)))
            case _:
                pen.tiny(draw(st.floats(1e-9, 9e-4)), draw(st.floats(-3, 3)))
    return pen.line(5)


@given(pens())
@settings(max_examples=12, deadline=None)
def test_any_line_is_read_or_refused_in_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, pen: Pen
) -> None:
    try:
        found = pen.read(tmp_path_factory.mktemp("any"))
    except UsageError:
        return
    away = pen.away(found)
    told = [float(m) for remark in found.remarks for m in re.findall(r"at most ([\d.]+) m from", remark)]
    assert away < (told[0] if told else 0.0) + 0.02


def test_a_gap_of_half_a_metre_is_no_road(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"its line jumps by 0\.50 m at s = 40\.0; correct the file"):
        Pen().line(40).line(50, aside=0.5).read(tmp_path)
