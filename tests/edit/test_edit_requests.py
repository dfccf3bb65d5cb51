"""Plans of changes with truths written by hand: how many are honoured, and is the rest left alone?"""

import importlib.util
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from edit_truth import changed_besides, misses, ours, requests, roads, theirs
from roadgpt import check
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.plan import read_plan
from roadgpt.brief.words import SURE
from roadgpt.design import draft
from roadgpt.errors import EditError, UnclearPlaceError
from roadgpt.road import Design, World, build
from roadgpt_edit.editing import Edited, edit

REFEREE = Path(__file__).resolve().parents[3] / "shared" / "referee.py"
HONOURED, LEFT_ALONE = 0.95, 0.99


@cache
def answers() -> tuple[tuple[dict[str, Any], Design, Edited | str], ...]:
    """Every second request, if it has a plan, with its road, and the changed one or the refusal."""
    known, out = roads(), []
    for row in requests()[::2]:
        if row["plan"] == "!":
            continue
        old = known[row["road"]]
        try:
            out.append((row, old, edit(old, read_change_plan(row["plan"]), World())))
        except EditError as error:
            out.append((row, old, str(error)))
    return tuple(out)


def referee() -> ModuleType | None:
    """The outside judge, where it lies beside the project."""
    if not REFEREE.is_file():
        return None
    spec = importlib.util.spec_from_file_location("referee", REFEREE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def wrong(row: dict[str, Any], old: Design, answer: Edited | str, judge: ModuleType | None) -> str:
    """What is wrong with an answer; empty where the request was honoured."""
    if "refused" in row:
        is_told = isinstance(answer, str) and all(word in answer for word in row["refused"])
        return "" if is_told else f"not refused as it should be: {answer}"
    if isinstance(answer, str):
        return answer
    got = answer.design
    findings = check.inspect(build(got), None, answer.world)
    said = [finding.sentence for finding in findings] + misses(row, old, got, ours)
    if judge is not None:
        with suppress(IndexError):  # this referee cannot measure a road that turns up to its very end
            said += misses(row, old, got, lambda points: theirs(judge, points))
    return "; ".join(said)


def test_requests_are_honoured() -> None:
    judge = referee()
    bad = [f"{row['road']} {row['request']}: {said}" for row, *rest in answers()
           if (said := wrong(row, *rest, judge))]  # fmt: skip
    assert len(bad) <= (1 - HONOURED) * len(answers()), "\n".join(bad)


def test_what_nobody_spoke_of_stays_as_it_was() -> None:
    changed = [
        (row["road"], row["request"], besides)
        for row, old, got in answers()
        if isinstance(got, Edited) and (besides := changed_besides(old, got.design, row["touched"]))
    ]
    assert len(changed) <= (1 - LEFT_ALONE) * len(answers()), changed


def test_no_changed_road_is_against_the_rules() -> None:
    for row, _, got in answers():
        if isinstance(got, Edited):
            assert check.inspect(build(got.design), None, got.world) == (), row["request"]


def test_the_descent_of_a_road_that_falls_all_the_way_is_the_whole_road() -> None:
    design = draft(
        read_plan("turn right deg=80; straight len=40; turn left deg=60 | down pct=6"), World(), seed=2
    )
    unclear = replace(read_change_plan("straight down: slope x0.5"), others=("road: slope x0.5",))
    for request in ("dimezza la pendenza della discesa", unclear):
        edited = edit(design, request, World())
        assert [segment.incline for segment in edited.design.segments] == pytest.approx(
            [segment.incline / 2 for segment in design.segments], abs=0.11
        )
    assert edited.confidence < SURE
    with pytest.raises(UnclearPlaceError, match=r"could be any of"):
        edit(design, read_change_plan("straight: length more"), World())
