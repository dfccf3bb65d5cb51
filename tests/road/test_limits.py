"""Limits are the same for whoever writes, clamps or checks: what is written is read again.

Values beyond, at and just below each limit go into OpenDRIVE and into road files, and from there on. Each
comes back as it was, or as the limit with a sentence that names value and place, or it is refused in such a
sentence.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from roadgpt.errors import UsageError
from roadgpt.export import save
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.network import read_opendrive, read_source
from roadgpt.road import Profile, Road, World
from roadgpt.road.profile import STEEPEST, WIDEST

LENGTH = 110.0
FILE = """<OpenDRIVE><road id="1"><planView>
<geometry s="0" x="20" y="30" hdg="0" length="110"><line/></geometry></planView>{}
<lanes><laneSection s="0"><center><lane id="0"/></center><right>
<lane id="-1" type="driving">{}</lane>{}</right></laneSection></lanes></road></OpenDRIVE>"""


def near(limit: float, span: float) -> st.SearchStrategy[float]:
    """Values far beyond a limit, a hair beyond it, at it, a hair below, and well below."""
    hairs = st.sampled_from([0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 2e-6, 1e-3])
    beside = st.builds(lambda hair, sign: limit + sign * hair, hairs, st.sampled_from([-1, 1]))
    return st.one_of(beside, st.floats(limit, limit + span), st.floats(limit - min(span, limit), limit))


def swelling(name: str, station: str, low: float, high: float, ramp: float) -> str:
    """Cubics that go from one value to another and back, as RoadGPT's own smooth changes do."""
    cubics = CubicProfile.smooth([(0.0, low), (ramp, high), (LENGTH - ramp, low), (LENGTH, low)])
    rows = [(s, *row) for s, row in cubics.rows]
    return "".join(
        f'<{name} {station}="{s!r}" a="{a!r}" b="{b!r}" c="{c!r}" d="{d!r}"/>' for s, a, b, c, d in rows
    )


def told_and_read(folder: Path, rest: str, lane: str, more: str = "") -> tuple[str, Road, Road]:
    """The remarks on a file, its road, and the road after it was written and read as a road file."""
    path = folder / "limits.xodr"
    path.write_text(FILE.format(rest, lane, more))
    found = read_opendrive(path)
    (folder / "limits.json").write_text(json.dumps(found.road.to_json()))
    again = read_source(folder / "limits.json").blueprint
    assert isinstance(again, Road)
    assert again.to_json() == found.road.to_json()
    return " ".join(found.remarks), found.road, again


WIDTH = '<width sOffset="0" a="3.5"/>'
S = np.linspace(0.0, LENGTH, 400)


@given(near(STEEPEST, 1.2), st.floats(5, 50), st.sampled_from([-1, 1]))
@example(0.92, 50.0, -1)
@settings(max_examples=20, deadline=None)
def test_superelevation(
    tmp_path_factory: pytest.TempPathFactory, most: float, ramp: float, side: int
) -> None:
    folder = tmp_path_factory.mktemp("bank")
    bank = swelling("superelevation", "s", 0.0, side * most, ramp)
    said, road, _ = told_and_read(folder, f"<lateralProfile>{bank}</lateralProfile>", WIDTH)
    angle = road.profile.superelevation(S) if road.profile else np.zeros(len(S))
    assert np.abs(angle).max() <= STEEPEST + 1.01e-6
    is_told = "its superelevation" in said
    assert is_told == (most > STEEPEST + 1e-6) or abs(most - STEEPEST - 1e-6) < 1e-9
    if is_told:
        assert f"({math.degrees(side * most):.4g} degrees at s = {ramp:.4g} m" in said
    *_, path = save(road, folder, ["opendrive"], World(), "again")
    again = read_opendrive(path)
    assert "superelevation" not in " ".join(again.remarks)
    assert again.road.profile is not None or not angle.any()
    if again.road.profile is not None:
        assert again.road.profile.superelevation(S) == pytest.approx(angle, abs=1e-9)


@given(near(WIDEST, 60.0), st.floats(5, 50))
@settings(max_examples=20, deadline=None)
def test_width_of_a_shoulder(tmp_path_factory: pytest.TempPathFactory, most: float, ramp: float) -> None:
    folder = tmp_path_factory.mktemp("width")
    wide = swelling("width", "sOffset", 1.0, most, ramp)
    said, road, _ = told_and_read(folder, "", WIDTH, f'<lane id="-2" type="shoulder">{wide}</lane>')
    assert road.profile is not None
    assert road.profile.right[1].width.extremes()[1] <= WIDEST + 1.01e-6  # type: ignore[union-attr]
    assert (f"the width of a lane is limited (lane -2: {most:.4g} m at s = {ramp:.4g} m" in said) == (
        most > WIDEST + 1e-6
    ) or (abs(most - WIDEST - 1e-6) < 1e-9)


@given(st.one_of(near(2.0, 1.9), near(10.0, 8.0)), st.floats(5, 50))
@settings(max_examples=20, deadline=None)
def test_width_of_the_driven_lane(tmp_path_factory: pytest.TempPathFactory, some: float, ramp: float) -> None:
    folder = tmp_path_factory.mktemp("lane")
    said, road, _ = told_and_read(folder, "", swelling("width", "sOffset", 3.5, some, ramp))
    profile = road.profile
    assert profile is not None
    assert 2 - 1.01e-6 <= profile.width(S).min() <= profile.width(S).max() <= 10 + 1.01e-6
    excess = max(2.0 - some, some - 10.0)
    assert (f"the width of the driven lane is limited ({some:.4g} m at s = {ramp:.4g} m" in said) == (
        excess > 1e-6
    ) or (abs(excess - 1e-6) < 1e-9)


@given(st.floats(0, 3), st.floats(-2, 9))
@settings(max_examples=20, deadline=None)
def test_rows_that_a_file_holds_are_refused_with_value_and_place(excess: float, ramp: float) -> None:
    """A road file that somebody wrote: its limits are those at which OpenDRIVE is clamped."""
    most = STEEPEST + 10.0**-ramp * excess
    angle = CubicProfile.smooth([(0.0, 0.0), (40.0, most), (LENGTH, 0.0)])
    profile = Profile.of(1, 1, 3.5, 1.0, angle)
    road = Road(PieceCurve(20.0, 30.0, 0.0, (Piece(LENGTH),)), GradeProfile.level(LENGTH), profile=profile)
    if most > STEEPEST + 1e-6:
        with pytest.raises(UsageError, match=rf"a value is {most:g} at s = 40 m, beyond 0\.35"):
            Road.from_json(road.to_json())
    else:
        assert Road.from_json(road.to_json()).to_json() == road.to_json()


@given(
    st.one_of(near(2.0, 1.5), st.floats(0.01, 2.0)),
    st.one_of(near(300 / 3.6, 9.0), near(5 / 3.6, 1.0)),
    st.one_of(near(2.0, 1.0), near(10.0, 5.0)),
)
@settings(max_examples=20, deadline=None)
def test_the_world_of_an_export_comes_back_or_is_limited_in_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, friction: float, speed: float, width: float
) -> None:
    """A World may be beyond the limits of options and files in its speed and its width."""
    world = World().changed(friction=min(friction, 2.0), speed_limit=speed, lane_width=width)
    road = Road(PieceCurve(20.0, 30.0, 0.0, (Piece(LENGTH),)), GradeProfile.level(LENGTH))
    *_, path = save(road, tmp_path_factory.mktemp("world"), ["opendrive"], world)
    source, said = read_source(path), " ".join(read_source(path).remarks)
    assert source.world["friction"] == pytest.approx(min(friction, 2.0), abs=1e-9)
    for what, name, value, low, high in (
        ("speed limit", "speed_limit", speed, 5 / 3.6, 300 / 3.6),
        ("width of the driven lane", "lane_width", width, 2.0, 10.0),
    ):
        back = source.world.get(name) or float(source.blueprint.profile.width(9.0))  # type: ignore[union-attr]
        assert back == pytest.approx(min(max(value, low), high), abs=1.1e-6)
        assert (what in said) or abs(back - value) < 1.1e-6
        assert (what not in said) or back in (pytest.approx(low), pytest.approx(high))


def test_the_worlds_of_files_and_of_options_have_the_same_limits(tmp_path: Path) -> None:
    """At each limit that a file is clamped to, the option of the command takes the same number."""
    from roadgpt.cli.options import WORLD
    from roadgpt.road.world import FRICTIONS, LANE_WIDTHS, SPEEDS

    fields = {each.field: each for each in WORLD}
    for name, (low, high) in {
        "speed_limit": SPEEDS,
        "friction": FRICTIONS,
        "lane_width": LANE_WIDTHS,
    }.items():
        option = fields[name]
        for value, is_allowed in (
            (high, True),
            (high * 1.01, False),
            (low, low > 0),
            (low * 0.99 - 0.01, False),
        ):
            try:
                option.type.convert(str(round(value * option.unit, 6)), None, None)
            except Exception:
                assert not is_allowed, (name, value)
            else:
                assert is_allowed, (name, value)
