"""The features of the SBFT competition, as ``run.execution`` defines them."""

from roadgpt.campaign.columns import ResultColumns
from roadgpt.run import Run
from roadgpt.run.execution import PER_POINT, features_of, records_of


def _numbers(run: Run) -> dict[str, float]:
    assert run.road is not None
    records = records_of(run.road, run.drive, run.world) if run.drive is not None else []
    return features_of(run.road.centreline(PER_POINT), records)


columns = ResultColumns(
    _numbers,
    bounds={
        "MAX_CURV": (0.0, 0.07),  # 1/m: the competition's tightest turn is 0.0698
        "DIR_COV": (0.0, 1.0),
        "STD_SA": (0.0, 150.0),  # degrees at the steering wheel
        "MEAN_LP": (-2.0, 2.0),  # m
        "MAX_LP": (0.0, 2.0),  # m
    },
)
