"""The room of campaigns: thousands of tests, searched for, shared among workers, and never lost.

    Plan --cells--> Cell --ask--> Proposals --workers--> Results --tell--> the cell's generator
                                                            |
                                                        Store (one file)

Two shelves. ``generators/`` think out tests; ``executors/`` are the workers that drive them. Verbs: ``begin``
a campaign in a folder, and ``work`` on it as often as it takes; ``status_of`` says how far it is,
``read_trace`` and ``run_again`` give one test of it.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

# Each is imported when it is first used: a worker that starts wants none of it yet.
_MODULES = {
    "Budget": "model",
    "Cell": "model",
    "Generator": "model",
    "Goal": "model",
    "Pool": "model",
    "Proposal": "model",
    "Result": "model",
    "Plan": "plan",
    "Record": "record",
    "begin": "lifecycle",
    "read_plan": "plan_file",
    "kept_run": "rerun",
    "read_trace": "rerun",
    "run_again": "rerun",
    "status_of": "status",
    "work": "lifecycle",
}

__all__ = [*sorted(_MODULES)]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"roadgpt.campaign has no '{name}'; it offers {', '.join(sorted(_MODULES))}")
    return getattr(import_module(f"roadgpt.campaign.{_MODULES[name]}"), name)


class _Room(ModuleType):
    """This room, which bears the name of a verb that the package offers: called, it is that verb."""

    def __call__(self, *values: Any, **named: Any) -> Any:
        """``roadgpt.run.campaign``: once this room is imported, ``roadgpt.campaign`` names the room."""
        return import_module("roadgpt.run").campaign(*values, **named)


sys.modules[__name__].__class__ = _Room
