"""Fits a reader's confidence to how often the reader was right on texts held back from training."""

import json
from collections import Counter
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple, TypedDict

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model import NEVER, ModelReader
from roadgpt.brief.readers.model.scenes import read_told
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.trained import (
    HAS,
    Trained,
    chosen,
    features,
    most_plausible,
    scored_plans,
)
from roadgpt_training.data import NETWORK
from roadgpt_training.field import FIELD, of_road, of_scene
from roadgpt_training.pair import Pair, normal_change

MOST_WRONGLY = 0.012  # share of valid held-back descriptions that may be refused; higher for new descriptions
STEPS = 30
CAUTION = 2.0
"""Weight of a wrong reading, relative to a right one: a confident wrong reading does more harm than an
unnecessary doubt.
"""
PULL = 0.1  # weight decay, so that few pairs do not lead to extreme weights
PULL_OF_TOKENS = 10.0  # the same for the inputs that say which tokens a plan has, of which there are many
FEWEST = 25
"""A token gets a weight only if it occurs in the plans of at least this many readings."""


class UncalibratedReading(NamedTuple):
    """A plan, and the features from which the confidence in it is computed."""

    plan: str
    features: dict[str, float]


class NetworkCalibration(TypedDict):
    """What is fitted to the readings of a network."""

    refuse_from: float
    """The lowest probability at which a refusal is accepted."""
    confidence: dict[str, float]
    """The weights of the confidence model."""


class Calibration(NetworkCalibration):
    """The content of ``settings.json``: the calibration for single roads, change requests and routes."""

    changes: dict[str, float]
    """The weights of the confidence model for change requests."""
    routes: NetworkCalibration | None
    scenes: NetworkCalibration | None


def calibrated(reader: ModelReader, pairs: Sequence[Pair]) -> Calibration:
    """Returns the content of ``settings.json``: the calibration for descriptions of roads, the weights of the
    confidence model for "changes", and the calibration for descriptions of "routes".

    The content is fitted to ``pairs``, which the networks must not have seen in training.
    """
    honest = [pair for pair in pairs if not pair.is_refusal]
    words = [pair for pair in honest if not pair.is_change and not pair.family.startswith(FIELD)]
    of_field = [pair for pair in honest if pair.family.startswith(FIELD)]
    of_routes = [*filter(_is_route, words), *filter(None, map(of_road, of_field))]
    asked = [(_read_change(reader, pair.text), normal_change(pair.plan)) for pair in honest if pair.is_change]
    scenes = [*filter(None, map(of_scene, of_field))]
    routes, told = reader.routes, reader.scenes
    return {
        **calibrated_network(reader, reader.roads, [pair for pair in words if not _is_route(pair)], _read),
        "changes": _weights([(looks, looks.plan == right) for looks, right in asked if looks]),
        "routes": None if routes is None else calibrated_network(reader, routes, of_routes, _read),
        "scenes": None if told is None else calibrated_network(reader, told, scenes, _read_scene),
    }


def calibrated_network(
    reader: ModelReader,
    trained: Trained,
    pairs: Sequence[Pair],
    read: Callable[[ModelReader, Pair], UncalibratedReading | None],
) -> NetworkCalibration:
    """Returns the calibration of a network: the lowest probability at which a refusal is accepted, and the
    weights of the confidence model. ``pairs`` are valid descriptions of the kind that the network reads.
    When the weights are fitted, a wrong reading counts ``CAUTION`` times and a right reading counts once.
    """
    found = [(read(reader, pair), _bare(pair.plan)) for pair in pairs]
    rights = [(looks, _bare(looks.plan) == right) for looks, right in found if looks]
    return {"refuse_from": _threshold(trained, pairs), "confidence": _weights(rights, CAUTION)}


def _read_scene(reader: ModelReader, pair: Pair) -> UncalibratedReading | None:
    """Returns the likeliest plan of what is told beside the road; None if no plan could be read."""
    assert reader.scenes is not None
    text = slotted(pair.text)
    found = scored_plans(reader.scenes.network, text, NEVER, read_told)
    return UncalibratedReading(plan(found[0].asks or Brief()), features(found[0], text)) if found else None


def _read(reader: ModelReader, pair: Pair) -> UncalibratedReading | None:
    """Returns the likeliest plan of the road of a description; None if no plan could be read."""
    text = slotted(pair.text)
    if pair.family.startswith(FIELD) and reader.routes is not None:
        found = reader.routes.plans(text, NEVER)
    else:
        _, found = chosen(reader.roads, reader.routes, pair.text, text, NEVER)
    if not found:
        return None
    draft = most_plausible(found)
    if draft.asks is None:
        return UncalibratedReading(draft.refusal, {})
    return UncalibratedReading(plan(draft.asks), features(draft, text))


def _read_change(reader: ModelReader, words: str) -> UncalibratedReading | None:
    """Returns the likeliest plan of a change request, in normal form; None if no plan could be read."""
    text = slotted(words, is_change=True)
    found = scored_plans(reader.roads.network, text, NEVER, normal_change)
    return UncalibratedReading(found[0].asks or "", features(found[0], text)) if found else None


def _is_route(pair: Pair) -> bool:
    return pair.family.startswith(NETWORK)


def _threshold(trained: Trained, honest: Sequence[Pair]) -> float:
    """Returns the lowest probability at which a refusal is accepted; few valid descriptions reach it."""
    chances = [trained.network.refusal(slotted(pair.text)) for pair in honest]
    most = float(np.quantile(chances, 1 - MOST_WRONGLY)) if chances else 0.5
    return round(min(max(most, 0.5), 0.95), 3)


def _bare(line: str) -> str:
    """Returns the normal form of a plan without its ``beside(...)``, which older pairs do not have."""
    return plan(normal(read_told(line)).model_copy(update={"beside": ()}))


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


def write_settings(folder: Path, held_back: Sequence[Pair]) -> None:
    """Fits the reader in a folder to pairs that the networks were not trained on, and writes the result."""
    settings = calibrated(ModelReader(folder), held_back)
    (folder / "settings.json").write_text(json.dumps(settings, indent=2) + "\n", encoding="utf-8")
    write_sums(folder)


def write_sums(folder: Path) -> None:
    """Writes the SHA-256 checksums of a reader's files to ``sums.json``."""
    kinds = (".onnx", ".txt", ".bin")
    files = sorted(path for path in folder.iterdir() if path.suffix in kinds or path.name == "settings.json")
    sums = {path.name: sha256(path.read_bytes()).hexdigest() for path in files if path.name != "training.txt"}
    (folder / "sums.json").write_text(json.dumps(sums, indent=2) + "\n", encoding="utf-8")
