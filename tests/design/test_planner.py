from collections.abc import Iterator
from functools import cache
from math import inf, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from design import short_searches as briefly
from roadgpt import check
from roadgpt.brief.model import Brief, Clause, at_least, at_most, exactly
from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.design.designers.planner import Planner
from roadgpt.errors import DesignError
from roadgpt.road import CrossSection, Design, Limits, Site, World, build, read_design
from roadgpt_sbft.validator import sbft_verdict
from strategies import briefs, sensible_briefs, worlds
from tables import rows

planner = Planner()
WORLD = World()


def turns(count: int, kind: str = "turn", **promises) -> Clause:
    return Clause(kind=kind, count=exactly(count), **promises)


A_ROAD = Brief()
UPHILL = Brief(clauses=(turns(3),), slope="up")
ENDS_LEFT = Brief(
    clauses=(turns(2, slope="up"), Clause(kind="straight", slope="down"), turns(1, side="left"))
)
EVALUATION = {"a road": A_ROAD, "uphill": UPHILL, "ends left": ENDS_LEFT}


@pytest.fixture(scope="module", autouse=True)
def short_searches() -> Iterator[None]:
    """Nearly all tests want roads, and the others any advice."""
    with briefly.short_searches():
        yield


@cache
def campaign(brief: Brief, count: int) -> list[Design]:
    out: list[Design] = []
    for number in range(count):
        out.append(planner.draft(brief, WORLD, (), out, 7 + number))
    return out


def attempt(brief: Brief, world: World, seed: int) -> Design | str:
    """A Design, or the sentence that says why there is none."""
    try:
        return planner.draft(brief, world, (), (), seed)
    except DesignError as error:
        return str(error)


def assert_fine(design: Design, brief: Brief, world: World) -> None:
    road = build(design)
    assert check.inspect(road, brief, world) == ()
    assert sbft_verdict(road.control_points(), world.site.map_size) == (True, "")
    assert all(abs(segment.turn_degrees) <= 70 for segment in design.segments)
    assert all(abs(segment.incline) <= 15 for segment in design.segments)
    assert read_design(design.to_json()) == (design, ())


@settings(max_examples=15, deadline=None)
@given(sensible_briefs(), st.integers(0, 10**9))
def test_what_can_be_had_is_drafted(brief: Brief, seed: int) -> None:
    assert_fine(planner.draft(brief, WORLD, (), (), seed), brief, WORLD)


@settings(max_examples=settings.default.max_examples // 3, deadline=None)
@given(briefs(), worlds(), st.integers(0, 1000))
def test_any_brief_gives_a_fine_road_or_one_sentence_of_advice(brief: Brief, world: World, seed: int) -> None:
    drafted = attempt(brief, world, seed)
    if isinstance(drafted, Design):
        assert_fine(drafted, brief, world)
    else:
        assert "; " in drafted
        assert "\n" not in drafted
        assert not any(odd in drafted.split() for odd in ("inf", "-inf", "nan", "None"))


@pytest.mark.parametrize("name", EVALUATION)
def test_roads_of_one_prompt_are_fine_and_look_every_way(name: str) -> None:
    brief = EVALUATION[name]
    designs = campaign(brief, 28)
    for design in designs:
        assert_fine(design, brief, WORLD)
    assert {int(design.theta // 45) for design in designs} == set(range(8))
    starts = np.array([design.starting_point[:2] for design in designs])
    assert (np.ptp(starts, axis=0) > WORLD.site.map_size / 2).all()


def test_what_words_leave_open_is_drawn_widely() -> None:
    found = [
        measure(build(design).centreline()) for brief in EVALUATION.values() for design in campaign(brief, 40)
    ]
    drawn = [turn for one in found for turn in one.turns]
    radii = np.quantile([turn.radius for turn in drawn], [0, 0.1, 0.5, 0.9])
    assert radii[0] < 17
    assert radii[1] < 22
    assert 25 < radii[2] < 50
    assert radii[3] > 70
    angles = np.array([turn.degrees for turn in drawn])
    assert angles.min() < 33
    assert angles.max() > 110
    assert len({len(one.turns) for one in found[:40]}) >= 4
    assert 0.35 < np.mean([turn.side == "left" for turn in drawn]) < 0.65
    assert all(3 <= one.grade <= 12 for one in found[40:80])


def test_the_same_arguments_give_the_same_design() -> None:
    earlier = campaign(UPHILL, 3)
    one, other = (Planner().draft(UPHILL, WORLD, (), earlier, 99) for _ in range(2))
    assert one == other
    assert Planner().draft(UPHILL, WORLD, (), earlier, 100) != one
    assert Planner().draft(UPHILL, WORLD, ("turn 1 is too tight",), earlier, 99) != one


@pytest.mark.parametrize(
    "line",
    rows(__file__, "straights_of_different_grades_keep_their_lengths_and_grades"),
)
def test_straights_of_different_grades_keep_their_lengths_and_grades(line: str) -> None:
    for seed in range(3):
        brief = read_plan(line)
        assert_fine(planner.draft(brief, WORLD, (), (), seed), brief, WORLD)


# the shorter and steeper, the slower: parabolas of v^2 / 3 m/s^2 have to fit
RAMPS = [(25, 12, 30), (40, 10, 70), (40, 14, 50), (30, 8, 70), (60, 12, 70)]


@pytest.mark.parametrize(("length", "percent", "kmh"), RAMPS)
@pytest.mark.parametrize("way", ["up", "down"])
def test_a_short_ramp_between_level_straights_is_as_steep_as_asked(
    length: int, percent: int, kmh: float, way: str
) -> None:
    world = World(limits=Limits(speed_limit=kmh / 3.6))
    brief = read_plan(
        f"straight flat len=30; straight {way} len={length} pct={percent}; straight flat; turn left"
    )
    for seed in range(2):
        points = build(draft(brief, world, seed=seed)).centreline()
        s = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points[:, :2], axis=0).T))])
        z = np.interp(np.arange(0, s[-1]), s, points[:, 2])
        over_ten = 10.0 * (z[10:] - z[:-10]) * (1 if way == "up" else -1)  # percent
        assert over_ten.max() == pytest.approx(percent, abs=1.01)
        steep = np.flatnonzero(over_ten >= 1.0)
        assert len(steep) == pytest.approx(length, rel=0.15, abs=2)  # one climb, as long as asked
        assert steep[-1] - steep[0] == len(steep) - 1


ADVICE = [
    (Brief(clauses=(turns(20, "hairpin"),)), "20 hairpins do not fit on a 250 m map.*--map-size"),
    (Brief(clauses=(turns(8, "hairpin", side="left"),)), "8 hairpins do not fit"),
    (Brief(clauses=(turns(6),), length=exactly(60)), "^6 turns do not fit into a road of 54 to 66 m"),
    (Brief(climb=exactly(150)), "a climb of 127.5 to 172.5 m does not fit"),
    (Brief(clauses=(turns(1, radius=exactly(8)),)), "tighter than the 14.33 m"),
    (
        Brief(clauses=(turns(1, "hairpin"),), radius=at_least(50)),
        "radius asked for does not go with a hairpin",
    ),
    (Brief(turns=exactly(2), left=exactly(2), right=exactly(1)), "2 to the left and 1 to the right"),
    (Brief(clauses=(turns(2, side="left"),), right=exactly(1)), "sides asked for the 2 turns contradict"),
    (Brief(clauses=(turns(1, slope="down"),), slope="up"), "contradicts a road that is uphill all the way"),
    (Brief(clauses=(turns(1, slope="steeply_up"),), steepest=exactly(3)), "steeper than the 4 % that"),
    (
        Brief(slope="steeply_up", steepest=at_most(4)),
        "of 8 to 15 % is steeper than the 4 % that it may have",
    ),
    (Brief(clauses=(turns(2),), turns=exactly(3)), "asked for 3 turns, and for 2 at most"),
    (Brief(clauses=(turns(1, degrees=exactly(5)),)), "not seen as a turn"),
]


@pytest.mark.parametrize(("brief", "sentence"), ADVICE)
def test_wishes_that_cannot_be_met_get_advice(brief: Brief, sentence: str) -> None:
    with pytest.raises(DesignError, match=sentence):
        planner.draft(brief, WORLD, (), (), 1)


ODD_WORLDS = [
    World(site=Site(map_size=60)),
    World(site=Site(map_size=2000)),
    World(section=CrossSection(lane_width=6)),
    World(section=CrossSection(lane_width=2.5, shoulder=0)),
    World(limits=Limits(min_radius=40)),
    World(limits=Limits(max_grade=0.06)),
    World(site=Site(z_floor=100)),
    World(limits=Limits(min_length=150)),
]


@pytest.mark.parametrize("world", ODD_WORLDS)
def test_other_worlds_have_roads_too(world: World) -> None:
    for brief in (A_ROAD, Brief(clauses=(turns(2),), slope="gently_up")):
        assert_fine(planner.draft(brief, world, (), (), 1), brief, world)


def test_the_map_that_is_advised_is_large_enough() -> None:
    brief = Brief(length=exactly(1900))
    sentence = "a length of 1710 to 2090 m does not fit on a 250 m map.*--map-size"
    with pytest.raises(DesignError, match=sentence) as caught:
        planner.draft(brief, WORLD, (), (), 1)
    world = World(site=Site(map_size=float(str(caught.value).split("--map-size ")[1])))
    assert_fine(planner.draft(brief, world, (), (), 1), brief, world)


def test_the_longest_turns_keep_one_radius_through_all_their_segments() -> None:
    design = planner.draft(Brief(clauses=(turns(1, "u_turn", side="left"),)), WORLD, (), (), 3)
    parts = [segment for segment in design.segments if segment.turn_degrees]
    assert len(parts) == 3
    radius = parts[0].radius or inf
    s = np.arange(0.0, build(design).length, 0.25)
    bend = build(design).curvature(s)
    assert bend.max() == pytest.approx(1 / radius, rel=1e-3)
    arc = (bend > 0.999 / radius).sum() * 0.25
    swept = radians(sum(part.turn_degrees for part in parts))
    assert arc == pytest.approx(radius * swept - (parts[0].transition or 0), abs=1.0)


@pytest.mark.parametrize("seed", [1, 3])
@pytest.mark.parametrize(
    ("line", "degrees"),
    [
        ("straight up; turn right 90; straight down", [90]),
        ("straight down; turn left 130; straight up", [130]),
        ("straight up; hairpin left 170; straight down", [170]),
        ("straight 60 up pct=8; turn right 60 r25; straight 60 down pct=8", [60]),
        ("straight up; turn right 45; turn left 70; straight down", [45, 70]),
    ],
)
def test_a_turn_between_slopes_is_one_turn_of_its_angle(line: str, degrees: list[float], seed: int) -> None:
    """The turn itself has no slope that was asked for, and joins those of its neighbours."""
    design = draft(read_plan(line), World(), seed=seed)
    found = measure(build(design).sample().points)
    assert [turn.degrees for turn in found.turns] == pytest.approx(degrees, rel=0.12)
    assert sum(abs(segment.turn_degrees) for segment in design.segments) == pytest.approx(
        sum(degrees), rel=0.12
    )


@pytest.mark.parametrize("line", ["crest x3", "crest x3.. | hills=3..", "crest; crest; crest"])
def test_crests_that_are_counted_are_all_there(line: str) -> None:
    for seed in range(3):
        heights = build(draft(read_plan(line), World(), seed=seed)).sample().points[:, 2]
        ways = np.sign(np.diff(heights)[np.abs(np.diff(heights)) > 1e-3])
        assert np.count_nonzero(ways[1:] != ways[:-1]) == 5  # up, down, three times
