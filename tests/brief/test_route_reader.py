"""Descriptions of routes are read by a network of their own; those of single roads are read as without it."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief import AnotherRoadError, Brief, normal, read
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model import WEIGHTS, ModelReader
from roadgpt.brief.readers.model.before import may_tell_a_route
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.trained import ScoredPlan, Trained, chosen
from roadgpt_training.mirror import is_of_junctions

READER = ModelReader()
PAIRS = Path(__file__).parents[2] / "training" / "data" / "networks" / "train"


def read_by(words: str) -> tuple[Trained, tuple[ScoredPlan[Brief], ...]]:
    return chosen(READER.roads, READER.routes, words, slotted(words))


def test_what_the_network_for_roads_can_write_is_its_reading() -> None:
    for words in ("three turns, no junctions", "a left bend and then a right one, without any lane changes"):
        assert may_tell_a_route(words)
        by, plans = read_by(words)
        assert by is READER.roads
        assert plans == READER.roads.plans(slotted(words))


def test_a_reader_without_this_network_names_what_it_cannot_read(tmp_path: Path) -> None:
    for path in WEIGHTS.iterdir():
        if "_routes" not in path.name:
            shutil.copy(path, tmp_path)
    with pytest.raises(AnotherRoadError, match="a roundabout") as refusal:
        read("two turns and a roundabout", f"model:{tmp_path}")
    assert normal(refusal.value.brief) == normal(read_plan("turn x2"))


def test_nearly_every_description_of_a_route_has_a_word_of_the_list() -> None:
    files = sorted(PAIRS.glob("*.jsonl"))
    lines = [line for path in files for line in path.read_text(encoding="utf-8").splitlines()[::3]]
    told = [pair["text"] for pair in map(json.loads, lines) if is_of_junctions(pair["plan"])]
    missed = [text for text in told if not may_tell_a_route(text)]
    assert len(told) > 4000
    assert len(missed) < 0.005 * len(told), missed


def test_all_encoders_have_one_embedding() -> None:
    onnx = pytest.importorskip("onnx", reason="comes with the extra 'learn'")
    kept = np.fromfile(WEIGHTS / "embedding.bin", np.uint8)
    for name in ("", "_routes"):
        graph = onnx.load(WEIGHTS / f"encoder{name}.onnx").graph
        (tensor,) = (each for each in graph.initializer if each.name == "reader.pieces.weight_quantized")
        assert np.array_equal(onnx.numpy_helper.to_array(tensor).ravel(), kept)
        assert (WEIGHTS / f"encoder{name}.onnx").stat().st_size < 24e6  # the embedding alone has 10 MB
