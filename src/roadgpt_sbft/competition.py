"""Defines the Competition, which runs one generator, test after test, until the generator ends or its budget
is used up.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from roadgpt.brief.model import Frozen
from roadgpt.check import Finding
from roadgpt.errors import PartError, RoadGPTError, UsageError
from roadgpt.road import Road, World
from roadgpt.run import Draw, Request, Run, Seconds, Setup, check_parts, prove
from roadgpt.run.model import MOST, given_up
from roadgpt.stopping import look
from roadgpt_sbft.client import Message
from roadgpt_sbft.generator_process import GeneratorExitedError, GeneratorProcess
from roadgpt_sbft.results import LOG, Experiment, Results, new_folder
from roadgpt_sbft.validator import TOO_FEW

USUAL = World().changed(map_size=200.0, oracle="thesis")
GROUND = 0.0  # m: the competition's roads are level, and points without heights are at this height
PLAIN = Setup(rules="sbft", driver="beamng_like")
WARM = [[60.0, 100.0], [100.0, 100.0], [140.0, 100.0]]  # a road to compile the simulator on
LARGEST_ID = 999_999_999
LOADING = 120.0  # s of wall time for a generator's module to be imported

NO_PYTHON = "{} does not run generators: {}; is it a Python of 3.8 or newer? Name another one with --python"

WRONG_TYPE = "Wrong type"


class Ending(Frozen):
    """How and why a generator ended."""

    how: Literal["done", "budget", "exit", "raised", "hung", "died", "unloadable", "unasked"]
    sentence: str

    @property
    def is_fine(self) -> bool:
        """Whether the generator finished by itself or used up its budget."""
        return self.how in ("done", "budget")

    @property
    def is_of_a_generator(self) -> bool:
        """Whether the generator was loaded before the end, in an interpreter that can run generators."""
        return self.how not in ("unloadable", "unasked")


@dataclass
class Competition:
    """A generator and its tests. Iterating over it runs the generator and yields each test as a Run, after
    the files of the test have been written."""

    experiment: Experiment
    request: Request
    folder: Path
    results: Results
    ending: Ending | None = None
    """How the generator ended; None while it is running."""
    tests: int = 0
    _deadline: float = field(default=0.0, repr=False)
    _lost: int = field(default=0, repr=False)  # drives in a row
    _is_begun: bool = field(default=False, repr=False)
    """Whether there are results or a log to keep."""

    def __iter__(self) -> Iterator[Run]:
        try:
            host = GeneratorProcess(self.folder / LOG, self.experiment.python)
        except UsageError:
            self.results.take_away(LOG)
            raise
        try:
            self._begin(host)
            yield from self._work(host)
        except GeneratorExitedError as error:
            self.ending = self._gone(error.status)
        except OSError as error:
            raise RoadGPTError(
                f"cannot write into {self.folder}: {error.strerror or error}; make room there"
            ) from error
        finally:
            host.stop()
            if not self._is_begun:
                self.results.take_away(LOG)
        if self.ending is not None and not self.ending.is_of_a_generator:
            raise UsageError(self.ending.sentence)

    def _begin(self, host: GeneratorProcess) -> None:
        """Loads the generator, and prepares the simulator before the clock starts."""
        task = self.experiment.model_dump(exclude={"python", "patience", "grace"})
        world = self.request.world
        map_size = world.site.map_size
        whole = int(map_size) if map_size.is_integer() else map_size
        told = {
            "oob_tolerance": world.limits.oob_tolerance,
            "max_speed_in_kmh": round(world.limits.speed_limit * 3.6, 6),
        }
        host.tell({**task, **told, "map_size": whole, "folder": str(self.folder.resolve())})
        first = prove(Road.through(WARM), 0, world, self.request.setup)
        if first.outcome == "ERROR":
            raise RoadGPTError(f"not even a straight road can be driven: {first.description}")
        heard = host.hear(LOADING)
        if heard is None:
            self._is_begun = True
            self.ending = Ending(how="hung", sentence=f"not loaded within {LOADING:g} s")
        elif heard["op"] == "end":
            self.ending = self._ended(heard)
        else:
            self._is_begun = True
            self._deadline = time.monotonic() + (self.experiment.time_budget or float("inf"))
            host.tell({"go": True})

    def _work(self, host: GeneratorProcess) -> Iterator[Run]:
        while self.ending is None:
            look()
            heard = host.hear(self._wait())
            if heard is None:
                self.ending = self._silent()
            elif heard.get("op") == "end":
                self.ending = self._ended(heard)
            elif heard.get("op") == "test":
                yield from self._test(heard, host.tell)

    def _test(self, asked: Message, answer: Callable[[Message], None]) -> Iterator[Run]:
        """Drives one test; none, and none that counts, once the budget is used up."""
        if self._is_over:
            answer({"is_over": True})
            return
        run = run_test(
            asked["points"], self._number(asked["id"]), self.request, asked["generating"], asked["is_test"]
        )
        if time.monotonic() >= self._deadline:
            answer({"is_over": True})
            return
        self.tests += 1
        test = self.results.write(run)
        answer(
            {
                "is_over": False,
                "is_valid": run.is_valid,
                "message": run.validation_message,
                "outcome": run.outcome,
                "description": test.get("description", run.description),
                "records": test.get("execution_data", []),
                "features": test.get("features", {}),
                "seconds": run.seconds.drive,
            }
        )
        yield run
        self._lost = self._lost + 1 if run.is_lost else 0
        if self._lost >= MOST:
            raise given_up(
                run.description,
                f"the tests until then are in {self.folder}; a generator cannot be resumed, so repair the "
                "simulator and start it again",
            )

    def _number(self, asked: Any) -> int:
        """Returns the generator's own number of a test if it is valid and unused, else the next free one."""
        is_number = isinstance(asked, int) and not isinstance(asked, bool) and 0 < asked <= LARGEST_ID
        numbers = self.results.numbers
        return asked if is_number and asked not in numbers else max(numbers, default=0) + 1

    @property
    def _has_tests_left(self) -> bool:
        return self.experiment.test_budget is None or self.tests < self.experiment.test_budget

    @property
    def _is_over(self) -> bool:
        return not self._has_tests_left or time.monotonic() >= self._deadline

    def _wait(self) -> float:
        """Returns the seconds within which the generator must send its next message."""
        left = self._deadline - time.monotonic() + self.experiment.grace
        return min(left, self.experiment.patience if self._has_tests_left else self.experiment.grace)

    def _silent(self) -> Ending:
        if self._is_over:
            return Ending(how="budget", sentence="budget used up; it did not notice, and was stopped")
        patience = f"{self.experiment.patience:g} s"
        return Ending(how="hung", sentence=f"it submitted no test within {patience}, and was stopped")

    def _gone(self, status: int | None) -> Ending:
        if not self._is_begun and self.experiment.python is not None:
            return Ending(how="unasked", sentence=NO_PYTHON.format(self.experiment.python, _died(status)))
        self._is_begun = True
        return Ending(how="died", sentence=_died(status))

    def _ended(self, heard: Message) -> Ending:
        said = heard.get("said", "")
        name = f"{self.experiment.class_name} of {self.experiment.module_name}"
        sentences = {
            "done": "finished by itself",
            "budget": "budget used up",
            "exit": f"it called sys.exit({said})",
            "raised": f"it raised {said}",
            "unloadable": f"the generator {name} cannot be loaded: {said}; check --module-name, --class-name "
            "and --module-path",
        }
        how = heard.get("how", "died")
        return Ending(how=how, sentence=sentences.get(how, said))


def compete(
    experiment: Experiment,
    world: World = USUAL,
    setup: Setup = PLAIN,
    seed: int = 0,
    out: Path | None = None,
    draw: Draw | None = None,
) -> Competition:
    """Runs a test generator and drives its roads. The generator starts when you iterate over the returned
    Competition. Roads are level, and the competition's rules apply instead of those of the setup. The empty
    or new folder ``out`` is by default one under ``results``, with the competition's name; ``draw``, such as
    a ``report.Drawing``, draws every test.
    """
    if experiment.time_budget is None and experiment.test_budget is None:
        raise UsageError("a generator needs a budget; say --time-budget SECONDS or --test-budget N")
    setup = setup.model_copy(update={"rules": "sbft"})
    world = world.changed(z_floor=GROUND)
    check_parts(setup, world)
    request = Request(seed=seed, world=world, setup=setup)
    folder, made = new_folder(experiment, out)
    results = Results(folder, request, made, draw)
    results.describe(experiment)
    return Competition(experiment, request, folder, results)


def _died(status: int | None) -> str:
    if status is not None and status < 0:
        return f"its process was ended by signal {-status}"
    return f"its process ended without an answer (exit status {status})"


def run_test(points: Any, index: int, request: Request, generating: float, is_test: bool) -> Run:
    """Validates and drives one test of control points ``(n, 2)`` in metres, which took ``generating`` seconds
    to make. If ``is_test`` is False, the generator submitted something else, and the Run is invalid."""

    def invalid(message: str) -> Run:
        findings, seconds = (Finding("sbft", message),), Seconds(generating)
        return Run(request, index, request.seed, "INVALID", message, findings=findings, seconds=seconds)

    if not is_test:
        return invalid(WRONG_TYPE)
    table = np.asarray(points, float).reshape(-1, 2)
    if len(table) < 2:
        return invalid(TOO_FEW)
    try:
        road = Road.through(table)
    except RoadGPTError as error:
        return invalid(str(error))
    try:
        run = prove(road, request.seed, request.world, request.setup, index)
    except PartError:
        raise
    except Exception as error:  # an error costs only the road on which it happens
        said = str(error) if isinstance(error, RoadGPTError) else f"the test failed: {error!r}"
        run = Run(request, index, request.seed, outcome="ERROR", description=said, road=road)
    return replace(run, request=request, seconds=Seconds(generating, run.seconds.drive))
