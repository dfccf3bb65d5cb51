"""Campaigns: thousands of tests that test generators propose and parallel workers run.

    Plan --cells--> Cell --ask--> Proposals --workers--> Results --tell--> the cell's generator
                                                            |
                                                        Store (one file)

A cell is one combination of a description, a designer, a driver, a simulator, a generator and a seed.

Campaigns have two kinds of plug-ins: ``generators/`` propose tests, and ``executors/`` provide the workers
that run them. ``begin`` makes a campaign's folder. ``work`` runs the remaining tests; after an interruption
it resumes the campaign. ``status_of`` returns the progress. For one test, ``kept_run`` returns the stored
Run, with its drive, and ``run_again`` drives the road again."""

import sys
from types import ModuleType
from typing import Any

from roadgpt.later import load, names_of

# Each module is imported when it is first used, because a starting worker needs none of them yet.
_OFFERED = {
    "folder_record": "kept_run run_again",
    "lifecycle": "begin work",
    "model": "Cell CellBudget Generator Goal Pool Proposal Result",
    "plan": "Plan read_plan",
    "record": "Record",
    "run_folder": "Campaign campaign",
    "status": "status_of",
}
__all__ = names_of(_OFFERED)


def __getattr__(name: str) -> Any:
    return load(__name__, _OFFERED, name)


class _Room(ModuleType):
    """The type of this package. It makes the package callable, because ``roadgpt.campaign`` is also the name
    of a function."""

    def __call__(self, *values: Any, **named: Any) -> Any:
        """Calls the function ``campaign`` of this package."""
        return self.campaign(*values, **named)


sys.modules[__name__].__class__ = _Room
