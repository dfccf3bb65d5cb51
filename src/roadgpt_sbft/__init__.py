"""Runs test generators of the SBFT tool competition with RoadGPT, and RoadGPT as a generator in the
competition. Main function: ``compete``.

``compete`` runs the competition's generators with RoadGPT's simulators: it starts a generator in a process of
its own, passes it an executor with the same class name and methods as the competition's, and drives the roads
that the generator submits. In the other direction, the class ``RoadGPTTestGenerator`` runs RoadGPT in the
competition's pipeline. The package ``sdc`` implements a tool for the SDC competition on test selection.

The public classes and functions of this package are imported only when they are first used, because a
generator's own process needs few of them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from roadgpt_sbft.competition import Competition, compete
    from roadgpt_sbft.experiment import Ending, Experiment
    from roadgpt_sbft.generator import RoadGPTTestGenerator

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
        raise AttributeError(f"roadgpt_sbft has no '{name}'; it offers {', '.join(__all__)}")
    return getattr(import_module(f"roadgpt_sbft.{_FILES[name]}"), name)
