"""Reports how far the car left its lane in tests that still count as passed because of the tolerance."""

from collections.abc import Sequence
from typing import NamedTuple

from roadgpt.campaign.record import Record
from roadgpt.plural import plural
from roadgpt.report.page.model import Table
from roadgpt.road import World
from roadgpt.study.chapters.wording import decimal, row, share_cell, share_of
from roadgpt.study.road_record import RoadRecord
from roadgpt.verdict import SEVERITIES, Severity, percent
from roadgpt.verdict.severity import MOSTLY, PARTLY

OLD = "An older version wrote this store without distances; the shares are there."


class Passed(NamedTuple):
    """The passed tests that have the same grade of ``verdict.severity``, such as "partly outside": their
    number, and the largest share and distance by which the car was outside its lane."""

    severity: Severity
    tests: int
    share: float
    """Largest fraction of the car's bounding box outside its lane, 0 to 1."""
    beyond: float | None
    """Largest distance of the car beyond the lane marking, metres; None if it is not known."""


def passed_roads(roads: Sequence[RoadRecord]) -> list[Passed]:
    """Groups the passed roads of a study by how far outside its lane the car was, and returns one ``Passed``
    per grade."""
    kept = [road.verdict for road in roads if road.outcome == "PASS" and road.verdict is not None]
    found = []
    for name in SEVERITIES:
        own = [verdict for verdict in kept if verdict.severity == name]
        far = [verdict.beyond for verdict in own if verdict.beyond is not None]
        share = max((verdict.max_oob for verdict in own), default=0.0)
        found.append(Passed(name, len(own), share, max(far, default=None)))
    return found


def passed_tests(record: Record) -> list[Passed]:
    """Groups the passed tests in a campaign's database by how far outside its lane the car was, and returns
    one ``Passed`` per grade."""
    rows = record.query(
        "SELECT (max_oob > ?) + (max_oob > ?), count(*), max(max_oob), max(beyond) FROM tests "
        "WHERE outcome = 'PASS' AND max_oob IS NOT NULL GROUP BY 1",
        (PARTLY, MOSTLY),
    )
    there = {SEVERITIES[at]: rest for at, *rest in rows}
    return [Passed(name, *there.get(name, (0, 0.0, None))) for name in SEVERITIES]


def outside_sentences(found: Sequence[Passed], world: World) -> list[str]:
    """Returns a sentence on how far the car was outside its lane, for the summary; empty if no test
    passed."""
    inside, partly, mostly = found
    every = sum(each.tests for each in found)
    if not every:
        return []
    if inside.tests == every and not inside.share:
        return [f"On all {every:,} roads that it passed, the car was never outside its lane."]
    far = [each.beyond for each in found if each.beyond is not None]
    beyond = f", {max(far):.2f} m beyond the marking" if far else ""
    tolerance = f"the tolerance of {percent(world.limits.oob_tolerance)}"
    within = "without a lane departure" if world.limits.lane_departure else f"within {tolerance}"
    most = f"{percent(max(each.share for each in found))} of the car{beyond}"
    return [
        f"Of {plural(every, 'road')} that the car passed, it was partly outside its lane on "
        f"{share_of(partly.tests, every)} and mostly outside on {share_of(mostly.tests, every)}, {within}: "
        f"at most {most}."
    ]


def outside_table(found: Sequence[Passed]) -> list[Table]:
    """Returns a table of how far outside its lane the car was in passed tests; empty if no test passed."""
    every = sum(each.tests for each in found)
    if not every:
        return []
    rows = [
        row(
            each.severity,
            each.tests,
            share_cell(each.tests / every),
            share_cell(each.share, percent(each.share)) if each.tests else None,
            decimal(each.beyond if each.tests else None),
        )
        for each in found
    ]
    heads = ["where the car was", "passed", "share", "outside at most", "beyond the marking, m"]
    is_old = any(each.tests and each.beyond is None for each in found)
    note = "Partly: more than 10 % of the car was outside its lane, up to half; mostly: more than half."
    caption = "How far outside its lane the car was where it passed"
    return [Table("outside", caption, heads, rows, f"{note} {OLD}" if is_old else note)]
