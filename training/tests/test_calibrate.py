"""The weights of the confidence model are fitted to readings that were right or wrong."""

import numpy as np
import pytest

pytest.importorskip("sklearn")

from sklearn.linear_model import LogisticRegression

from roadgpt_training import calibrate
from roadgpt_training.calibrate import UncalibratedReading


def readings(number: int, seed: int) -> list[tuple[UncalibratedReading, bool]]:
    """Readings whose plans are wrong half of the time if they fall, and hardly ever otherwise."""
    rng = np.random.default_rng(seed)
    out = []
    for _ in range(number):
        falls, unlikely = rng.random() < 0.3, float(rng.normal())
        is_right = rng.random() > (0.5 if falls else 0.05)
        features = {"all": unlikely, "has turn": 1.0, **({"has down": 1.0} if falls else {})}
        out.append((UncalibratedReading("turn", features), is_right))
    return out


def test_weights_are_those_of_logistic_regression(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibrate, "PULL_OF_TOKENS", calibrate.PULL)
    found = readings(400, 3)
    fitted = calibrate._weights(found)
    rows = [[1.0, f["all"], f["has turn"], f.get("has down", 0.0)] for (_, f), _ in found]
    theirs = LogisticRegression(C=1 / calibrate.PULL, fit_intercept=False, max_iter=2000, tol=1e-9)
    theirs.fit(rows, [right for _, right in found])
    assert list(fitted.values()) == pytest.approx(theirs.coef_[0].tolist(), abs=2e-3)


def test_a_token_that_is_often_misread_lowers_the_confidence_and_a_rare_one_has_no_weight() -> None:
    found = readings(400, 4)
    found[0][0].features["has crest"] = 1.0
    fitted = calibrate._weights(found)
    assert fitted["has down"] < -0.5
    assert "has crest" not in fitted
