"""A generator's own process: finds its class, hands it an executor, and tells how it ended.

Started by ``roadgpt.sbft.host``. Standard input and output are the line to us; what the generator prints goes
to standard error, which is its log.
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

from roadgpt_client import Message, RoadGPTError, received, send
from roadgpt_inside.asking import ask

NAMES = Path(__file__).parent.parent  # packages of the competition's names, and this one
OVER = 123  # exit status with which the competition ends a generator that asks for more than its budget


class Line:
    """This end of the line. There is one, which copies of an executor share."""

    def __init__(self, hears: IO[bytes], tells: IO[bytes]) -> None:
        self._hears, self._tells = hears, tells
        self._owner = os.getpid()
        self.turn = threading.RLock()
        """Held by whoever executes a test."""

    def __deepcopy__(self, memo: Any) -> Line:
        return self

    def tell(self, message: Message) -> None:
        """Say something.

        Raises:
            RuntimeError: another process was forked from the one at this end.
        """
        if os.getpid() != self._owner:
            raise RuntimeError(
                "tests are executed by the generator's first process; bring the road points there"
            )
        send(self._tells, message)

    def hear(self) -> Message:
        """The next message; where nobody is at the other end any more, this process ends."""
        message = received(self._hears.readline())
        if message is None:
            os._exit(1)
        return message

    def ask(self, message: Message) -> Message:
        """Say something, and hear what it is answered."""
        self.tell(message)
        return self.hear()


def main() -> None:
    """Work off one task."""
    line = _opened()
    task = line.hear()
    level = logging.DEBUG if task["debug"] else logging.INFO
    logging.basicConfig(format="%(asctime)s %(levelname)-8s %(message)s", level=level)
    logging.getLogger("matplotlib.font_manager").disabled = True
    # ours first, then the folder in which one is, as where scripts are started
    sys.path[:] = [str(NAMES), "", *[folder for folder in sys.path if folder != str(NAMES)]]
    sys.path += [task["module_path"]] if task["module_path"] else []
    try:
        ask("hello")  # what it takes to answer is ready before the clock runs
    except RoadGPTError as error:
        line.tell({"op": "end", "how": "unasked", "said": str(error)})
        _leave()
    try:
        made = _class(task["module_name"], task["class_name"])
    except BaseException as error:  # a generator's file may raise anything, SystemExit included
        traceback.print_exc()
        line.tell({"op": "end", "how": "unloadable", "said": _said(error)})
        _leave()
    line.ask({"op": "ready"})
    line.tell(_worked(made, task, line))
    _leave()


def _opened() -> Line:
    """The line, on file numbers of its own: whatever the generator reads or prints goes elsewhere."""
    line = Line(os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb"))
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    return line


def _class(module_name: str, class_name: str) -> Any:
    module = importlib.import_module(module_name)
    try:
        return getattr(module, class_name)
    except AttributeError:
        own = [name for name, value in vars(module).items() if inspect.isclass(value)]
        raise AttributeError(
            f"module {module_name} has no class '{class_name}'; it has {', '.join(own) or 'none'}"
        ) from None


def _worked(made: Any, task: Message, line: Line) -> Message:
    """Let the generator work; how it ended."""
    from code_pipeline.beamng_executor import BeamngExecutor

    names = ("time_budget", "test_budget", "oob_tolerance", "max_speed_in_kmh", "debug")
    executor = BeamngExecutor(
        task["folder"], task["map_size"], **{name: task[name] for name in names}, line=line
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
        _settle()
    return {"op": "end", "how": "done", "said": ""}


def _settle() -> None:
    """Call what the generator registered for its end."""
    registered = sys.modules.get("code_pipeline.test_generation_utils")
    if registered is not None:
        try:
            registered.ended()
        except BaseException:
            traceback.print_exc()


def _wanted(made: Any, executor: Any, task: Message) -> Dict[str, Any]:
    """The arguments of its constructor: those of today, and the budget where it is one of 2021."""
    given: Dict[str, Any] = {"executor": executor, "map_size": task["map_size"]}
    try:
        asked = inspect.signature(made).parameters
    except (TypeError, ValueError):
        return given
    if "time_budget" in asked:
        given["time_budget"] = executor.time_budget.get_remaining_real_time()
    return given


def _said(error: BaseException) -> str:
    """An error in a line, with the innermost place of it that is not ours."""
    not_its = (str(NAMES), str(Path(importlib.__file__).parent), "<")
    passed = traceback.extract_tb(error.__traceback__)
    frames = [frame for frame in passed if not frame.filename.startswith(not_its)]
    at = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}{at}: {error}"[:500]


def _leave() -> None:
    """End at once: threads of the generator that still work are not waited for."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)
