"""The catalogue of scenarios against what was written of it before it was built, in catalogue.json and
roads.json: names, parameters and grids, what an outside judge sees in the exported files, and on which roads
they can happen."""

import json
import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from shapely import LineString, Point, Polygon

from boxed import corners
from outside_judge import traffic_referee
from prescribed import OF_NCAP, OURS
from roadgpt.brief.beside import friction_of
from roadgpt.brief.model import Brief, mirrored, mirrored_scene
from roadgpt.brief.plan import read_plan, read_scene
from roadgpt.brief.scenarios import LANE_WIDTH, MISSING, chosen, points_of, scenario, scenarios
from roadgpt.brief.scene import Scene
from roadgpt.brief.scene_fit import fitted
from roadgpt.errors import UsageError
from roadgpt.road import World
from roadgpt.run import Run, Setup, perform
from roadgpt.run.exporting import export
from roadgpt.traffic.actor import SIZES

HERE = Path(__file__).parent
WRITTEN: dict[str, Any] = json.loads((HERE / "catalogue.json").read_text())
CATALOGUE: list[dict[str, Any]] = WRITTEN["scenarios"]
ROADS: list[dict[str, Any]] = json.loads((HERE / "roads.json").read_text())["roads"]
BY_NAME = {entry["name"]: entry for entry in CATALOGUE}
FIRST = [name for name, entry in BY_NAME.items() if "grid" in entry]
"""Those of which parameters, grid, and the roads on which they fit were written before, too."""
OF_THE_JUNCTION = {"turn radius"}
"""What the nominal junction has of its own."""
TOLD = {"parked", "places", "distance"}
"""Places that the catalogue tells in words."""
RENAMED = {"from": "start", "to": "end"}
SAMPLE = (
    "ncap:CCRb", "ncap:CCFtap", "ncap:CPNCO", "ncap:CBLA", "r157:cut_in", "r157:cut_out_fully_blocking",
    "leaderboard:control_loss", "nhtsa:straight_crossing_paths",
    "ncap:CCFhol", "ncap:CPTA", "ncap:CC_ELK_On", "ncap:CCFtap_SfS", "ncap:CPMFC", "ncap:ACC_cut_in",
    "r157:lane_change_two_vehicles", "r79:C_lane_change", "r152:false_reaction_cars",
    "leaderboard2:opposite_vehicle_taking_priority", "leaderboard2:static_cut_in",
    "nhtsa:running_red_light", "nhtsa:backing_up_into_vehicle",
)  # fmt: skip


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    return traffic_referee()


def made(name: str, drives: bool, left_hand: bool = False) -> Run:
    setup = Setup(driver="robot", scenario=name, drives=drives)
    brief = read_plan(scenario(name).plan)
    brief = mirrored(brief) if left_hand else brief
    return perform(brief, 1, World().changed(lane_width=LANE_WIDTH), setup)


def points(blocks: list[dict[str, list[Any]]], dropped: set[str]) -> int:
    """How many points a grid has, counted from its blocks alone."""
    count = 0
    for block in blocks:
        size = 1
        for name, values in block.items():
            size *= 1 if name in dropped else len(values)
        count += size
    return count


def test_all_that_was_planned_is_there_in_its_order() -> None:
    assert [*scenarios()] == [entry["name"] for entry in CATALOGUE]
    assert [*MISSING] == WRITTEN["not possible"]
    for name, row in MISSING.items():
        with pytest.raises(UsageError, match=f"^{name} is not possible: {row.impossible}"):
            chosen(name)


def test_tolerances_are_those_of_the_sources_or_ours() -> None:
    """Euro NCAP's, and ours, as ``prescribed.py`` has them."""
    numbers = [float(each.partition(" ")[0]) for each in scenario("ncap:ELK_RE").tolerances.values()]
    assert numbers[:3] == [OF_NCAP["ego"], OF_NCAP["aside"], OF_NCAP["past"]]
    assert numbers[3:6] == [OF_NCAP["gap"], OF_NCAP["apart"], OF_NCAP["released"]]
    assert numbers[6:] == [OURS[each] for each in ("km/h", "m", "m/s", "m/s2", "s", "")]
    assert [*scenario("r157:cut_in").tolerances] == [*scenario("ncap:ELK_RE").tolerances][6:]


@pytest.mark.parametrize("name", FIRST)
def test_a_scenario_has_the_parameters_and_the_grid_that_were_written_before(name: str) -> None:
    made, entry = scenarios()[name], BY_NAME[name]
    for key, (value, _) in entry["parameters"].items():
        if key not in OF_THE_JUNCTION | TOLD:
            assert made.values[RENAMED.get(key, key).replace(" ", "_")] == value
    assert made.says.startswith(entry["says"])
    assert made.source == entry["source"]
    if not {*entry["parameters"]} & {"places"}:
        assert points([*made.grid], set()) == points(entry["grid"], OF_THE_JUNCTION)


@pytest.mark.parametrize("name", BY_NAME)
def test_each_is_a_scene_and_what_the_command_line_takes_is_what_it_tells(name: str) -> None:
    one = scenarios()[name]
    scene = one.onto(Scene())
    assert scene.speed is not None or scene.parks
    assert str(scenario(name)) == name
    faster = scenario(f"{name} ego=31")
    assert str(faster) == f"{name} ego=31"
    if not scene.parks:
        assert faster.onto(Scene()).speed == read_plan("straight && ego v=31").scene.speed
    assert [*map(str, chosen(str(faster)))] == [str(faster)]


@pytest.mark.parametrize("name", sorted({*BY_NAME} - {*FIRST}))
def test_every_point_of_a_grid_is_a_scene(name: str) -> None:
    every = [*scenario(name).points("standard", True)]
    for point in every[:: len(every) // 8 or 1]:
        assert point.onto(Scene())
        assert read_plan(point.plan)


def test_a_grid_keeps_what_was_given_and_its_points_are_read_back_as_they_are() -> None:
    fixed = scenario("r157:cut_in ego=60 lane=left gap=20 acceleration=0")
    assert str(fixed) == "r157:cut_in ego=60 lane=left gap=20 acceleration=0"
    found = [each.values for each in fixed.points("standard", True)]
    assert len(found) == 5 * 5 * 6  # models, slower by, lateral speeds
    assert {(each["ego"], each["lane"], each["gap"], each["acceleration"]) for each in found} == {
        (60, "left", 20, 0)
    }
    for one in scenarios().values():
        every = [*one.points("standard", True)]
        for point in every[:: len(every) // 5 or 1]:
            assert scenario(str(point)).values == point.values


def test_points_of_a_grid_with_speeds_below_0_are_left_out() -> None:
    every = points(BY_NAME["r157:cut_in"]["grid"], set())
    slow = [(ego, less) for ego in range(20, 70, 10) for less in range(10, 60, 10) if ego < less]
    found, left_out = points_of("r157:cut_in", "standard", True)
    assert left_out == every * len(slow) // 25
    assert len(found) == every - left_out
    assert min(float(each.values["ego"]) - float(each.values["slower"]) for each in found) == 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("r157:cutin", "did you mean 'r157:cut_in'"),
        ("cut_in", ":cut_in"),
        ("r157:cut_in slow=3", "did you mean 'slower'"),
        ("r157:cut_in gap=far", "'gap' of r157:cut_in is a number"),
        ("r157:cut_in lane=up", "left"),
        ("r157:cut_in slower=70", "from 0 to 250"),
        ("r157:cut_in ego=20 slower=50", "^r157:cut_in: ego=20 slower=50 lead to a speed of -30 km/h"),
        ("ncap:CPLA target=0", "divided by 0"),
        ("r157:cut_in gap", "write for example"),
        ("ncap:*", "name one"),
        ("", "no scenario is named"),
    ],
)
def test_what_is_no_scenario_gets_one_sentence_with_the_nearest(text: str, said: str) -> None:
    with pytest.raises(UsageError, match=said.replace("(", r"\(")):
        scenario(text)


def test_weather_and_traffic_join_a_scenario_and_contradictions_do_not() -> None:
    one = scenario("nhtsa:animal_no_maneuver")
    both = one.onto(read_plan("straight && light; fog 60").scene)
    assert (both.flow, both.light, both.actors) == ("light", "night", one.onto(Scene()).actors)
    assert one.onto(both) == both
    for other in ("low_sun", "car ahead", "ego v=20", "ego: stop s=20"):
        with pytest.raises(UsageError, match="contradict each other"):
            one.onto(read_plan(f"straight && {other}").scene)


@pytest.mark.parametrize("number", range(len(ROADS)))
def test_a_scenario_asks_nothing_of_a_road_on_which_it_can_happen_that_the_words_exclude(number: int) -> None:
    road = ROADS[number]
    brief, unfit = read_plan(road["plan"]), road["fits"]["all but"]
    for name, one in scenarios().items():
        if name in FIRST and name not in unfit:
            needed = fitted(brief, one.onto(Scene()), 70 / 3.6)
            assert fitted(needed, one.onto(Scene()), 70 / 3.6) == needed


@pytest.mark.parametrize("surface", ["ice", "snow"])
def test_the_tested_car_can_stop_on_the_surface_where_there_is_room(surface: str) -> None:
    v, happens = 50 / 3.6, "ego v=50; car ahead gap=40 v=50: brake 3"
    dry, slippery = read_scene(happens), read_scene(f"{happens}; {surface}")
    least = [fitted(Brief(), scene, v).length.lo for scene in (dry, slippery)]
    more = v**2 / 2 * (1 / 9.81 / friction_of([surface]) - 1 / 4.0)
    assert least[1] - least[0] == pytest.approx(more, abs=10)  # lengths are multiples of 10 m
    short = fitted(read_plan("| len=200"), slippery, v).length
    assert short.hi == 200


@pytest.mark.parametrize(
    ("plan", "name", "said"),
    [
        ("straight 100", "ncap:CCRb", "needs 1[0-9]0 m of road"),
        ("| lanes=1", "r157:cut_out_fully_blocking", "two lanes"),
        ("crossroads right", "ncap:CCFtap", "goes left at the junction"),
        ("crossroads straight stop", "leaderboard:red_light_runner", "needs lights"),
        ("straight 60; hairpin left", "nhtsa:animal_no_maneuver", "before bends"),
    ],
)
def test_words_that_exclude_a_scenario_are_refused_in_one_sentence(plan: str, name: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        fitted(read_plan(plan), scenario(name).onto(Scene()), 70 / 3.6)


def test_silent_words_get_lanes_a_way_and_wide_bends() -> None:
    def asked(plan: str, name: str) -> Any:
        return fitted(read_plan(plan), scenario(name).onto(Scene()), 70 / 3.6)

    assert asked("turn x3", "r157:cut_in").lanes.lo == 2
    assert asked("crossroads", "ncap:CCFtap").junctions[0].take == "left"
    # also before a junction behind which there is road enough
    way = asked("t_junction stop // straight 200", "r157:side_vehicle").stretches[0]
    assert way.radius.lo == pytest.approx(123, abs=1)  # AASHTO for 60 km/h and a superelevation of 6 %
    assert asked("crossroads straight", "leaderboard:red_light_runner").junctions[0].control == "lights"
    # AASHTO has 252 m for 80 km/h, and bends that are asked for can be of 250 m
    assert asked("turn x3", "nhtsa:lead_vehicle_slower").clauses[0].radius.lo == 250
    assert asked("", "nhtsa:lead_vehicle_slower").radius.lo == pytest.approx(252, abs=1)
    # where there is no room for them, 80 km/h at 6 m/s2 sideways
    short = asked("turn left 90; turn right 90 | len=400", "nhtsa:lead_vehicle_slower")
    assert short.clauses[0].radius.lo == pytest.approx(82.3, abs=1)


@pytest.mark.parametrize(
    "plan",
    [
        "straight | lanes=2 against=2 && ego v=50; adult crossing left v=5",
        "straight | lanes=3 against=3 divided && ego v=50; child crossing left",
        "straight | lanes=3 against=1 left_hand && ego v=40; adult crossing right v=2..4",
    ],
)
def test_a_road_is_long_enough_for_who_comes_from_beyond_all_of_its_lanes(plan: str) -> None:
    run = perform(plan, 1, setup=Setup(driver="robot", reader="plan"))
    assert run.description.startswith("hit "), run.description


def test_the_tested_car_has_the_lanes_beside_it_that_the_scene_names() -> None:
    run = made("r157:cut_in_unavoidable_collision", drives=False)
    assert run.road is not None
    profile, s = run.world.profile_of(run.road), 50.0
    left, right = profile.lane(s)
    edges = profile.edges(s)
    assert right - edges.right == pytest.approx(LANE_WIDTH)
    assert left - right == pytest.approx(LANE_WIDTH)


@pytest.mark.parametrize("name", SAMPLE)
def test_an_outside_judge_finds_the_scenario_in_the_exported_files(name: str, referee: ModuleType) -> None:
    run = made(name, drives=True)
    with tempfile.TemporaryDirectory() as folder:
        export(run, folder, ["opendrive", "openscenario"], lambda said: None)
        holds, measured = referee.check(f"{folder}/road.drive.xosc", BY_NAME[name]["truth"])
    assert all(holds.values()), (holds, run.description, measured["outcome"])


@pytest.mark.parametrize("name", ["ncap:CCFtap", "r157:lateral_detection_range"])
def test_with_traffic_on_the_left_everybody_moves_as_in_the_mirror_image(name: str) -> None:
    # a turn at a junction; places, offsets and drifts sideways
    plain, other = made(name, drives=True), made(name, drives=True, left_hand=True)
    assert plain.drive is not None
    assert plain.drive.others is not None
    assert other.drive is not None
    assert other.drive.others is not None
    assert other.outcome == plain.outcome
    (x, y, *_), (across, along, *_) = plain.drive.others.states.T, other.drive.others.states.T
    assert np.nanmax(abs(across - x)) < 0.01
    assert np.nanmax(along + y) - np.nanmin(along + y) < 0.01


@pytest.mark.parametrize("name", ["ncap:CC_ELK_On", "r157:lane_change_rear_vehicle"])
def test_with_traffic_on_the_left_the_tested_car_drifts_to_the_other_side(name: str) -> None:
    aside = []
    for left_hand in (False, True):
        run = made(name, drives=True, left_hand=left_hand)
        assert run.drive is not None, run.description
        assert run.road is not None
        middle = run.world.profile_of(run.road).middle(run.drive["s"])
        aside.append((run.drive["t"] - middle)[:500])
    assert np.abs(aside[0]).max() > 0.5
    assert aside[0] == pytest.approx(-aside[1], abs=0.02)


def test_where_the_tested_car_starts_aside_is_mirrored_too() -> None:
    assert mirrored_scene(read_scene("ego t=-1 v=50")) == read_scene("ego t=1 v=50")


def test_slippery_places_let_the_tested_car_slip_there_and_nowhere_else() -> None:
    world = World().changed(scene=scenario("leaderboard:control_loss").onto(Scene()))
    at = [world.friction_at(s) for s in (13.9, 14.0, 23.9, 24.1, 48.0, 80.0, 90.0)]
    assert at == [1.0, 0.3, 0.3, 1.0, 0.3, 0.3, 1.0]


@pytest.mark.parametrize("ttc", [2.0, 3.0])
def test_who_turns_across_at_a_time_to_collision_comes_over_the_line_then(ttc: float) -> None:
    plan = f"straight 200 // crossroads straight && ego v=50; car junction opposite: turn_across ttc={ttc:g}"
    run = perform(plan, 1, World().changed(lane_width=3.5), Setup(driver="robot", reader="plan"))
    assert run.road is not None
    assert run.drive is not None
    assert run.drive.others is not None
    s = np.arange(0.0, run.road.length, 0.5)
    path = LineString(run.road.at(s, run.world.profile_of(run.road).middle(s))[:, :2])
    lane = path.buffer(3.5 / 2, cap_style="flat")
    tracks = run.drive.others
    there = ~np.isnan(tracks.states[:, 0, 0])
    boxes = (corners(state, tracks.actors[0].size) for state in tracks.states[there, 0])
    over = next(n for n, box in enumerate(boxes) if Polygon(box).intersects(lane))
    n = int(np.searchsorted(run.drive["time"], tracks.time[there][over]))
    x, y = run.drive["x"][n], run.drive["y"][n]
    crossing = LineString(tracks.states[there, 0, :2]).intersection(path)
    way = path.project(crossing) - path.project(Point(x, y)) - SIZES["car"].length / 2
    assert way / run.drive["speed"][n] == pytest.approx(ttc, abs=0.5)
