"""What sources prescribe of the scenarios, at nominal values and at ends of the grids: numbers alone,
written from Euro NCAP's standard ranges (Vector's CA-FC 2026), ASAM's set for UN R157, CARLA's leaderboard
and NHTSA's typology with FMVSS No. 127. Each number has its tolerance, and whose that is: "NCAP" (the tested
car's speed within 0.5 km/h and its path within 0.05 m, the place of impact within 0.05 m, the gap before
braking within 0.5 m, that between parked cars within 0.1 m), else "ours": 0.5 m/s (1.8 km/h), 0.5 m,
0.3 m/s2, 0.1 s, and 0.01 of a friction."""

# ruff: noqa: E501 - a table

from collections.abc import Iterator
from typing import NamedTuple

WIDTH = 1.86  # m, of the tested car; 0.05 m of it in percent are within its places of impact
OURS = {
    "km/h": 1.8, "m": 0.5, "m/s": 0.5, "m/s2": 0.3, "s": 0.1, "%": 100 * 0.05 / WIDTH, "": 0.01,
}  # fmt: skip
UNITS = {
    "ego": "km/h", "led": "km/h", "speed": "km/h", "to": "km/h", "keeps": "km/h", "keeps_own": "km/h",
    "at_first": "km/h", "rate": "m/s2",
    "sideways": "m/s", "sideways_rate": "m/s2", "headway": "s", "starts": "s", "begins": "s", "impact": "%",
    "friction": "", "released": "m/s",
}  # fmt: skip
"""Of what is measured (see ``measured.py``); all else is in metres."""
OF_NCAP = {
    "ego": 0.5,
    "aside": 0.05,
    "impact": OURS["%"],
    "past": 0.05,
    "flank": 0.05,
    "gap": 0.5,
    "apart": 0.1,
    "released": 0.05,
}


class Row(NamedTuple):
    scenario: str
    who: int
    what: str
    want: float
    tolerance: float
    whose: str


def _rows(scenario: str, ego: float, *others: dict[str, float]) -> Iterator[Row]:
    for who, each in enumerate(others or ({},)):
        for what, want in (({"ego": ego, "aside": 0.0} if who == 0 else {}) | each).items():
            is_ncap = scenario.startswith("ncap:") and what in OF_NCAP
            tolerance = OF_NCAP[what] if is_ncap else OURS[UNITS.get(what, "m")]
            yield Row(scenario, who, what, want, tolerance, "NCAP" if is_ncap else "ours")


def _ahead(speed: float, impact: float) -> dict[str, float]:
    return {"keeps": speed, "impact": impact}


def _braking(speed: float, impact: float) -> dict[str, float]:
    return {
        "at_first": speed,
        "headway": 1.0,
        "gap": speed / 3.6,
        "rate": -4.0,
        "to": 2,
        "impact": impact,
        "begins": 3,
    }


def _crossing(speed: float, impact: float, first: float, run_up: float, steady: float) -> dict[str, float]:
    return {"speed": speed, "impact": impact, "left": first, "run_up": run_up, "steady": steady}


def _longitudinal(speed: float, run_up: float, steady: float, impact: float) -> dict[str, float]:
    return {"speed": speed, "impact": impact, "run_up": run_up, "steady": steady}


def _trigger(ego: float, speed: float, run_up: float, steady: float) -> dict[str, float]:
    """The gap at which a target in the lane starts, by CBLA's formula."""
    return {"gap": ego / speed * (2 * run_up + steady) - run_up - steady}


STANDS = {"keeps": 0.0}
HIDING = STANDS | {"before": 4.8}  # m, from the parked cars to the bicycle, along the tested car's lane

PRESCRIBED: tuple[Row, ...] = tuple(
    row
    for rows in (
        _rows("ncap:CCRs", 50, _ahead(0, 50)),
        _rows("ncap:CCRs ego=10 impact=0", 10, _ahead(0, 0)),
        _rows("ncap:CCRs ego=80 impact=100", 80, _ahead(0, 100)),
        _rows("ncap:CCRm", 50, _ahead(20, 50)),
        _rows("ncap:CCRm ego=130 target=70 impact=75", 130, _ahead(70, 75)),
        _rows("ncap:CCRb", 50, _braking(50, 50)),
        _rows("ncap:CCRb ego=30 target=30 impact=25", 30, _braking(30, 25)),
        _rows("ncap:CCRb ego=80 target=80 impact=75", 80, _braking(80, 75)),
        _rows("ncap:CMRs", 50, _ahead(0, 50)),
        _rows("ncap:CMRs ego=80 impact=75", 80, _ahead(0, 75)),
        _rows("ncap:CMRb", 50, _braking(50, 25)),
        _rows("ncap:CCFhos", 50, {"keeps": 50, "impact": 50}),
        _rows("ncap:CCFhos ego=80 target=70 impact=25", 80, {"keeps": 70, "impact": 25}),
        # the other is 1.8 m, the motorcycle 0.9 m wide: that divided by the root of 2
        _rows("ncap:CCFtap", 10, {"keeps_own": 30, "front_short": 1.27}),
        _rows("ncap:CCFtap ego=20 target=60", 20, {"keeps_own": 60, "front_short": 1.27}),
        _rows("ncap:CMFtap", 10, {"keeps_own": 30, "front_short": 0.64}),
        _rows("ncap:CCCscp", 20, {"keeps_own": 20, "past": 4.7 / 4}),
        _rows("ncap:CCCscp ego=60 target=20 side=near", 60, {"keeps_own": 20, "past": 4.7 / 4}),
        _rows("ncap:CCCscp ego=20 target=60", 20, {"keeps_own": 60, "past": 4.7 / 4}),
        _rows("ncap:CMCscp", 20, {"keeps_own": 20, "flank": 0.47}),
        _rows("ncap:CMCscp ego=60 target=20 side=near", 60, {"keeps_own": 20, "flank": 0.47}),
        _rows("ncap:CMCscp ego=20 target=60", 20, {"keeps_own": 60, "flank": 0.47}),
        _rows("ncap:CPFA", 50, _crossing(8, 50, 6, 1.5, 4.5)),
        _rows("ncap:CPFA ego=10 light=night", 10, _crossing(8, 50, 6, 1.5, 4.5)),
        _rows("ncap:CPNA", 50, _crossing(5, 25, -4, 1, 3)),
        _rows("ncap:CPNA ego=60 impact=75", 60, _crossing(5, 75, -4, 1, 3)),
        # 1 m from the tested car's side to the parked cars, from their front to the child, and between them
        _rows(
            "ncap:CPNCO", 50, _crossing(5, 50, -4, 1, 3),
            STANDS | {"clear": 1 + WIDTH / 2, "before": 1, "apart": 1}, STANDS | {"clear": 1 + WIDTH / 2},
        ),
        _rows("ncap:CPLA", 50, _longitudinal(5, 1, 10, 50) | _trigger(50, 5, 1, 10)),
        _rows("ncap:CPLA ego=80 impact=25 steady_path=18", 80, _longitudinal(5, 1, 18, 25) | _trigger(80, 5, 1, 18)),
        _rows("ncap:CBLA", 50, _longitudinal(15, 3.5, 28, 50) | _trigger(50, 15, 3.5, 28)),
        _rows(
            "ncap:CBLA ego=80 target=20 impact=25 acceleration_path=6.2", 80,
            _longitudinal(20, 6.2, 28, 25) | _trigger(80, 20, 6.2, 28),
        ),
        _rows("ncap:CBNA", 50, _crossing(15, 50, -20.5, 3.5, 17)),
        _rows("ncap:CBNA ego=60 impact=75", 60, _crossing(15, 75, -20.5, 3.5, 17)),
        _rows("ncap:CBNAO", 50, _crossing(10, 50, -8, 3.5, 4.5), HIDING | {"clear": 3.55, "apart": 0.2}, HIDING),
        _rows("ncap:CBNAO ego=60 impact=75", 60, _crossing(10, 75, -8, 3.5, 4.5), HIDING, HIDING),
        _rows("ncap:CBFA", 50, _crossing(20, 50, 28, 6, 22)),
        _rows("ncap:CBFA ego=60 impact=25", 60, _crossing(20, 25, 28, 6, 22)),
        _rows("r157:free_driving", 60),
        _rows("r157:free_driving ego=40", 40),
        _rows("r157:swerving_lead_vehicle", 60, {
            "keeps": 60, "headway": 2, "most_left": 1.5, "most_right": -1.5, "sideways_rate": 0.3,
        }),
        _rows("r157:swerving_lead_vehicle ego=50 model=bus", 50, {"keeps": 50, "headway": 2, "most_left": 1.5}),
        _rows("r157:side_vehicle", 60, {"keeps": 60, "lead": 0, "left": 3.0}),
        _rows("r157:side_vehicle ego=50 lane=right lead=-5 offset=0", 50, {"keeps": 50, "lead": -5, "left": -3.5}),
        _rows("r157:fully_blocking_target", 60, {"keeps": 0, "lead": 100, "left": 0}),
        _rows("r157:fully_blocking_target road=right_250 ego=30 model=truck", 30, {"keeps": 0, "lead": 100, "left": 0}),
        _rows("r157:partially_blocking_target", 60, {"keeps": 0, "lead": 100, "left": -1.5}),
        _rows("r157:partially_blocking_target offset=2 model=car", 60, {"keeps": 0, "lead": 100, "left": 2.0}),
        _rows("r157:crossing_pedestrian", 60, {"speed": 5, "left": -5, "starts": 3.6, "meets": 0}),
        _rows("r157:crossing_pedestrian ego=10", 10, {"speed": 5, "left": -5, "starts": 3.6}),
        _rows("r157:multiple_blocking_targets", 60, {"keeps": 0, "lead": 100, "between": 15}, STANDS),
        _rows("r157:follow_lead_vehicle_comfortable", 60, {"at_first": 60, "headway": 1.6, "rate": 1.0, "to": 42}),
        _rows("r157:follow_lead_vehicle_comfortable offset=1.75 ego=20", 20, {"at_first": 20, "left": 1.75, "rate": 1.0}),
        _rows("r157:follow_lead_vehicle_emergency_brake", 60, {"at_first": 60, "headway": 1.6, "rate": -6.0, "to": 0}),
        _rows(
            "r157:follow_lead_vehicle_emergency_brake ego=20 headway=1.2 model=truck offset=-1.75", 20,
            {"at_first": 20, "headway": 1.2, "rate": -6.0, "left": -1.75},
        ),
        _rows("r157:cut_in", 60, {"keeps": 40, "gap": 30, "sideways": 2.0, "last_left": 0.0, "left": -3.5}),
        _rows("r157:cut_in ego=60 slower=10 gap=60 lateral_speed=0.5 lane=left", 60, {"keeps": 50, "gap": 60, "sideways": 0.5, "left": 3.5}),
        _rows("r157:cut_in_unavoidable_collision", 60, {"keeps": 40, "gap": 10, "sideways": 3.0, "left": -3.5}),
        _rows("r157:cut_out_fully_blocking", 60, {
            "keeps": 60, "headway": 2, "sideways": 2, "to_the_next": 50, "last_left": 3.5,
        }, {"keeps": 0, "left": 0}),
        _rows("r157:cut_out_fully_blocking distance=100 lateral_speed=1 model=truck lane=right", 60, {
            "keeps": 60, "headway": 2, "sideways": 1, "to_the_next": 100, "last_left": -3.5,
        }, {"keeps": 0, "left": 0}),
        _rows("r157:cut_out_fully_blocking ego=30 distance=20 lateral_speed=3", 30, {
            "keeps": 30, "headway": 2, "sideways": 3, "to_the_next": 20,
        }, {"keeps": 0, "left": 0}),
        _rows("r157:cut_out_multiple_blocking_targets", 60, {
            "keeps": 60, "headway": 2, "sideways": 2, "to_the_next": 50, "last_left": 3.5,
        }, {"keeps": 0, "between": 15}, STANDS),
        _rows("r157:cut_out_multiple_blocking_targets model=truck", 60, {"keeps": 60, "to_the_next": 50}, {"between": 15}, STANDS),
        _rows("r157:forward_detection_range", 60, {"keeps": 0, "lead": 100, "left": -5.25}),
        _rows("r157:lateral_detection_range", 60, {"keeps": 60, "lead": 0, "left": -7, "last_left": -1.75, "sideways_rate": 0.1}),
        _rows("leaderboard:control_loss", 54, {"friction": 0.3, "first": 14, "second": 48, "third": 74, "long": 10}),
        _rows("leaderboard:lead_vehicle_brakes", 36, {"at_first": 36, "gap": 25, "rate": -8, "to": 0}),
        _rows("leaderboard:lead_vehicle_brakes gap=10 deceleration=4", 36, {"at_first": 36, "gap": 10, "rate": -4}),
        _rows("leaderboard:crossing_without_prior_action", 36, {"speed": 12, "start_distance": 13}, STANDS),
        _rows("leaderboard:crossing_after_turn", 20, {"speed": 10, "behind_junction": 8, "meets": 0}),
        _rows("leaderboard:crossing_after_turn distance=3 turn=left", 20, {"speed": 10, "behind_junction": 3, "meets": 0}),
        _rows("leaderboard:slow_leader", 55, {"at_first": 55, "gap": 35, "to": 17}, {"keeps": 45, "left": 3.5}),
        _rows("leaderboard:obstacle_with_oncoming_traffic", 36, {"keeps": 0, "left": 0}, {"keeps": 20, "between": 44.7}, {"keeps": 20}),
        _rows("leaderboard:red_light_runner", 40, {"keeps_own": 40, "meets": 0}),
        _rows("leaderboard:unprotected_left_turn", 20, {"keeps_own": 25, "meets": 0}),
        _rows("leaderboard:right_turn_crossing_traffic", 20, {"keeps_own": 25, "meets": 0}),
        _rows("leaderboard:right_turn_crossing_traffic ego=15 target=50", 15, {"meets": 0}),
        _rows("leaderboard:unsignalised_crossing", 30, {"keeps_own": 30, "meets": 0}),
        _rows("nhtsa:lead_vehicle_stopped", 56, _ahead(0, 50)),
        _rows("nhtsa:lead_vehicle_decelerating", 80, {"at_first": 80, "gap": 40, "rate": -4.9, "to": 0, "impact": 50, "begins": 3}),
        _rows("nhtsa:lead_vehicle_decelerating ego=50 target=50 gap=12 deceleration=2.9", 50, {"at_first": 50, "gap": 12, "rate": -2.9}),
        _rows("nhtsa:lead_vehicle_slower", 80, _ahead(20, 50)),
        _rows("nhtsa:changing_lanes_same_direction", 89, {"keeps": 79, "gap": 10, "sideways": 1.5, "left": 3.5}),
        _rows("nhtsa:opposite_direction_no_maneuver", 89, {"keeps": 89, "sideways": 1.0, "last_left": 1.0}),
        _rows("nhtsa:straight_crossing_paths", 56, {"at_first": 0, "rate": 2.0, "meets": 0}),
        _rows("nhtsa:left_turn_across_path", 56, {"keeps_own": 20, "meets": 0}),
        _rows("nhtsa:pedestrian_no_maneuver", 40, {"speed": 5, "impact": 50}),
        _rows("nhtsa:pedestrian_no_maneuver ego=60 target=8 side=left", 60, {"speed": 8, "impact": 50}),
        _rows("nhtsa:pedalcyclist_no_maneuver", 40, _crossing(15, 50, -7, 3.5, 3.5)),
        _rows("nhtsa:pedalcyclist_no_maneuver ego=24 target=20 side=left", 24, _crossing(20, 50, 7, 3.5, 3.5)),
        _rows("nhtsa:animal_no_maneuver", 89, {"speed": 20, "meets": 0}),
    )
    for row in rows
)  # fmt: skip


def _moved(scenario: str, ego: float, aside: float | None = None, *others: dict[str, float]) -> Iterator[Row]:
    """Of a tested car that is made to drift with a speed sideways, in m/s below 1, or to change lanes."""
    found = [row for row in _rows(scenario, ego, *others) if row.what not in ("ego", "aside")]
    found.append(Row(scenario, 0, "led", ego, OF_NCAP["ego"], "NCAP"))
    if aside is not None and abs(aside) < 1:
        found.append(Row(scenario, 0, "released", aside, OF_NCAP["released"], "NCAP"))
    elif aside is not None:
        found.append(Row(scenario, 0, "changes_by", aside, OURS["m"], "ours"))
    yield from found


def _from_rest(scenario: str, *others: dict[str, float]) -> Iterator[Row]:
    yield from (row for row in _rows(scenario, 0, *others) if row.what not in ("ego", "aside"))


OF_ROBOT: tuple[Row, ...] = tuple(
    row
    for rows in (
        _rows("ncap:CCFhol", 70, {"at_first": 70, "last_left": 0}, {"keeps": 70, "left": 3.5}),
        _rows("ncap:CPTA", 10, {"speed": 5, "behind_junction": 5, "run_up": 2}),
        _rows("ncap:CBTA", 10, {"speed": 15, "behind_junction": 5}),
        _moved("ncap:ELK_RE", 70, 0.4),
        _moved("ncap:ELK_RE ego=90 lateral_speed=0.6", 90, 0.6),
        _moved("ncap:ELK_RE ego=80 lateral_speed=0.2", 80, 0.2),
        _moved("ncap:CC_ELK_On", 70, 0.5, {"keeps": 70, "left": 3.5}),
        _moved("ncap:CC_ELK_On lateral_speed=0.3", 70, 0.3, {"keeps": 70}),
        _moved("ncap:CC_ELK_Ov", 70, 0.5, {"keeps": 80, "left": 3.5}),
        _moved("ncap:CC_ELK_Ov lateral_speed=0.7", 70, 0.7, {"keeps": 80}),
        _moved("ncap:CM_ELK_On", 70, 0.5, {"keeps": 70}),
        _moved("ncap:CM_ELK_Ov", 60, 0.5, {"keeps": 70, "left": 3.5}),
        _moved("ncap:LKA", 72, 0.4),
        _moved("ncap:LKA line=solid lateral_speed=0.5", 72, 0.5),
        _moved("ncap:LKA side=right lateral_speed=0.2", 72, 0.2),
        _from_rest("ncap:CCCscp_SfS", {"speed": 30}),
        _from_rest("ncap:CMCscp_SfS", {"speed": 30}),
        _from_rest("ncap:CCFtap_SfS", {"speed": 30}),
        _from_rest("ncap:CMFtap_SfS", {"speed": 30}),
        _from_rest("ncap:CBNAO_SfS", {"speed": 15}),
        _from_rest("ncap:CPMFC", {"keeps": 0, "impact": 50}),
        _from_rest("ncap:CPMRCs", {"keeps": 0}),
        _from_rest("ncap:CPMRCm", {"speed": 5}),
        _rows("ncap:ACC_CCRs", 80, _ahead(0, 50)),
        _rows("ncap:ACC_CCRs ego=130 distance=250 impact=100", 130, _ahead(0, 100)),
        _rows("ncap:ACC_CCRm", 80, _ahead(20, 50)),
        _rows("ncap:ACC_CCRm ego=130 model=motorbike target=60", 130, _ahead(60, 50)),
        _rows("ncap:ACC_CCRb", 55, {"at_first": 50, "rate": -4, "impact": 50}),
        _rows("ncap:ACC_cut_in", 120, {"keeps": 70, "sideways": 2, "last_left": 0, "left": -3.5}),
        _rows("ncap:ACC_cut_out", 50, {"keeps": 50, "headway": 2, "to_the_next": 50 / 3.6 * 3}, {"keeps": 0}),
        _rows("ncap:ACC_VRU", 60, {"speed": 20, "impact": 50}),
        _rows("ncap:ACC_auto_resume", 30, {"at_first": 30, "rate": -3}),
        _rows("ncap:S_bend", 80),
        _rows("ncap:S_bend ego=130 radius=r650", 130),
        _rows("r157:motorway_keeping", 130),
        _rows("r157:motorway_blocking_target", 130, {"keeps": 0, "lead": 300, "left": 0}),
        _rows("r157:motorway_follow_emergency_brake", 130, {"at_first": 130, "headway": 2, "rate": -6}),
        _rows("r157:motorway_cut_in", 130, {"keeps": 100, "gap": 40, "sideways": 1.5, "left": -3.5, "last_left": 0}),
        _rows("r157:motorway_cut_out", 110, {"keeps": 110, "headway": 2, "sideways": 1.5, "to_the_next": 100}, {"keeps": 0}),
        _moved("r157:lane_change", 110, 3.5),
        _moved("r157:lane_change lane=right ego=130", 130, -3.5),
        _moved("r157:lane_change_rear_vehicle", 90, 3.5, {"left": 3.5}),
        _moved("r157:lane_change_side_vehicle", 90, None, {"keeps": 90, "lead": 0, "left": 3.5}),
        _moved("r157:lane_change_two_vehicles", 90, None, {"keeps": 90, "lead": 3, "left": 7}),
        _rows("leaderboard2:signalised_left_turn", 20, {"keeps_own": 30}),
        _rows("leaderboard2:right_turn", 20, {"keeps_own": 30, "meets": 0}),
        _rows("leaderboard2:opposite_vehicle_taking_priority", 40, {"keeps_own": 30, "meets": 0}),
        _rows("leaderboard2:opposite_vehicle_running_red_light", 50, {"keeps_own": 40, "meets": 0}),
        _rows("leaderboard2:crossing_bicycle_flow", 20, {"speed": 15, "behind_junction": 6}),
        _rows("leaderboard2:vehicle_turning_pedestrian", 20, {"speed": 5, "behind_junction": 8}),
        _rows("leaderboard2:priority_at_junction", 40, {"keeps_own": 0}),
        _rows("leaderboard2:red_light", 40),
        _rows("leaderboard2:stop_sign", 40),
        _rows("leaderboard2:blocked_intersection", 20, {"keeps": 0}),
        _rows("leaderboard2:highway_cut_in", 90, {"speed": 72}),
        _moved("leaderboard2:highway_exit", 80, -3.5, {"keeps": 80, "lead": 30, "left": -3.5}),
        _rows("leaderboard2:merger_into_slow_traffic", 60),
        _rows("leaderboard2:static_cut_in", 60, {"at_first": 0, "left": -3.5}),
        _rows("leaderboard2:parking_cut_in", 50, {"at_first": 0}),
        _rows("leaderboard2:parking_crossing_pedestrian", 40, {"speed": 8, "start_distance": 14}, STANDS),
        _rows("leaderboard2:pedestrian_crossing", 30, {"speed": 5}),
        _from_rest("leaderboard2:parking_exit", STANDS, STANDS, {"at_first": 50}),
        _rows("leaderboard2:hard_brake", 50, {"at_first": 50, "headway": 1.5, "rate": -8}),
        _rows("leaderboard2:construction_obstacle", 50, STANDS),
        _moved("leaderboard2:construction_obstacle_two_ways", 40, None, STANDS, {"keeps": 40}),
        _rows("leaderboard2:accident", 50, STANDS, STANDS),
        _rows("leaderboard2:parked_obstacle", 50, {"keeps": 0, "left": -0.7 * 3.5 / 2}),
        _rows("leaderboard2:hazard_at_side_lane", 50, {"keeps": 15, "left": -0.9}, {"keeps": 15}),
        _rows("leaderboard2:invading_turn", 40, {"keeps_own": 40, "left": 2.4}),
        _rows("leaderboard2:slow_leader_lane_change", 60, {"keeps": 25, "gap": 70}, {"keeps": 60, "left": 3.5}),
        _rows("leaderboard2:interurban_actor_flow", 20),
        _rows("leaderboard2:yield_to_emergency_vehicle", 60, {"keeps": 85, "left": 3.5}),
        _rows("nhtsa:control_loss_prior_maneuver", 25),
        _rows("nhtsa:control_loss", 60),
        _rows("nhtsa:running_red_light", 56, {"keeps_own": 40, "meets": 0}),
        _rows("nhtsa:running_stop_sign", 56, {"keeps_own": 40, "meets": 0}),
        _moved("nhtsa:road_edge_departure_prior_maneuver", 89, 0.5),
        _moved("nhtsa:road_edge_departure", 89, 0.5),
        _moved("nhtsa:animal_prior_maneuver", 72, 3.5),
        _rows("nhtsa:pedestrian_prior_maneuver", 20, {"speed": 5, "behind_junction": 6}),
        _rows("nhtsa:pedalcyclist_prior_maneuver", 20, {"speed": 15, "behind_junction": 6}),
        _rows("nhtsa:backing_up_into_vehicle", 40, {"at_first": 0}),
        _rows("nhtsa:turning_same_direction", 56, {"at_first": 45}),
        _rows("nhtsa:parking_same_direction", 40, {"at_first": 0}),
        _rows("nhtsa:drifting_same_direction", 89, {"keeps": 89, "lead": 2, "sideways": 0.5, "left": 3.5}),
        _rows("nhtsa:maneuver_opposite_direction", 72, {"keeps": 72, "sideways": 1.5}, {"keeps": 60}),
        _moved("nhtsa:following_vehicle_maneuver", 72, 3.5, {"keeps": 50, "left": 3.5}),
        _rows("nhtsa:lead_vehicle_accelerating", 72, {"at_first": 15, "gap": 80 - 3 * 57 / 3.6, "rate": 1.5}),
        _rows("nhtsa:left_turn_across_path_signalised", 56, {"keeps_own": 20, "meets": 0}),
        _rows("nhtsa:turning_right_signalised", 56, {"keeps_own": 20}),
        _rows("nhtsa:turning_not_signalised", 56, {"keeps_own": 20}),
        _rows("nhtsa:evasive_action", 89, {"keeps": 89, "lead": 6, "most_right": 2.3, "last_left": 3.5}),
        _moved("nhtsa:evasive_action_prior_maneuver", 89, 3.5, {"keeps": 70, "most_left": 1.0}),
        _moved("nhtsa:object_prior_maneuver", 72, 3.5, {"keeps": 0, "lead": 240, "left": 3.5}),
        _rows("nhtsa:object_no_maneuver", 89, {"keeps": 0, "left": 0}),
        _rows("r152:stationary_car", 42, _ahead(0, 50)),
        _rows("r152:moving_car", 60, _ahead(20, 50)),
        _rows("r152:pedestrian", 40, {"speed": 5, "impact": 50}),
        _rows("r152:bicycle", 38, {"speed": 15, "left": -15}),
        _rows("r152:false_reaction_cars", 50, {"keeps": 0, "apart": 4.5}, STANDS),
        _rows("r152:false_reaction_pedestrian", 50, {"keeps_own": 0, "left": -2.15}),
        _rows("r171:lane_positioning", 70),
        _rows("r171:stationary_vehicle", 90, STANDS),
        _rows("r171:lead_vehicle_decelerates", 90, {"at_first": 90, "headway": 2, "rate": -4}),
        _rows("r171:cut_in", 90, {"keeps": 70, "gap": 25, "sideways": 1, "left": -3.5}),
        _rows("r171:cut_out", 70, {"keeps": 70, "headway": 2, "to_the_next": 60}, {"keeps": 0}),
        _moved("r171:lane_change", 90, 3.5, {"left": 3.5}),
        _rows("r79:B1_lane_keeping", 70),
        _rows("r79:B1_most_lateral_acceleration", 81),
        _moved("r79:CSF_lane_departure", 70, 0.4),
        _moved("r79:CSF_lane_departure ego=130 side=right lateral_speed=0.6", 130, 0.6),
        _moved("r79:C_lane_change", 90, 3.5, {"keeps": 130, "left": 3.5}),
        _moved("r79:C_rear_vehicle", 90, 3.5, {"left": 3.5}),
        _rows("r79:ESF_evades", 90, {"keeps": 90, "lead": 1, "sideways": 0.5}),
        _rows("r79:ESF_obstacle", 60, {"keeps": 0, "lead": 100, "left": -1}),
        _moved("r130:lane_departure", 65, 0.4),
        _moved("r130:lane_departure lateral_speed=0.8 side=right", 65, 0.8),
        _moved("r130:lane_departure lateral_speed=0.1", 65, 0.1),
    )
    for row in rows
)  # fmt: skip
"""Of the scenarios that came later: what the test robot drives, or is made to do."""
