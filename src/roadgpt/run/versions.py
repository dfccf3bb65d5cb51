"""Lists the software versions that a Run was made with, so that differences between Runs can be explained."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from roadgpt import __version__
from roadgpt.run.model import Setup

DESIGNING = ("numpy", "scipy", "pydantic")
DRIVING = ("mujoco-core", "numba")


def versions_of(setup: Setup) -> dict[str, str]:
    """Returns the versions of RoadGPT, Python and the libraries that affect the results, and the platform."""
    return {
        "roadgpt": __version__,
        "python": platform.python_version(),
        "machine": f"{platform.system()} {platform.machine()}",
        **_libraries(DESIGNING + (DRIVING if setup.drives else ())),
        **(_beamng() if setup.drives and setup.simulator == "beamng" else {}),
    }


def _beamng() -> dict[str, str]:
    """Returns BeamNG's settings, and the version of its Python client, which determines that of BeamNG."""
    from roadgpt.drive.simulators.beamng.settings import BeamngSettings

    return {**_libraries(("beamngpy",)), "beamng": BeamngSettings.of().summary()}


@cache
def _libraries(names: tuple[str, ...]) -> dict[str, str]:
    return {name: _version(name) for name in names}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
