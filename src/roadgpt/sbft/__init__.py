"""The SBFT tool competition in both directions. Makes a Competition, and tests for theirs. Verb: ``compete``.

Their generators run in our simulator: ``compete`` starts a generator in a process of its own, hands it an
executor under the competition's names, and drives what it brings. Ours runs in their pipeline:
``RoadGPTTestGenerator``. ``sdc`` serves the competition on choosing tests.

Each name is imported when it is first used: a generator's own process needs few of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from roadgpt.sbft.competition import Competition, compete
    from roadgpt.sbft.experiment import Ending, Experiment
    from roadgpt.sbft.generator import RoadGPTTestGenerator

__all__ = ["Competition", "Ending", "Experiment", "RoadGPTTestGenerator", "compete"]

_FILES = {
    "Competition": "competition",
    "Ending": "experiment",
    "Experiment": "experiment",
    "RoadGPTTestGenerator": "generator",
    "compete": "competition",
}


def __getattr__(name: str) -> Any:
    if name not in _FILES:
        raise AttributeError(f"roadgpt.sbft has no '{name}'; it offers {', '.join(__all__)}")
    return getattr(import_module(f"roadgpt.sbft.{_FILES[name]}"), name)
