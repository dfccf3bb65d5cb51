"""What the verdict says of a drive with others on the road:

COLLISIONS, NEAR_MISSES, BLOCKED, SPEEDING   numbers of these incidents
AT_FAULT      whether the first collision was the tested car's fault, 1 or 0
IMPACT        difference of the velocities in the first collision, km/h
GAP           least gap to somebody ahead in the same lane, m; 0 at a collision
TTC           least time to collision, s

and of one whose tested car is made to drift:

DTLE          least distance from a front tyre to the edge of the lane, m; negative beyond it"""

from roadgpt.campaign.columns import ResultColumns, Told
from roadgpt.drive.lane_position import MarkingMonitor
from roadgpt.run import Run

COUNTED = {
    "COLLISIONS": "collision", "NEAR_MISSES": "near miss", "BLOCKED": "blocked", "SPEEDING": "speeding",
}  # fmt: skip
DECIMALS = 6


def _numbers(run: Run) -> dict[str, float]:
    verdict, out = run.verdict, dict[str, float]()
    if run.drive is None or run.road is None or verdict is None:
        return out
    if any(action.what == "drift" for action in run.world.scene.actions):
        road = run.drive.followed(run.road, run.world)
        beyond = MarkingMonitor.for_tyres(road, run.world, run.drive.car).along(run.drive)
        out["DTLE"] = round(-float(beyond.max()), DECIMALS)
    if run.drive.others is None:
        return out
    counts, first = verdict.counts, verdict.first_contact
    out |= {name: float(counts.get(kind, 0)) for name, kind in COUNTED.items()}
    measured = {"GAP": verdict.least_gap, "TTC": verdict.least_ttc}
    out |= {name: found for name, found in measured.items() if found is not None}
    if first is not None:
        out |= {
            "AT_FAULT": float(bool(verdict.is_at_fault)),
            "IMPACT": round(3.6 * first.impact_speed, DECIMALS),
        }
    return out


columns = ResultColumns(
    _numbers,
    told={
        "IMPACT": Told("impact_kmh", "impact {:.0f} km/h".format),
        "GAP": Told("gap_m", lambda gap: f"gap {gap:.1f} m" if gap else ""),
        "TTC": Told("ttc_s", "TTC {:.1f} s".format),
        "DTLE": Told("dtle_m", "{:.2f} m to the edge of the lane".format),
    },
)
