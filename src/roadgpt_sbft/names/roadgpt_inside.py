"""What the modules with the competition's names have in common. They ask RoadGPT for every computation that
needs more than the standard library. What they lack is taken from a checkout of the competition's code, whole
modules as well as single names. Most of these control BeamNG or the DAVE-2 network; generators do not need
them in RoadGPT.
"""

from __future__ import annotations

import sys
from functools import partial
from importlib.machinery import PathFinder, SourceFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any, Callable, List, Optional

from roadgpt_client import ClientError, Message, RoadGPT

NAMES = Path(__file__).parent  # the packages with the competition's names, and this module
PACKAGES = ("code_pipeline", "self_driving")
ADVICE = "put a checkout of the competition's code on PYTHONPATH, or do without it"

BEAMNG = ("self_driving.vehicle_state_reader", "VehicleStateReader")
"""Module and name of a class that RoadGPT's version of the module lacks, because the class needs BeamNG."""


class Answering:
    """Who answers: RoadGPT in this interpreter, if it started this process in its own; otherwise a process of
    RoadGPT. A forked process starts a RoadGPT of its own."""

    here: Optional[Callable[[Message], Message]] = None
    process: Optional[RoadGPT] = None


def ask(op: str, **values: Any) -> Any:
    """Returns RoadGPT's answer to a request for the operation ``op``."""
    if Answering.here is not None:
        answer = Answering.here({"op": op, **values})
        if "error" in answer:
            raise ClientError(answer["error"])
        return answer["answer"]
    if Answering.process is None or not Answering.process.is_ours:
        Answering.process = RoadGPT()
    return Answering.process.ask(op, **values)


class _Loader(SourceFileLoader):
    """Loads one of RoadGPT's modules; names that the module lacks are taken from a checkout."""

    def exec_module(self, module: Any) -> None:
        super().exec_module(module)
        vars(module)["__getattr__"] = partial(_attribute, module.__name__)


class Finder:
    """An import finder for the modules of the competition's packages."""

    @staticmethod
    def find_spec(name: str, path: Optional[List[str]] = None, target: Any = None) -> Any:
        """Returns the import spec of a module of the competition; None for all other modules."""
        del target
        package, _, rest = name.partition(".")
        if package not in PACKAGES or not rest:
            return None
        own = NAMES / package / f"{rest}.py"
        if own.is_file():
            return spec_from_file_location(name, own, loader=_Loader(name, str(own)))
        theirs = PathFinder.find_spec(name, path)
        if theirs is None:
            raise ModuleNotFoundError(f"RoadGPT has no stand-in for {name}; {ADVICE}", name=name)
        return theirs


def watch() -> None:
    """Makes Python use the Finder for all imports from now on."""
    finders: List[Any] = sys.meta_path
    if Finder not in finders:
        finders.insert(0, Finder)


def _attribute(module: str, name: str) -> Any:
    """Returns an attribute that RoadGPT's version of a module lacks, from the same module in a checkout."""
    if name.startswith("__"):
        raise AttributeError(f"module '{module}' has no attribute '{name}'")
    theirs = _theirs(module)
    if theirs is not None and hasattr(theirs, name):
        return getattr(theirs, name)
    if theirs is None and (module, name) == BEAMNG:
        raise ImportError(f"RoadGPT has no stand-in for {module}.{name}; {ADVICE}", name=module)
    raise AttributeError(f"RoadGPT's stand-in for {module} has no '{name}'; {ADVICE}")


def _theirs(module: str) -> Any:
    """Returns the module of a checkout, loaded once beside RoadGPT's; None if there is no checkout."""
    package, _, stem = module.partition(".")
    name = f"{package}._checkout_{stem}"
    if name in sys.modules:
        return sys.modules[name]
    for folder in list(sys.modules[package].__path__)[1:]:
        path = Path(folder, f"{stem}.py")
        spec = spec_from_file_location(name, path)
        if not path.is_file() or spec is None or spec.loader is None:
            continue
        made = sys.modules[name] = module_from_spec(spec)
        try:
            spec.loader.exec_module(made)
        except BaseException:
            del sys.modules[name]
            raise
        return made
    return None
