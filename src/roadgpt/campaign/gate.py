"""Decides whether results are good enough: by their outcomes, and compared with an earlier folder."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np
import scipy

from roadgpt.campaign.model import NumberedTest, Result
from roadgpt.drive.loading import without_folder
from roadgpt.errors import GateError, RoadGPTError, UsageError
from roadgpt.geometry.curve import Array
from roadgpt.plural import plural
from roadgpt.road import Road, World
from roadgpt.road.world import oracle_limits
from roadgpt.run import Outcome, Request, Run
from roadgpt.run.versions import judgement_of
from roadgpt.verdict import Verdict

LOSS = 0.1  # m; a road from files of two formats was driven with margins that differ by up to 0.041 m
STATIONS = 33  # at which two roads are compared
SAME = 0.001  # m; the formats of road files keep a road to 0.0001 m
BEST_FIRST: tuple[Outcome, ...] = get_args(Outcome)


class _Result(NamedTuple):
    outcome: Outcome
    margin: float | None
    settings: dict[str, Any]
    outline: Array
    among: tuple[Any, ...]
    """What makes it another test on the same road: where others are on it, name of the scenario, scene with
    the values of its parameters, recorded tracks, and seed."""


class Gate:
    """Receives the results of a command, and decides at the end whether they pass."""

    def __init__(
        self, out: Path | None, rules: Sequence[str], baseline: Path | None = None, loss: float | None = None
    ) -> None:
        """Reads the baseline: a campaign, a folder of runs or a run, but not ``out``. A rule is an outcome
        that no test may have, or a share such as '10%' of the driven tests that may FAIL. A margin that is
        smaller than in the baseline by at most ``loss`` metres is not worse."""
        if baseline is None and loss is not None:
            raise UsageError("--margin-loss is for --baseline; give both, or leave it out")
        if baseline and out and baseline.resolve() == out.resolve():
            raise UsageError(f"--baseline {baseline} is the folder for the results; name an earlier one")
        self._rules, self._baseline, self._loss = rules, baseline, LOSS if loss is None else loss
        self._counts: Counter[str] = Counter()
        self._before = [result for _, result in _results(baseline)] if baseline else []
        if baseline and not self._before:
            raise UsageError(f"{baseline} holds no test with a road; name another folder with --baseline")
        self._outlines: Any = baseline and scipy.spatial.cKDTree([each.outline for each in self._before])
        self._compared, self._found, self._differences = 0, set[int](), dict[str, str]()
        self.worse: dict[str, str] = {}  # the tests that are worse than in the baseline, by name, and in what

    def add(self, name: str, run: Run | None) -> str:
        """Counts a Run, or None for a file that cannot be read; returns in what it is worse, or nothing."""
        self._counts[run.outcome if run else "ERROR"] += 1
        if run is None or run.road is None or self._baseline is None:
            return ""
        its = (run.outcome, run.verdict, run.request, run.road, run.seed, run.versions)
        return self._compare(name, _result(*its))

    def add_folder(self, folder: Path) -> None:
        """Counts the tests of a campaign or a folder of runs."""
        from roadgpt.campaign.status import status_of

        self._counts.update(status_of(folder).outcomes)
        for name, result in _results(folder) if self._baseline else ():
            self._compare(f"{folder}/{name}", result)

    def _compare(self, name: str, now: _Result) -> str:
        near = self._outlines.query_ball_point(now.outline, SAME, p=np.inf)
        alike = [at for at in near if self._before[at].among == now.among]
        if not alike:
            return ""
        self._compared += 1
        self._found.update(alike)
        before = min(
            (self._before[at] for at in alike),
            key=lambda each: (len(_differences(each, now)), BEST_FIRST.index(each.outcome)),
        )
        there, here = (each.settings["avoidable"] or "the criterion of its kind" for each in (before, now))
        if now.among and there != here:
            raise UsageError(
                f"whether a collision is avoidable was judged by {there} in the baseline {self._baseline}, "
                f"and by {here} in {name}; give --avoidable as it was there, or another baseline"
            )
        self._differences |= _differences(before, now)
        worse = ""
        if BEST_FIRST.index(now.outcome) > BEST_FIRST.index(before.outcome):
            worse = f"{now.outcome}, in the baseline {before.outcome}"
        elif now.outcome == before.outcome and now.margin is not None and before.margin is not None:
            # a drive that ends where the car leaves its lane says little of how far it would go
            is_whole = now.outcome == "PASS" or all(each.settings["keep_driving"] for each in (before, now))
            if is_whole and before.margin - now.margin > self._loss:
                worse = f"margin {now.margin:+.3f} m, in the baseline {before.margin:+.3f} m"
        if worse:
            self.worse[name] = worse
        return worse

    @property
    def remark(self) -> str:
        """A sentence on what the results were compared with; empty without a baseline."""
        if self._baseline is None:
            return ""
        total, others = self._counts.total(), ", ".join(self._differences.values())
        told = f"{self._compared:,} of {plural(total, 'road')} compared with {self._baseline}"
        left = {"not there": total - self._compared, "of it not here": len(self._before) - len(self._found)}
        told += "".join(f"; {plural(count, 'road')} {where}" for where, count in left.items() if count)
        return f"{told}; it was driven with {others}" if others else told

    @property
    def sentence(self) -> str:
        """What fails the gate; empty if nothing does."""
        counts, total = self._counts, plural(self._counts.total(), "road")
        rules = [*self._rules, *["NOT TESTED"] * ("INVALID" in self._rules)]
        broken = [f"{counts[it]:,} of {total} {it}" for it in BEST_FIRST if it in rules and counts[it]]
        driven, failed = counts["PASS"] + counts["FAIL"], counts["FAIL"]
        shares = [rule.removesuffix("%") for rule in self._rules if rule.endswith("%")]
        for share in shares:
            if 100 * failed > Fraction(share) * driven:
                broken.append(f"{failed:,} of {plural(driven, 'driven road')} FAIL, more than {share} %")
        if not driven + counts["UNAVOIDABLE"] and (shares or "FAIL" in self._rules):
            broken.append(f"none of {total} was driven to a verdict, so nothing shows that it would not fail")
        if self._baseline and not self._compared:
            broken.append(f"no road is in the baseline {self._baseline}, so nothing was compared with it")
        if self.worse:
            first = "{} ({})".format(*next(iter(self.worse.items()))) + ", ..." * (len(self.worse) > 1)
            broken.append(f"{plural(len(self.worse), 'road')} worse than in {self._baseline}: {first}")
        return "; ".join(broken)

    def close(self) -> None:
        """Ends the command if its results, which are all saved, do not pass: raises GateError."""
        if self.sentence:
            raise GateError(self.sentence)


def _results(folder: Path) -> Iterator[tuple[NumberedTest, _Result]]:
    from roadgpt.campaign.folder_record import open_record

    with open_record(folder) as record:
        for cell in record.cells():
            for its in record.results(cell.name):
                with suppress(RoadGPTError):  # no road can be built from the design
                    if found := record.road(cell, its):
                        road, request = found
                        name = NumberedTest(cell.name, its.number)
                        versions = record.versions(request.setup.driver)
                        yield name, _result(its.outcome, its, request, road, record.seed(its), versions)


def _result(
    outcome: Outcome, found: Verdict | Result | None, request: Request, road: Road, seed: int,
    versions: Mapping[str, str],
) -> _Result:  # fmt: skip
    setup, scene = request.setup, request.world.scene
    among = (setup.scenario.partition(" ")[0], request.world.values()["scene"], Path(setup.tracks).name, seed)
    is_among = setup.scenario or setup.tracks or scene.actors or scene.has_flow
    margin = None if found is None or found.cause == "collision" else found.margin
    settings = _settings(request) | {"rules of judgement": judgement_of(versions)}
    return _Result(outcome, margin, settings, _outline(road), among if is_among else ())


def _outline(road: Road) -> Array:
    """Returns points on both edges of a road's lanes (of 4 m if it has no own), and its length, in metres."""
    s = np.linspace(0.0, road.length, STATIONS)
    edges = World().profile_of(road).edges(s)
    return np.concatenate([road.at(s, edges.left).ravel(), road.at(s, edges.right).ravel(), [road.length]])


def _settings(request: Request) -> dict[str, Any]:
    """Returns what a result depends on beside road and seed."""
    setup, limits = request.setup, request.world.limits
    own = setup.model_dump(include={"simulator", "keep_driving", "rules"}) | request.world.values()
    own = {name: value for name, value in own.items() if name not in oracle_limits()}
    speed, driver = f"{limits.speed_limit * 3.6:g} km/h", without_folder(setup.driver)
    return own | {"driver": driver, "oracle": limits.oracle, "speed_limit": speed}


def _differences(there: _Result, here: _Result) -> dict[str, str]:
    both = [(name, value, here.settings[name]) for name, value in there.settings.items()]
    return {name: f"{name} {value} (here {now})" for name, value, now in both if value != now}
