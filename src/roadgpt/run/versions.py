"""Records what decides results besides the request, and compares such records.

    roadgpt [source]      RoadGPT's version, and a digest of its source
    python, numpy, ...    versions of Python and of libraries, and the platform
    judgement             the version of the rules by which drives are judged, ``verdict.JUDGEMENT``
    weights               a digest of the weights of the reader
    plug-ins              those of other packages: distribution, version, and a digest of their source
    tracks FILE           the digest of the recorded tracks of others
    driver:FILE           the digest of a file that the driver uses, see ``drive.driver_files``
    reading               a digest of the requirements that were read from the description

A Run has the record of its own test. A folder has one for all its tests, or one for each driver; it is
complete when all roads have been driven, since a driver may use further files on later roads.
"""

import platform
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from roadgpt import __version__, brief, plugins
from roadgpt.drive.isolation import driver_of
from roadgpt.drive.loading import WRITTEN, folder_of, without_settings
from roadgpt.errors import UsageError
from roadgpt.reading import ABSENT, digest
from roadgpt.run.model import Request, Setup
from roadgpt.verdict import JUDGEMENT

LIBRARIES = "numpy", "scipy", "pydantic"
FILE = "driver:"

Versions = dict[str, str]


def versions_now(asked: Iterable[tuple[Request, str]], loads: bool = True) -> dict[str, Versions]:
    """Returns the record of tests of Requests and generators that begin now, for each driver, with its files
    if drivers are loaded; raises the errors of ``isolation.driver_of``."""
    every = dict.fromkeys((request.setup, generator) for request, generator in asked)
    setups, generators = [*dict.fromkeys(setup for setup, _ in every)], {name for _, name in every}
    drivers = {its.driver: driver_of(its.driver) if loads and its.drives else None for its in setups}
    return {name: versions_of(setups, driver, generators) for name, driver in drivers.items()}


def versions_of(setups: Sequence[Setup], driver: Any = None, generators: Iterable[str] = ()) -> Versions:
    """Returns the record of tests with these Setups and generators, driven by a driver that was created; for
    a simulator with settings also these, and the versions of the libraries that they name."""
    driven = [setup for setup in setups if setup.drives]
    found = {"roadgpt": __version__, "roadgpt source": _source(Path(__file__).parents[1])}
    found |= {"python": platform.python_version(), "machine": f"{platform.system()} {platform.machine()}"}
    found |= {name: _version(name) for name in LIBRARIES + (("mujoco-core", "numba") if driven else ())}
    found |= {"judgement": str(JUDGEMENT)} if driven else {}
    for name in {setup.simulator for setup in driven} & {*plugins.names("settings")}:
        settings = plugins.find("settings", name)
        found |= {each: _version(each) for each in settings.libraries} | {name: settings.of().summary()}
    used = {("generators", name) for name in generators}
    used |= {(kind, name) for kind in ("rules", "columns") for name in plugins.names(kind)}
    found |= {f"tracks {Path(its.tracks).name}": digest(Path(its.tracks)) for its in driven if its.tracks}
    used |= {("recordings", Path(its.tracks).suffix[1:]) for its in driven}
    for its in setups:
        reader, _, place = its.reader.partition(":")
        weights = Path(place or Path(brief.__file__).parent / "readers" / "model" / "weights")
        found |= {"weights": digest(weights)} if reader == "model" and weights.is_dir() else {}
        used |= {("readers", reader), ("designers", its.designer)}
        used |= (
            {("simulators", its.simulator), ("drivers", without_settings(its.driver)[0])}
            if its.drives
            else set()
        )
    modules = {part: plugins.module_of(*part).partition(".")[0] for part in used}
    others = {_plugin(*part, module) for part, module in modules.items() if module not in ("", "roadgpt")}
    found["plug-ins"] = ", ".join(sorted(others)) or "none"
    return found | {FILE + name: its for name, its in getattr(driver, "files", {}).items()}


def judgement_of(versions: Mapping[str, str]) -> int:
    """Returns the version of the rules by which a drive with this record was judged."""
    return int(versions.get("judgement", 1))


@cache
def _source(place: Path) -> str:
    return digest(place, "*.py")


@cache
def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _plugin(kind: str, name: str, module: str) -> str:
    found = find_spec(module)
    place = Path(found.origin if found and found.origin else module)
    named = plugins.origin(kind, name).replace("roadgpt ", f"{module} ", 1)  # our annexes, each by its name
    return f"{named} ({_source(place.parent if place.stem == '__init__' else place)})"


def still(recorded: Mapping[str, str], now: Mapping[str, str], driver: str, folder: object) -> Versions:
    """Returns the record of a folder's tests, if it is true of a test that begins now, too; raises UsageError
    otherwise. Files of the driver that only earlier tests have used are compared with those on the disk."""
    changes = []
    for name in dict.fromkeys((*recorded, *now)):
        file = name.removeprefix(FILE)
        was = recorded.get(name, "not recorded" if file == name else ABSENT)
        its = now.get(name) or (was if file == name else digest(folder_of(driver) / file))
        if was != its and WRITTEN not in (was, its):
            what = name if file == name else f"the driver's file {file}"
            changes.append(f"{what} (was {was}, is {its})")
    if changes:
        raise UsageError(
            f"what decides the results in {folder} has changed: {', '.join(changes[:3])}"
            f"{', ...' if changes[3:] else ''}; name another folder, or add --again to the command that made "
            "this one, to make all its tests anew"
        )
    return {**recorded}


def joined(recorded: Versions, files: Mapping[str, str], folder: object) -> Versions:
    """Returns a record with the files that the driver used in one more test, by their names with their
    digests; raises UsageError if a file has changed since an earlier test."""
    more = {FILE + name: its for name, its in files.items()}
    still(more | recorded, recorded | more, "", folder)
    more |= {name: WRITTEN for name in more if recorded.get(name) == WRITTEN}
    return dict(sorted((recorded | more).items(), key=lambda one: one[0] if one[0].startswith(FILE) else ""))
