"""Crests and dips inside turns: measured in the exported OpenDRIVE, in its curvature and its elevation."""

import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import roadgpt
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.plan import PlanReader
from roadgpt.brief.sentence import sentence
from roadgpt.errors import BriefError, RoadGPTError
from roadgpt.export import save
from roadgpt.road import World
from roadgpt_edit.editing import edit
from tables import rows

LEAST = 0.25  # m above both ends of the turn: 10 m at 3 %, and a little for rounding
STEP = 0.25  # m


def bumps(file: Path) -> list[tuple[str, float, str]]:
    """Returns side, degrees and "crest", "dip" or "" of each turn of the roads outside junctions."""
    out = []
    for road in ET.parse(file).getroot().iter("road"):
        if road.get("junction") != "-1":
            continue
        s = np.arange(0.0, float(road.get("length", "")), STEP)
        k, z = np.zeros_like(s), np.zeros_like(s)
        for piece in road.iter("geometry"):
            start, length = float(piece.get("s", "")), float(piece.get("length", ""))
            here, (shape,) = (s >= start) & (s < start + length), [*piece]
            ends = [float(shape.get(name, shape.get("curvature", 0.0))) for name in ("curvStart", "curvEnd")]
            k[here] = ends[0] + (ends[1] - ends[0]) * (s[here] - start) / length
        for cubic in road.iter("elevation"):
            start, *abcd = (float(cubic.get(name, "")) for name in "sabcd")
            z[s >= start] = np.polyval(abcd[::-1], s[s >= start] - start)
        marks = np.flatnonzero(np.abs(k) > 1 / 300)
        cuts = [i + 1 for i, (a, b) in enumerate(pairwise(marks)) if k[a] * k[b] < 0 or (b - a) * STEP >= 8]
        for turn in np.split(marks, cuts):
            if not len(turn) or abs(np.degrees(k[turn].sum() * STEP)) < 10:
                continue
            own, quarter = z[turn[0] : turn[-1] + 1], len(turn) / 4
            high, low = own.max() - max(own[0], own[-1]), min(own[0], own[-1]) - own.min()
            at, what = (own.argmax(), "crest") if high > low else (own.argmin(), "dip")
            is_bump = max(high, low) > LEAST and quarter <= at <= len(own) - quarter
            side = "left" if k[turn].sum() > 0 else "right"
            out.append((side, abs(float(np.degrees(k[turn].sum() * STEP))), what if is_bump else ""))
    return out


def random_plan(number: int) -> tuple[str, list[str]]:
    """Returns a plan, and what lies in each of its turns in driving order ("" if nothing is asked)."""
    rng = np.random.default_rng(number)
    pick = lambda *of: str(rng.choice(of))  # noqa: E731
    clauses, wanted = [], list[str]()
    for _ in range(rng.integers(1, 4)):
        bump, count = pick("crest", "crest", "dip", "dip", ""), int(rng.choice([1, 1, 1, 2, 3]))
        kind = pick("turn", "turn", "turn", "hairpin", "u_turn")
        shape = "" if kind != "turn" else pick("", "sharp", "60", "90 r40", f"r{rng.integers(25, 90)}")
        own = pick("", "", "climb=1.5", "pct=5", "climb=1..2") if bump else pick("", "up", "flat")
        side = pick("", "left", "right")
        clauses.append(f"{kind} x{count} {side} {shape} {bump} {own}")
        wanted += [bump] * count
        if rng.random() < 0.3:
            clauses.append(pick("straight 60", "straight up", "crest", "straight flat"))
    whole = pick("", "", "alike", "climb=3", "len=500..900", "hills=2..")
    line = f"{'; '.join(clauses)} | {whole}" if whole else "; ".join(clauses)
    if number % 5 == 4 and "len" not in whole:
        line = f"straight 50 // crossroads left // {line} // t_junction right"
    return line, wanted


def is_as_asked(line: str, wanted: list[str], seed: int, folder: Path) -> bool | str:
    """Returns whether the road of a plan has its crests and dips; the sentence if none can be built."""
    try:
        brief = PlanReader().read(line)
        world = World().changed(map_size=600)
        design = roadgpt.draft(brief, world, seed=seed)
        road = roadgpt.build_route(design, world) if brief.junctions else roadgpt.build(design)
    except RoadGPTError as error:
        return str(error)
    file = save(road, folder, ["opendrive"], world)[-1]
    found = [what for _, _, what in bumps(file)]
    if brief.junctions:  # beside the road are others, which are level
        found = [what for what in found if what]
        wanted = [what for what in wanted if what]
        return all(found.count(what) >= wanted.count(what) for what in ("crest", "dip"))
    return len(found) == len(wanted) and all(b in ("", a) for a, b in zip(found, wanted, strict=True))


@pytest.mark.parametrize("number", [0, 1, 3, 5, 7, 14, 19, 24, 29])
def test_the_summit_lies_in_the_middle_half_of_the_turn(number: int, tmp_path: Path) -> None:
    line, wanted = random_plan(number)
    assert is_as_asked(line, wanted, 1, tmp_path) is True


@pytest.mark.parametrize(("line", "says"), rows(__file__, "what_cannot_be_is_said_in_one_sentence"))
def test_what_cannot_be_is_said_in_one_sentence(line: str, says: str) -> None:
    with pytest.raises(BriefError, match=says) as caught:
        PlanReader().read(line)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("line", "said"), rows(__file__, "a_plan_is_said_and_written_back"))
def test_a_plan_is_said_and_written_back(line: str, said: str) -> None:
    brief = PlanReader().read(line)
    assert said in sentence(brief)
    assert read_plan(plan(brief)).clauses == brief.clauses


@pytest.mark.parametrize(
    ("change", "keeps"),
    [
        ("turn 2: angle =120", True),
        ("turn 2: radius x1.5", True),
        ("straight 1: length +20", True),
        ("turn 2: slope up =5", False),
        ("turn 2: slope flat", False),
    ],
)
def test_an_edit_keeps_the_crest_or_says_that_it_is_gone(change: str, keeps: bool, tmp_path: Path) -> None:
    world = World().changed(map_size=500)
    line = "turn right 40; straight 60; turn left 60 r60 crest climb=2; straight 60; turn right 50"
    brief = PlanReader().read(line)
    design = roadgpt.draft(brief, world, seed=2)
    edited = edit(design, read_change_plan(change), world)
    file = save(roadgpt.build(edited.design), tmp_path, ["opendrive"], world)[-1]
    assert (bumps(file)[1][2] == "crest") is keeps
    assert any("the crest in it is gone" in told for told in edited.changes) is not keeps
