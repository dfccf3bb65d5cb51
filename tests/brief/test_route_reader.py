"""Descriptions of routes are read by a network of their own; those of single roads are read as without it."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief import NotBuiltError, normal, read
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model import WEIGHTS, ModelReader, ensemble
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.brief.readers.model.route_words import may_tell_a_route

READER = ModelReader()
PAIRS = Path(__file__).parents[2] / "data" / "networks" / "train"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("a T-junction, turn right", "t_junction right"),
        ("left at the crossroads with traffic lights", "crossroads left lights"),
        ("a roundabout with four arms, second exit", "roundabout exit=2 arms=4"),
        ("erst eine Linkskurve, dann an der Kreuzung rechts", "turn left // crossroads right"),
        ("au rond-point, troisième sortie", "roundabout exit=3"),
        ("en la glorieta, segunda salida", "roundabout exit=2"),
        ("all'incrocio con semaforo gira a sinistra", "crossroads left lights"),
        ("two lanes each way, three turns", "turn x3 | lanes=2 against=2"),
        ("a grid of three by two blocks", "map columns=3 rows=2"),
        (
            "a loop road around one block of houses, with four cul-de-sacs, each from its own T-junction",
            "map t_junction x4 blocks=1 dead_ends=4",
        ),
    ],
)
def test_routes_are_read_in_five_languages(words: str, line: str) -> None:
    assert normal(READER.read(words)) == normal(read_plan(line))


def test_a_word_that_goes_with_another_one_is_not_reported_as_unread() -> None:
    assert READER.read("a T-junction, turn right").unused == ()
    assert READER.read("a roundabout with four arms, second exit").unused == ()


def test_what_the_networks_for_roads_can_write_is_their_reading() -> None:
    for words in ("three turns, no junctions", "a left bend and then a right one, without any lane changes"):
        assert may_tell_a_route(words)
        by, plans = READER.scored(words)
        assert by is READER.roads
        assert plans == READER.roads.scored(words)


def test_what_they_name_beside_the_road_is_handed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ensemble, "may_tell_a_route", lambda words: False)
    by, plans = READER.scored("a roundabout, second exit")
    assert by is READER.routes
    assert plans[0].line.split()[0] == "roundabout"


def test_a_reader_without_this_network_names_what_it_cannot_read(tmp_path: Path) -> None:
    for path in WEIGHTS.iterdir():
        if "_routes" not in path.name:
            shutil.copy(path, tmp_path)
    with pytest.raises(NotBuiltError, match="a roundabout") as refusal:
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
    for name in ("", "_2", "_routes"):
        graph = onnx.load(WEIGHTS / f"encoder{name}.onnx").graph
        (tensor,) = (each for each in graph.initializer if each.name == "reader.pieces.weight_quantized")
        assert np.array_equal(onnx.numpy_helper.to_array(tensor).ravel(), kept)
        assert (WEIGHTS / f"encoder{name}.onnx").stat().st_size < 24e6  # the embedding alone has 10 MB
