"""Runs users' drivers in separate processes, so that a driver cannot harm RoadGPT or other drivers.

    here:   IsolatedDriver.steer(view) --> pickle: 13 numbers, and an image if the driver has a camera
    child:  DriverGuard.ask(view)      --> JSON: 3 numbers, or an error message

If a driver hangs (in Python or in compiled code), ends its process, or takes more memory than allowed, only
its own drive fails. One process serves many drives, one after another; the driver is created anew for each.
"""

from roadgpt.drive.isolation.proxy import IsolatedDriver

__all__ = ["IsolatedDriver"]
