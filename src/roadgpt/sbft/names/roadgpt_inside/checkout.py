"""Finds modules and names of the competition that RoadGPT does not provide in a checkout of the competition's
code, or reports them as missing.

Most of these names control BeamNG or the DAVE-2 network, which a generator does not need in RoadGPT.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any, List, Optional

PACKAGES = ("code_pipeline", "self_driving")
ADVICE = "put a checkout of the competition's code on PYTHONPATH, or do without it"


HERE = {"code_pipeline.utils": "code_pipeline/pairs.py", "self_driving.utils": "self_driving/places.py"}
"""Modules of the competition whose files have other names in RoadGPT, with these files."""


class Missing:
    """An import finder that runs after all others: reports modules of the competition that neither RoadGPT
    nor a checkout provides."""

    @staticmethod
    def find_spec(name: str, path: Optional[List[str]] = None, target: Any = None) -> Any:
        """Returns the location of a module that RoadGPT provides; None for modules that are not the
        competition's.

        Raises:
            ModuleNotFoundError: the module belongs to the competition, but was not found.
        """
        del path, target
        if name in HERE:
            return importlib.util.spec_from_file_location(name, Path(__file__).parent.parent / HERE[name])
        package, _, rest = name.partition(".")
        if package in PACKAGES and rest:
            raise ModuleNotFoundError(f"RoadGPT has no stand-in for {name}; {ADVICE}", name=name)
        return None


def watch() -> None:
    """Installs the finder that reports missing modules of the competition by name."""
    finders: List[Any] = sys.meta_path
    if Missing not in finders:
        finders.append(Missing)


def attribute(module: str, name: str) -> Any:
    """Returns an attribute that RoadGPT's version of a module lacks, from the same module in a checkout of
    the competition's code.

    Raises:
        AttributeError: the checkout lacks it as well, or the name is one of Python's own.
        ImportError: there is no checkout, and the attribute is for BeamNG.
    """
    if name.startswith("__"):
        raise AttributeError(f"module '{module}' has no attribute '{name}'")
    theirs = _theirs(module)
    if theirs is not None and hasattr(theirs, name):
        return getattr(theirs, name)
    if theirs is None and name in BEAMNG.get(module, ()):
        raise ImportError(f"RoadGPT has no stand-in for {module}.{name}; {ADVICE}", name=module)
    raise AttributeError(f"RoadGPT's stand-in for {module} has no '{name}'; {ADVICE}")


BEAMNG = {"self_driving.vehicle_state_reader": ("VehicleStateReader",)}


def _theirs(module: str) -> Any:
    """Returns the module of a checkout, loaded once beside ours; None if there is no checkout."""
    package, _, stem = module.partition(".")
    name = f"{package}._checkout_{stem}"
    if name in sys.modules:
        return sys.modules[name]
    for folder in list(sys.modules[package].__path__)[1:]:
        path = Path(folder, f"{stem}.py")
        if not path.is_file():
            continue
        spec = importlib.util.spec_from_file_location(name, path)
        if spec is None or spec.loader is None:
            continue
        made = sys.modules[name] = importlib.util.module_from_spec(spec)
        try:
            spec.loader.exec_module(made)
        except BaseException:
            del sys.modules[name]
            raise
        return made
    return None
