"""Fits a reader's confidence to how often the reader was right on texts held back from training.

For single roads, the texts are prompts with truths: a reading is right if the roads made from the reading
meet the truth. A reading may be right although its plan differs from the label, because most texts can be
labelled in several ways.
"""

from collections import Counter
from collections.abc import Sequence
from typing import TypedDict

import numpy as np

from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import NEVER, ModelReader, UncalibratedReading
from roadgpt.brief.readers.model.confidence import HAS
from roadgpt.brief.readers.model.ensemble import Ensemble
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.brief.readers.model.test_time_augmentation import refusal
from roadgpt.errors import BriefError
from roadgpt.learn.data import NETWORK
from roadgpt.learn.pair import Pair, normal_change
from roadgpt.learn.told_prompts import ToldPrompt, is_right

MOST_WRONGLY = 0.012  # share of valid held-back descriptions that may be refused; higher for new descriptions
STEPS = 30
CAUTION = 2.0
"""Weight of a wrong reading of a route, relative to a right one: a confident wrong reading does more harm
than an unnecessary doubt.
"""
CAUTION_OF_ROADS = 6.0
"""Weight of a wrong reading of a single road, relative to a right one."""
PULL = 0.1  # weight decay, so that few pairs do not lead to extreme weights
PULL_OF_TOKENS = 10.0  # the same for the inputs that say which tokens a plan has, of which there are many
FEWEST = 25
"""A token gets a weight only if it occurs in the plans of at least this many readings."""


class EnsembleCalibration(TypedDict):
    """What is fitted to the readings of an ensemble."""

    refuse_from: float
    """The lowest probability at which a refusal is accepted."""
    confidence: dict[str, float]
    """The weights of the confidence model."""


class Calibration(EnsembleCalibration):
    """The content of ``settings.json``: the calibration for single roads, change requests and routes."""

    changes: dict[str, float]
    """The weights of the confidence model for change requests."""
    routes: EnsembleCalibration | None


def calibrated(reader: ModelReader, pairs: Sequence[Pair], prompts: Sequence[ToldPrompt] = ()) -> Calibration:
    """Returns the content of ``settings.json``: the calibration for descriptions of roads, the weights of the
    confidence model for "changes", and the calibration for descriptions of "routes".

    The content is fitted to ``pairs`` and ``prompts``, which the networks must not have seen in training.
    Without prompts, the confidence for single roads is fitted to the pairs.
    """
    honest = [pair for pair in pairs if not pair.is_refusal]
    words = [pair for pair in honest if not pair.is_change]
    roads = calibrated_ensemble(reader, reader.roads, [pair for pair in words if not _is_route(pair)])
    asked = [
        (reader.uncalibrated_change(pair.text, normal_change), normal_change(pair.plan))
        for pair in honest
        if pair.is_change
    ]
    return {
        "refuse_from": roads["refuse_from"],
        "confidence": confidence_by_roads(reader, prompts) if prompts else roads["confidence"],
        "changes": _weights([(looks, looks.plan == right) for looks, right in asked if looks]),
        "routes": None if reader.routes is None else calibrated_routes(reader, reader.routes, honest),
    }


def calibrated_routes(reader: ModelReader, routes: Ensemble, pairs: Sequence[Pair]) -> EnsembleCalibration:
    """Returns the calibration of the ensemble for routes, fitted to the valid pairs that describe routes."""
    of_routes = [pair for pair in pairs if _is_route(pair) and not pair.is_refusal]
    return calibrated_ensemble(reader, routes, of_routes, CAUTION)


def calibrated_ensemble(
    reader: ModelReader, ensemble: Ensemble, pairs: Sequence[Pair], caution: float = 1.0
) -> EnsembleCalibration:
    """Returns the calibration of an ensemble: the lowest probability at which a refusal is accepted, and the
    weights of the confidence model. ``pairs`` are valid descriptions of the kind that the ensemble reads.
    When the weights are fitted, a wrong reading counts ``caution`` times and a right reading counts once.
    """
    read = [(reader.uncalibrated(pair.text, NEVER), _bare(pair.plan)) for pair in pairs]
    return {
        "refuse_from": _threshold(ensemble, pairs),
        "confidence": _weights(
            [(looks, _bare(looks.plan) == right) for looks, right in read if looks], caution
        ),
    }


def confidence_by_roads(reader: ModelReader, prompts: Sequence[ToldPrompt]) -> dict[str, float]:
    """Returns the weights of the confidence model for single roads, fitted to prompts with truths."""
    found = []
    for prompt in prompts:
        looks = reader.uncalibrated(prompt.text, NEVER)
        if looks is None or not looks.features or is_of_junctions(looks.plan):
            continue
        try:
            found.append((looks, is_right(reader.read(prompt.text), prompt.truth)))
        except BriefError:  # refused, so there is no confidence
            continue
    return _weights(found, CAUTION_OF_ROADS)


def _is_route(pair: Pair) -> bool:
    return pair.family.startswith(NETWORK)


def _threshold(ensemble: Ensemble, honest: Sequence[Pair]) -> float:
    """Returns the lowest probability at which a refusal is accepted; few valid descriptions reach it."""
    chances = [refusal(ensemble.networks, pair.text) for pair in honest]
    most = float(np.quantile(chances, 1 - MOST_WRONGLY)) if chances else 0.5
    return round(min(max(most, 0.5), 0.95), 3)


def _bare(line: str) -> str:
    """Returns the normal form of a plan without its ``beside(...)``, which older pairs do not have."""
    return plan(normal(read_plan(line)).model_copy(update={"beside": ()}))


def _weights(found: Sequence[tuple[UncalibratedReading, bool]], caution: float = 1.0) -> dict[str, float]:
    """Returns the weights of a confidence model by the names of its inputs: of a logistic regression, fitted
    by Newton's method, in which a wrong reading counts as ``caution`` right ones.
    """
    if not found:
        return {"bias": 0.0}
    counts = Counter(name for looks, _ in found for name in looks.features)
    names = ("bias", *(name for name, count in counts.items() if count >= FEWEST or not _is_token(name)))
    rows = np.array([[looks.features.get(name, 0.0) for name in names] for looks, _ in found])
    rows[:, 0] = 1.0
    rights = np.array([is_right for _, is_right in found], dtype=float)
    counted = np.where(rights > 0, 1.0, caution)
    weights = np.zeros(rows.shape[1])
    pull = np.diag([PULL_OF_TOKENS if _is_token(name) else PULL for name in names])
    for _ in range(STEPS):
        chances = 1 / (1 + np.exp(-rows @ weights))
        curvature = rows.T @ (rows * (counted * chances * (1 - chances))[:, None]) + pull
        weights += np.linalg.solve(curvature, rows.T @ (counted * (rights - chances)) - pull @ weights)
    return {name: round(float(value), 4) for name, value in zip(names, weights, strict=True)}


def _is_token(name: str) -> bool:
    return name.startswith(HAS)
