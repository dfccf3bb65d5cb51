"""Defines the errors that users can cause. Every message states what is wrong and what to do."""

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any


class RoadGPTError(Exception):
    """Base class of all errors that a user can cause or resolve. The message is one clear sentence."""

    exit_status = 1


class UsageError(RoadGPTError):
    """An input or a file that the user gave cannot be used."""

    exit_status = 2


class BriefError(UsageError):
    """A description is meaningless, contradicts itself or asks for the impossible."""


class SceneError(UsageError):
    """Something of a scene cannot be on the road that was built."""


class EditError(UsageError):
    """A change request cannot be understood, names something that is not on the road, or cannot be met."""


class IdleEditError(EditError):
    """A change request, as it was read, would change nothing on the road."""


class UnclearPlaceError(EditError):
    """A change request, as it was read, may mean any of several places on the road."""


class DesignError(RoadGPTError):
    """No road could be designed on this map that meets every requirement of the Brief."""

    exit_status = 3


class DriverError(RoadGPTError):
    """A driver raised an exception, returned something that is not a command, or did not answer."""


class SimulationError(RoadGPTError):
    """A drive could not be completed: the physics diverged, or the simulator failed."""


class SimulatorError(SimulationError):
    """The simulator itself failed: it could not be started, ended early, or did not answer."""


class GivenUpError(RoadGPTError):
    """RoadGPT gave up on a simulator that failed several times in a row."""

    exit_status = 5


class GateError(RoadGPTError):
    """The results do not meet what the user demands with ``--fail-on`` or ``--baseline``."""

    exit_status = 6


class PartError(UsageError):
    """A plug-in cannot be loaded, or no installed package registers a plug-in of the requested name."""


class ExportError(RoadGPTError):
    """A road cannot be exported: the format cannot represent it, or the file cannot be written."""


class ChatError(RoadGPTError):
    """The server of a language model could not be reached, or did not do what was requested."""

    exit_status = 4


class BudgetError(ChatError):
    """The next request to a language model could exceed the limit of tokens or cost."""


class ReplyError(ChatError):
    """The server answered, but the answer is not usable. Only the current road fails; a campaign goes on."""

    def __init__(self, sentence: str, text: str = "") -> None:
        super().__init__(sentence)
        self.text = text[:2000]
        """What the model wrote, cut after 2,000 characters. It is for people to read and is never trusted."""


class RefusedError(ReplyError):
    """The model declined to answer."""


class UnparsableError(ReplyError):
    """None of the model's replies matches the requested schema, in any of the formats that were tried."""


_ADVICE = {
    "greater_than_equal": "give {ge:g} or more",
    "greater_than": "give more than {gt:g}",
    "less_than_equal": "give {le:g} or less",
    "less_than": "give less than {lt:g}",
    "literal_error": "give {expected}",
    **dict.fromkeys(("int_parsing", "int_type", "int_from_float"), "give a whole number"),
    **dict.fromkeys(("float_parsing", "float_type", "finite_number"), "give a number"),
    "string_type": "give a text in quotes",
    "string_too_short": "give a text that is not empty",
    "bool_type": "give true or false",
    "too_short": "give at least one",
    **dict.fromkeys(("model_type", "dict_type"), "give a table"),
}
"""What the user can do about a value that a model refuses, by pydantic's name for the mistake."""


def advice_on(mistake: Any) -> str:
    """Returns what to give instead of a value that a pydantic model refuses; ``mistake`` is one of the
    ``errors()`` of a ValidationError. The advice does not show the value, which may be a key."""
    message = str(mistake["msg"]).removeprefix("Value error, ")
    advice = _ADVICE.get(mistake["type"], "").format(**mistake.get("ctx", {}))
    return advice or message[:1].lower() + message[1:]


@contextmanager
def explained(kind: type[RoadGPTError], what: str, advice: str) -> Iterator[None]:
    """Turns an OSError into an error of another kind, whose message is ``what``, such as "cannot write FILE",
    then the reason, and ``advice``, which says what the user can do."""
    try:
        yield
    except OSError as error:
        raise kind(f"{what}: {error.strerror or error}; {advice}") from error


def command_line(*words: object) -> str:
    """Returns a command that can be typed in the present folder; in messages it follows a colon, and ends."""
    return shlex.join(["roadgpt", *map(str, words)])


def needed(package: str, what: str) -> Any:
    """Returns a package that is an extra of its own name; raises UsageError if it is missing, which says that
    ``what`` needs it, and how it is installed."""
    try:
        return import_module(package)
    except ImportError as error:
        advice = to_install(package)
        raise UsageError(f"{what} needs the package '{package}'; install it with: {advice}") from error


def to_install(extra: str) -> str:
    """Returns the command that installs an extra; in a checkout, it keeps the installation editable."""
    checkout = Path(__file__).parents[2]
    if not (checkout / "pyproject.toml").is_file():
        return f"python -m pip install 'roadgpt[{extra}]'"
    place = "." if checkout == Path.cwd() else checkout
    return f"python -m pip install -e {shlex.quote(f'{place}[{extra}]')}"
