"""Groups failures by fault, and analyses each fault: why it occurs, how often it recurs, and the simplest
road on which it occurs.
"""

from importlib import import_module
from typing import Any

_MODULES = {
    "faults_in": "fault",
    "reason_of": "failures",
    "repeated": "stability",
    "simplest": "minimise",
}
"""The functions for users, which are imported when they are first used."""


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"roadgpt.campaign.faults has no '{name}'; it offers {', '.join(_MODULES)}")
    return getattr(import_module(f"roadgpt.campaign.faults.{_MODULES[name]}"), name)
