"""``compete`` runs test generators of the SBFT tool competition with RoadGPT's simulators: it starts a
generator in a process of its own, passes it an executor with the competition's class name and methods, and
drives the roads that it submits. In the other direction, ``RoadGPTTestGenerator`` runs RoadGPT in the
competition's pipeline. The package ``sdc`` is a tool for the SDC competition on test selection.

Names are imported when they are first used, because a generator's own process needs few of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from roadgpt_sbft.competition import Competition, Ending, compete
    from roadgpt_sbft.generator import RoadGPTTestGenerator
    from roadgpt_sbft.results import Experiment

__all__ = ["Competition", "Ending", "Experiment", "RoadGPTTestGenerator", "compete"]

_FILES = {
    "Competition": "competition",
    "Ending": "competition",
    "Experiment": "results",
    "RoadGPTTestGenerator": "generator",
    "compete": "competition",
}


def __getattr__(name: str) -> Any:
    if name not in _FILES:
        raise AttributeError(f"roadgpt_sbft has no '{name}'; it offers {', '.join(__all__)}")
    return getattr(import_module(f"roadgpt_sbft.{_FILES[name]}"), name)
