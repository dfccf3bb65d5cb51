"""Fits a reader's confidence to how often the reader was right on descriptions held back from training."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.coverage import Coverage
from roadgpt.brief.readers.model.network import Network
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.test_time_augmentation import refusal, scored_plans
from roadgpt.brief.readers.model.vocabulary import REFUSALS
from roadgpt.errors import BriefError
from roadgpt.learn.generator import Pair

Floats = npt.NDArray[np.float64]
MOST_WRONGLY = 0.004  # share of these valid descriptions that may be refused; for new ones it will be higher
STEPS = 4000
RATE = 0.05
PULL = 0.01  # weight decay, so that few pairs do not lead to extreme weights


@dataclass(frozen=True, slots=True)
class Calibration:
    """The content of ``settings.json``: the lowest probability at which a refusal is accepted, and the
    weights of the confidence model.
    """

    refuse_from: float
    confidence: dict[str, float]


def calibrated(network: Network, coverage: Coverage, pairs: Sequence[Pair]) -> Calibration:
    """Returns settings fitted to ``pairs``, on which the network must not have been trained."""
    honest = [pair for pair in pairs if pair.plan not in REFUSALS]
    threshold = _threshold(network, honest)
    rows, rights = [], []
    for pair in honest:
        draft = scored_plans(network, pair.text, refuse_from=2.0)[0]
        unused = len(coverage.unused(slotted(pair.text), draft.tokens))
        rows.append((1.0, *draft.features.values(), float(unused)))
        rights.append(_plan(draft.line) == _plan(pair.plan))
    fitted = _fitted(np.array(rows), np.array(rights, dtype=float))
    names = ("bias", *draft.features, "unused")
    weights = {name: round(float(value), 4) for name, value in zip(names, fitted, strict=True)}
    return Calibration(threshold, weights)


def _threshold(network: Network, honest: Sequence[Pair]) -> float:
    """Returns the probability from which a refusal is accepted; hardly any valid description reaches it."""
    chances = [refusal(network, pair.text) for pair in honest]
    most = float(np.quantile(chances, 1 - MOST_WRONGLY)) if chances else 0.5
    return round(min(max(most, 0.5), 0.95), 3)


def _plan(line: str) -> str:
    try:
        return plan(normal(read_plan(line)))
    except BriefError:
        return "?"


def _fitted(rows: Floats, rights: Floats) -> Floats:
    """Fits a logistic regression by gradient descent."""
    weights = np.zeros(rows.shape[1])
    for _ in range(STEPS):
        chances = 1 / (1 + np.exp(-rows @ weights))
        weights -= RATE * (rows.T @ (chances - rights) / len(rights) + PULL * weights)
    return weights
