"""Defines the name of land that a user gives in a file. This module loads nothing heavy."""

import re
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from roadgpt.ground.relief import Relief

NAME = re.compile(r"(.{1,4096})@([0-9a-f]{12})", re.DOTALL)
"""The file as it was given, and a digest of its heights."""
BESIDE = "ground.npz"
"""The file with the heights of given land in the folder of a run."""


class GivenGround(str):
    """The name of given land, such as "alps.tif@3f0c5a9e1b2d". It carries the heights, also to other
    processes; files hold only the name, and nothing opens a file because of it."""

    relief: "Relief"
    __slots__: ClassVar[tuple[str, ...]] = ("relief",)

    @classmethod
    def named(cls, name: str, relief: "Relief") -> "GivenGround":
        """Returns a name that carries these heights."""
        made = cls(name)
        made.relief = relief
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return GivenGround.named, (str(self), self.relief)
