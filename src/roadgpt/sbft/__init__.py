"""Runs generators of the SBFT tool competition in RoadGPT, and RoadGPT in the competition. Main function:
``compete``.

The competition's generators run in RoadGPT's simulator: ``compete`` starts a generator in a process of its
own, passes it an executor under the competition's names, and drives the roads that it submits. RoadGPT runs
in the competition's pipeline: ``RoadGPTTestGenerator``. The package ``sdc`` serves the competition on test
selection.

Names of this package are imported lazily, because a generator's own process needs few of them.
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
