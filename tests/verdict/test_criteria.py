"""Criteria: each cause and each kind of incident is one entry, and one more costs one more."""

from typing import Any, get_args

import pytest

from roadgpt.road import World
from roadgpt.verdict import criteria, judge
from roadgpt.verdict.criteria import CRITERIA, Criterion, Judged
from roadgpt.verdict.verdict import Cause, Incident, IncidentKind
from verdict.test_verdict import STRAIGHT, drive_at

WORLD = World()


def test_every_cause_and_every_kind_of_incident_is_one_criterion() -> None:
    assert sorted(each.name for each in CRITERIA) == sorted({*get_args(Cause), *get_args(IncidentKind)})
    assert {each.name for each in CRITERIA if each.failed} == {*get_args(Cause)}
    assert {each.name for each in CRITERIA if each.find} == {*get_args(IncidentKind)}
    assert all(each.source for each in CRITERIA)
    assert all(bool(each.said) == bool(each.find) for each in CRITERIA)


@pytest.mark.parametrize("t", [[-2.0] * 7, [-2.0, -2.0, 0.5, 0.9]])
def test_a_criterion_is_one_entry(t: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    def slow(case: Judged) -> list[Incident]:
        times = case.drive["time"][case.drive["speed"] < 20.0]
        return case.began(kind, times[:1].tolist())

    kind: Any = "dawdling"
    one = Criterion(kind, "nobody's", slow, "below 72 km/h", "dawdled {reached} {fast}", "Car dawdled")
    monkeypatch.setattr(criteria, "CRITERIA", (*CRITERIA, one))
    monkeypatch.setitem(criteria.NAMED, kind, one)
    verdict = judge(STRAIGHT, drive_at(t, ended="goal"), WORLD)
    is_out = max(t) > 0  # on a road alone, the lane decides whatever else was before
    assert verdict.cause == ("out of lane" if is_out else "dawdling")
    assert verdict.outcome == "FAIL"
    if not is_out:
        assert verdict.description.startswith("dawdled after 2 m at 36 km/h")
        assert verdict.sbft_description == "Car dawdled"
        assert verdict.at_time == 0.0
