"""The trained reader as it is shipped: what it promises to everybody who calls it."""

import json
import shutil
import zlib
from hashlib import sha256
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief import ContradictionError, read, reader_of
from roadgpt.brief.model import Brief, exactly
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import WEIGHTS, ModelReader
from roadgpt.errors import BriefError, PartError

READER = ModelReader()
MOST_MEGABYTES = 60  # in the wheel, which is compressed


@pytest.mark.parametrize(
    "words", ["", "   ", "x" * 3000, "what time is it in Paris", "a climb of 60 percent"]
)
def test_what_is_no_road_is_refused_in_one_sentence(words: str) -> None:
    with pytest.raises(BriefError) as caught:
        READER.read(words)
    assert 20 < len(str(caught.value)) < 300


WORDS = st.lists(
    st.sampled_from(["3", "left", "60", "m", "turns", "%", "up", "the", "hairpin", "|", ";", "1:8"])
).map(" ".join)


@settings(max_examples=20, deadline=None)
@given(st.one_of(st.text(max_size=200), WORDS))
def test_any_text_is_a_brief_or_refused(words: str) -> None:
    try:
        brief = READER.read(words)
    except BriefError:
        return
    assert isinstance(brief, Brief)
    assert 0 <= brief.confidence <= 1
    assert brief.words == words
    assert plan(read_plan(plan(brief))) == plan(brief)


def test_a_contradiction_is_answered_with_the_plan_that_may_be_meant() -> None:
    with pytest.raises(
        ContradictionError, match="the number of turns; leave one of them out; or is this meant"
    ) as refusal:
        read("three turns but no turns")
    assert read_plan(refusal.value.plan).turns != exactly(0)
    assert plan(refusal.value.brief) == refusal.value.plan
    assert read(refusal.value.plan, "plan").clauses == refusal.value.brief.clauses


def test_the_same_words_are_read_the_same_way_twice() -> None:
    words = "a road over two hills with a bend or two"
    assert READER.read(words) == READER.read(words)
    one, other = (READER.alternatives(words, number=2, seed=3) for _ in range(2))
    assert one == other


def test_a_vague_wish_has_several_readings() -> None:
    readings = READER.alternatives("some road with turns", number=4, temperature=1.5, seed=1)
    assert 2 <= len(readings) <= 4
    assert readings[0] == READER.read("some road with turns")
    assert len({plan(brief) for brief in readings}) == len(readings)


def test_the_weights_are_small_and_come_with_their_notice() -> None:
    files = [path for path in WEIGHTS.iterdir() if path.is_file()]
    assert sum(len(zlib.compress(path.read_bytes(), 1)) for path in files) < MOST_MEGABYTES * 1e6
    assert "Apache-2.0" in (WEIGHTS / "NOTICE").read_text(encoding="utf-8")
    sums = json.loads((WEIGHTS / "sums.json").read_text(encoding="utf-8"))
    graphs = {f"{part}{name}.onnx" for part in ("encoder", "decoder") for name in ("", "_routes")}
    texts = {"pieces.txt", "words.txt"}
    assert {*sums} == {*graphs, *texts, "embedding.bin", "settings.json"}
    for name, digest in sums.items():
        assert sha256((WEIGHTS / name).read_bytes()).hexdigest() == digest


def test_weights_of_ones_own_are_named_with_their_folder(tmp_path: Path) -> None:
    words = "two left turns and a straight of 40 m"
    assert reader_of(f"model:{WEIGHTS}").read(words) == READER.read(words)
    with pytest.raises(PartError, match=r"no encoder\.onnx in .*that training wrote"):
        reader_of(f"model:{tmp_path}")
    with pytest.raises(PartError, match="takes no folder"):
        reader_of(f"plan:{tmp_path}")


@pytest.mark.parametrize("name", ["encoder.onnx", "decoder_routes.onnx", "embedding.bin"])
def test_damaged_weights_are_refused_in_a_sentence(tmp_path: Path, name: str) -> None:
    for path in WEIGHTS.iterdir():
        shutil.copy(path, tmp_path)
    whole = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(PartError, match=r"coder\w*\.onnx' cannot be loaded: it is damaged"):
        reader_of(f"model:{tmp_path}").read("left at the crossroads" if "routes" in name else "three turns")
