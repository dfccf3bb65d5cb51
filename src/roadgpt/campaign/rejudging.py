"""Judges stored drives again by the rules of today: which outcomes would be others, and why.

A drive is judged with the road, the scene and the tracks of others that are stored with it. Nothing is
driven, and no driver is loaded."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import NumberedTest
from roadgpt.errors import SceneError, UsageError
from roadgpt.run import REFUSED, Run, judged
from roadgpt.run.versions import judgement_of


class Rejudged(NamedTuple):
    """A stored outcome, and that of today."""

    name: NumberedTest
    version: int
    """The version of the rules by which it was judged."""
    stored: str
    today: str
    """Empty if the drive cannot be judged again."""
    why: str
    """What the sentences of both verdicts say alone, if the outcomes differ; or why it cannot be judged."""
    has_scene: bool = True
    """Whether its scene is stored; that of a scenario in a campaign is the one of today's catalogue."""


def rejudge(folder: Path) -> Iterator[Rejudged]:
    """Yields each test of a campaign, of a folder of runs or of a run that was judged, judged again."""
    with open_record(folder) as record:
        for name in record.tests():
            try:
                run = record.run(*name)
                if run.drive is not None and run.verdict is not None:
                    has_scene = record.keeps_runs or not run.request.setup.scenario
                    yield _again(name, run, has_scene)
            except UsageError as error:
                yield Rejudged(name, 0, "", "", str(error))


def _again(name: NumberedTest, run: Run, has_scene: bool) -> Rejudged:
    try:
        again = judged(run)
    except SceneError as error:
        again = replace(run, outcome="INVALID", description=f"{REFUSED}{error}", verdict=None)
    stored, today = _outcome(run), _outcome(again)
    was, now = run.description.split("; "), again.description.split("; ")
    before, after = ("; ".join(part for part in a if part not in b) for a, b in ((was, now), (now, was)))
    why = f"it was: {before or run.description}; today: {after or again.description}"
    version = judgement_of(run.versions)
    return Rejudged(name, version, stored, today, why if today != stored else "", has_scene)


def _outcome(run: Run) -> str:
    cause = run.verdict.cause if run.verdict else None
    return f"{run.outcome} ({cause})" if cause and run.outcome != "UNAVOIDABLE" else run.outcome
