"""Runs users' drivers in separate processes, so that a driver cannot harm RoadGPT or other drivers.

    here:   IsolatedDriver.steer(view) --> pickle: 13 numbers, the others, and an image for a camera
    child:  DriverGuard.ask(view)      --> JSON: 3 numbers and who drives, or an error message

If a driver hangs (in Python or in compiled code), ends its process, or takes more memory than allowed, only
its own drive fails. One process serves many drives, one after another; the driver is created anew for each.
"""

from typing import Any

from roadgpt import plugins
from roadgpt.drive.loading import load_driver, require_permission, split_spec, without_settings

OURS = "roadgpt."  # prefix of the modules whose drivers run in this process, beside the simulator


def driver_of(spec: str) -> Any:
    """Returns the driver that a user named: RoadGPT's own drivers run in this process, any other in a
    separate process.

    If only a stored file (of a run, a campaign or a plan) names a driver's file, the driver runs only after
    the user has agreed (see ``drive.loading``). ``spec`` names a driver plug-in, or is PATH.py:CLASS;
    settings may follow."""
    require_permission(spec)
    path, _ = split_spec(spec)
    module = "" if path else plugins.module_of("drivers", without_settings(spec)[0])
    if not path and (not module or module.startswith(OURS)):  # load_driver reports an unknown plug-in
        return load_driver(spec)
    from roadgpt.drive.isolation.proxy import IsolatedDriver  # RoadGPT's own drivers need no process

    return IsolatedDriver(spec)
