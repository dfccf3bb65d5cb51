"""Main program of a generator's own process: imports the generator's class, passes it an executor, and
reports how the generator ended.

``roadgpt_sbft.generator_process`` starts it. Messages to and from RoadGPT go through standard input and
output. What the generator prints goes to standard error, which is written to the generator's log.
"""

from __future__ import annotations

import importlib
import inspect
import logging
import os
import sys
import threading
import traceback
from pathlib import Path
from typing import IO, Any, Dict

from roadgpt_client import ClientError, Message, received, send
from roadgpt_inside import NAMES, ask


class TaskConnection:
    """The connection from this process to RoadGPT; all copies of an executor share it."""

    def __init__(self, hears: IO[bytes], tells: IO[bytes]) -> None:
        self._hears, self._tells = hears, tells
        self._owner = os.getpid()
        self.turn = threading.RLock()
        """Held while a test is executed."""

    def __deepcopy__(self, memo: Any) -> TaskConnection:
        return self

    def __reduce__(self) -> Any:
        raise TypeError(
            "the executor works only in the process that got it; let other processes send road points there"
        )

    def tell(self, message: Message) -> None:
        if os.getpid() != self._owner:
            raise RuntimeError(
                "tests are executed by the generator's first process; pass the road points to it"
            )
        send(self._tells, message)

    def hear(self) -> Message:
        """Returns the next message from RoadGPT; ends this process if RoadGPT has closed the connection."""
        message = received(self._hears.readline())
        if message is None:
            os._exit(1)
        return message

    def ask(self, message: Message) -> Message:
        self.tell(message)
        return self.hear()


def main() -> None:
    """Runs one generator and reports how it ended."""
    connection = _opened()
    task = connection.hear()
    level = logging.DEBUG if task["debug"] else logging.INFO
    logging.basicConfig(format="%(asctime)s %(levelname)-8s %(message)s", level=level)
    logging.getLogger("matplotlib.font_manager").disabled = True
    # RoadGPT's names first, then the current folder, as for scripts
    sys.path[:] = [str(NAMES), "", *[folder for folder in sys.path if folder != str(NAMES)]]
    sys.path += [task["module_path"]] if task["module_path"] else []
    try:
        ask("hello")  # loads all that answers need before the clock starts
    except ClientError as error:
        connection.tell({"op": "end", "how": "unasked", "said": str(error)})
        _leave()
    try:
        made = _class(task["module_name"], task["class_name"])
    except BaseException as error:  # a generator's file may raise anything, SystemExit included
        traceback.print_exc()
        connection.tell({"op": "end", "how": "unloadable", "said": _said(error)})
        _leave()
    connection.ask({"op": "ready"})
    connection.tell(_worked(made, task, connection))
    _leave()


def _opened() -> TaskConnection:
    """Returns the connection. It has its own file descriptors: afterwards, the generator reads no data from
    standard input, and what it prints goes to standard error."""
    connection = TaskConnection(os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb"))
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    return connection


def _class(module_name: str, class_name: str) -> Any:
    module = importlib.import_module(module_name)
    try:
        return getattr(module, class_name)
    except AttributeError:
        own = [name for name, value in vars(module).items() if inspect.isclass(value)]
        raise AttributeError(
            f"module {module_name} has no class '{class_name}'; it has {', '.join(own) or 'none'}"
        ) from None


def _worked(made: Any, task: Message, connection: TaskConnection) -> Message:
    from code_pipeline.beamng_executor import BeamngExecutor
    from code_pipeline.executors import OVER

    names = ("time_budget", "test_budget", "oob_tolerance", "max_speed_in_kmh", "debug")
    executor = BeamngExecutor(
        task["folder"], task["map_size"], **{name: task[name] for name in names}, connection=connection
    )
    try:
        executor.start()
        made(**_wanted(made, executor, task)).start()
    except SystemExit as error:
        forced = executor.timeout_forced or error.code == OVER
        return {"op": "end", "how": "budget" if forced else "exit", "said": f"{error.code}"}
    except BaseException as error:  # anything else that it may raise costs its run, and not its results
        traceback.print_exc()
        return {"op": "end", "how": "raised", "said": _said(error)}
    finally:
        registered = sys.modules.get("code_pipeline.test_generation_utils")
        if registered is not None:
            try:
                registered.ended()
            except BaseException:
                traceback.print_exc()
    return {"op": "end", "how": "done", "said": ""}


def _wanted(made: Any, executor: Any, task: Message) -> Dict[str, Any]:
    """Returns the arguments for the generator's constructor: the executor, the map size, and also the time
    budget if the constructor takes it, as in the competition of 2021."""
    given: Dict[str, Any] = {"executor": executor, "map_size": task["map_size"]}
    try:
        asked = inspect.signature(made).parameters
    except (TypeError, ValueError):
        return given
    if "time_budget" in asked:
        given["time_budget"] = executor.time_budget.get_remaining_real_time()
    return given


def _said(error: BaseException) -> str:
    """Describes an error in one line, with the innermost place in code that is not RoadGPT's or Python's."""
    not_its = (str(NAMES), str(Path(importlib.__file__).parent), "<")
    passed = traceback.extract_tb(error.__traceback__)
    frames = [frame for frame in passed if not frame.filename.startswith(not_its)]
    at = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}{at}: {error}"[:500]


def _leave() -> None:
    """Ends the process at once, without waiting for threads of the generator."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)
