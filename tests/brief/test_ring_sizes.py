"""The size of a roundabout whose outer diameter is given in metres."""

import json
import re
from pathlib import Path

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.ring_sizes import with_ring_sizes
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.vocabulary import plan_of, tokens_of

FOLDER = Path(__file__).parents[2] / "data" / "networks" / "train"


def sized(text: str, tokens: str) -> str:
    found = slotted(text)
    return plan_of(with_ring_sizes(tokens.split(), found), found.slots)


@pytest.mark.parametrize(
    ("text", "written", "wanted"),
    [
        ("a roundabout 20 m across, third exit", "roundabout large exit= 3", "roundabout mini exit=3"),
        ("Kreisel, 40 m Durchmesser, geradeaus", "roundabout straight", "roundabout straight normal"),
        (
            "rond-point de 20 m de diamètre, puis un autre de 60 m de diamètre",
            "roundabout normal // roundabout normal",
            "roundabout mini // roundabout large",
        ),
        ("a roundabout with an island 20 m across", "roundabout d= [1]", "roundabout d=20"),
        ("a roundabout, the island is 20 m across", "roundabout", "roundabout"),
        ("a large roundabout, then 30 m", "roundabout large // | len= [1]", "roundabout large // | len=30"),
        ("Glorieta Ø 40 m, primera salida", "roundabout large exit= 1", "roundabout normal exit=1"),
        ("rotonda de 40 m de diámetro, no, de 20", "roundabout mini", "roundabout mini"),
        ("roundabout, 30 m across, no, 60 m across", "roundabout normal", "roundabout large"),
        ("roundabout of 30 m diameter, no lights", "roundabout large", "roundabout normal"),
        ("a roundabout 200 m across", "roundabout large", "roundabout large"),
    ],
)
def test_a_diameter_decides_the_size(text: str, written: str, wanted: str) -> None:
    assert sized(text, written) == wanted


def test_the_labels_of_training_keep_their_sizes() -> None:
    """The rule agrees with those who labelled by hand, whatever size the network guesses."""
    kept = changed = 0
    for path in sorted(FOLDER.glob("*.jsonl")):
        for line in path.read_text(encoding="utf-8").splitlines():
            pair = json.loads(line)
            if "roundabout" not in pair["plan"] or pair["plan"].startswith("!"):
                continue
            text = slotted(pair["text"])
            tokens = tokens_of(pair["plan"], text.slots)
            if not tokens or not re.search(r"mini|normal|large", pair["plan"]):
                continue
            guess = ["normal" if token in ("mini", "large") else token for token in tokens]
            right = plan_of(with_ring_sizes(tokens, text), text.slots)
            if with_ring_sizes(guess, text) != tuple(guess):
                changed += 1
                kept += read_plan(right) == read_plan(pair["plan"])
            else:
                assert read_plan(right) == read_plan(pair["plan"])
    assert changed > 20
    assert kept >= 0.95 * changed
