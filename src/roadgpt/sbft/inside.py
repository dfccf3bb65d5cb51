"""A generator's own process: finds its class, hands it an executor, and tells how it ended.

Started by ``roadgpt.sbft.host``. Standard input and output are the line to us; what the generator prints goes
to standard error, which is its log.
"""

import importlib
import inspect
import logging
import os
import sys
import traceback
from pathlib import Path
from typing import IO, Any

from roadgpt.sbft.executor import OVER, AbstractTestExecutor
from roadgpt.sbft.line import Message, received, send

NAMES = Path(__file__).with_name("names")  # packages of the competition's names


class Line:
    """This end of the line."""

    def __init__(self, hears: IO[bytes], tells: IO[bytes]) -> None:
        self._hears, self._tells = hears, tells

    def tell(self, message: Message) -> None:
        """Say something."""
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
    sys.path[:0] = [str(NAMES)]
    sys.path += [task["module_path"]] if task["module_path"] else []
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
    executor = AbstractTestExecutor(
        task["folder"],
        task["map_size"],
        task["time_budget"],
        task["test_budget"],
        line.ask,
        task["debug"],
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
    return {"op": "end", "how": "done", "said": ""}


def _wanted(made: Any, executor: AbstractTestExecutor, task: Message) -> dict[str, Any]:
    """The arguments of its constructor: those of today, and the budget where it is one of 2021."""
    given: dict[str, Any] = {"executor": executor, "map_size": task["map_size"]}
    try:
        asked = inspect.signature(made).parameters
    except (TypeError, ValueError):
        return given
    if "time_budget" in asked:
        given["time_budget"] = executor.time_budget.get_remaining_real_time()
    return given


def _said(error: BaseException) -> str:
    """An error in a line, with the innermost place of it that is not ours."""
    not_its = (str(Path(__file__).parent), str(Path(importlib.__file__).parent), "<")
    passed = traceback.extract_tb(error.__traceback__)
    frames = [frame for frame in passed if not frame.filename.startswith(not_its)]
    at = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}{at}: {error}"[:500]


def _leave() -> None:
    """End at once: threads of the generator that still work are not waited for."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
