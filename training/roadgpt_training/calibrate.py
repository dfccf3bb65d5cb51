"""Fits a reader's confidence to how often the reader was right on texts held back from training."""

import json
from collections import Counter
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple, TypedDict

import numpy as np

from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import NEVER, ModelReader
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.trained import (
    HAS,
    Trained,
    changes_in,
    chosen,
    features,
    most_plausible,
    scored_plans,
)
from roadgpt_training.data import NETWORK
from roadgpt_training.field import FIELD
from roadgpt_training.pair import Pair, normal_change

MOST_WRONGLY = 0.012  # share of valid held-back descriptions that may be refused; higher for new descriptions
LOWEST = 0.25
"""The lowest probability from which a refusal is accepted; on held-back texts of routes and of the field, no
valid one came above 0.2."""
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
    scene_changes: dict[str, float]
    """The same for those that the network for routes reads, because they change a scene."""
    routes: NetworkCalibration | None


def calibrated(reader: ModelReader, pairs: Sequence[Pair]) -> Calibration:
    """Returns the content of ``settings.json``: the calibration for descriptions of roads, the weights of the
    confidence model for "changes", and the calibration for descriptions of "routes".

    The content is fitted to ``pairs``, which the networks must not have seen in training.
    """
    honest = [pair for pair in pairs if not pair.is_refusal]
    words = [pair for pair in honest if not pair.is_change]
    of_routes = [pair for pair in words if _is_route(pair)]
    asked = [pair for pair in honest if pair.is_change]
    of_road = [pair for pair in asked if not pair.family.startswith(FIELD)]
    of_scene = [pair for pair in asked if pair.family.startswith(FIELD)]
    return {
        **calibrated_network(reader, reader.roads, [pair for pair in words if not _is_route(pair)]),
        "changes": _weights(_changes_read(reader.roads, of_road)),
        "scene_changes": _weights(_changes_read(reader.routes, of_scene) if reader.routes else ()),
        "routes": None if reader.routes is None else calibrated_network(reader, reader.routes, of_routes),
    }


def calibrated_network(reader: ModelReader, trained: Trained, pairs: Sequence[Pair]) -> NetworkCalibration:
    """Returns the calibration of a network: the lowest probability at which a refusal is accepted, and the
    weights of the confidence model. ``pairs`` are valid descriptions of the kind that the network reads.
    When the weights are fitted, a wrong reading counts ``CAUTION`` times and a right reading counts once.
    """
    read = [(_read(reader, pair.text), _bare(pair.plan)) for pair in pairs]
    rights = [(looks, _bare(looks.plan) == right) for looks, right in read if looks]
    return {"refuse_from": _threshold(trained, pairs), "confidence": _weights(rights, CAUTION)}


def _read(reader: ModelReader, words: str) -> UncalibratedReading | None:
    """Returns the likeliest plan of a description; None if no plan could be read."""
    text = slotted(words)
    _, found = chosen(reader.roads, reader.routes, words, text, NEVER)
    if not found:
        return None
    draft = most_plausible(found)
    if draft.asks is None:
        return UncalibratedReading(draft.refusal, {})
    return UncalibratedReading(plan(draft.asks), features(draft, text))


def _changes_read(trained: Trained, pairs: Sequence[Pair]) -> list[tuple[UncalibratedReading, bool]]:
    """Returns the readings of change requests by a network, each with whether it is right; those of which no
    plan could be read are left out.
    """
    out: list[tuple[UncalibratedReading, bool]] = []
    for pair in pairs:
        text = slotted(pair.text, is_change=True)
        found = scored_plans(trained.network, text, NEVER, changes_in(normal_change))
        if found:
            looks = UncalibratedReading(found[0].asks or "", features(found[0], text))
            out.append((looks, looks.plan == normal_change(pair.plan)))
    return out


def _is_route(pair: Pair) -> bool:
    return pair.family.startswith((NETWORK, FIELD))


def _threshold(trained: Trained, honest: Sequence[Pair]) -> float:
    """Returns the lowest probability at which a refusal is accepted; few valid descriptions reach it."""
    chances = [trained.network.refusal(slotted(pair.text)) for pair in honest]
    most = float(np.quantile(chances, 1 - MOST_WRONGLY)) if chances else 0.5
    return round(min(max(most, LOWEST), 0.95), 3)


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
