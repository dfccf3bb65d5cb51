"""The size of a roundabout whose outer diameter is given in metres."""

import json
import re
from pathlib import Path

import pytest

from roadgpt.brief import check
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.ring_sizes import least_diameter, with_diameters, with_ring_sizes
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.vocabulary import plan_of, tokens_of
from roadgpt.brief.sentence import sentence
from roadgpt.design import draft
from roadgpt.errors import BriefError
from roadgpt.network import network_made_from
from roadgpt.road import World

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
        (
            "deux ronds-points de 50 m de diamètre, tout droit aux deux",
            "roundabout straight mini // roundabout straight normal",
            "roundabout straight large // roundabout straight large",
        ),
        (
            "first exit at one roundabout, second at the other; both are 20 m across",
            "roundabout exit= 1 // roundabout exit= 2",
            "roundabout mini exit=1 // roundabout mini exit=2",
        ),
        (
            "a roundabout 20 m across, then another roundabout",
            "roundabout // roundabout",
            "roundabout // roundabout",
        ),
        ("una rotonda con isla de 36 m de diámetro", "roundabout", "roundabout"),
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
            if not re.search(r"mini|normal|large", pair["plan"]):
                continue
            text = slotted(pair["text"])
            tokens = tokens_of(pair["plan"], text.slots)
            if not tokens:
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


@pytest.mark.parametrize(
    ("text", "plan", "wanted"),
    [
        ("a roundabout 36 m across, third exit", "roundabout normal exit=3", [36]),
        ("a crossroads, then a roundabout 40 m across", "crossroads // roundabout normal", [None, 40]),
        ("a roundabout 30 m across, then one 60 m across", "roundabout normal // roundabout large", [30, 60]),
        ("a roundabout 20 m across", "roundabout mini", [None]),
        ("a roundabout with 5 arms 30 m across", "roundabout normal arms=5", [None]),
        ("a roundabout with 5 arms 36 m across", "roundabout normal arms=5", [36]),
        ("a two-lane roundabout 30 m across", "roundabout normal lanes=2", [None]),
        ("a roundabout with an island of 30 m diameter", "roundabout d=30", [None]),
    ],
)
def test_a_diameter_is_required_where_there_is_room(text: str, plan: str, wanted: list[float | None]) -> None:
    said = slotted(text)
    brief = with_diameters(read_plan(plan), tokens_of(plan, said.slots) or (), said)
    assert [each.outer and each.outer.lo for each in brief.junctions] == wanted


@pytest.mark.parametrize(
    "rest", ["", " arms=3", " arms=4", " arms=5", " arms=6", " lanes=2", " arms=6 lanes=2"]
)
def test_from_the_least_diameter_on_every_draft_has_it(rest: str) -> None:
    brief = read_plan(f"roundabout{rest}")
    least = least_diameter(brief.junctions[0], brief.stretches)
    for across in (least, 66.0):
        asked = read_plan(f"roundabout{rest} outer={across:g}")
        route = network_made_from(draft(asked, World(), seed=1), World())
        (ring,) = route.network.roundabouts
        assert 2 * (ring.radius + ring.width) == pytest.approx(across, abs=0.5)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("roundabout mini outer=40", "a mini roundabout is 13 to 25 m across, not 40 m"),
        ("roundabout r=12 outer=40", "the radius of the island and the outer diameter are given"),
        ("roundabout outer=90", "a roundabout is 18 to 70 m across, not 90 m"),
        ("crossroads outer=40", "a crossroads has no outer, only a roundabout has"),
    ],
)
def test_diameters_that_cannot_be_are_refused(line: str, said: str) -> None:
    with pytest.raises(BriefError, match=said):
        check(read_plan(f"// {line} //"))


def test_a_plan_with_a_diameter_is_written_as_it_was_read() -> None:
    line = "roundabout exit=2 outer=36"
    assert plan(read_plan(line)) == line
    assert "36 metres across" in sentence(read_plan(line))
