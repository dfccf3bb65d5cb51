"""Drivers of other people, each in a process of its own: whatever it does there, it does to itself alone.

    ours: Foreign.steer(view) --13 numbers, and a picture where it has a camera--> inside: Seat.ask(view)
                              <--3 numbers, or a sentence about what went wrong---

A driver that hangs, in Python or in compiled code, ends its process, or takes more memory than it may, costs
its drive. One process serves many drives, one after another; each gets the driver made anew.
"""

from roadgpt.drive.apart.foreign import Foreign, driver_of

__all__ = ["Foreign", "driver_of"]
