"""Defines the motion of a car along a road as arrays, for file formats that can hold a drive."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of a car over time. Every array has shape ``(n,)`` with n >= 2, and the times increase.

    Positions are those of the car's centre of gravity, in metres. Angles are in radians: heading 0 along +x
    and counter-clockwise, pitch positive nose up, roll positive left side up. Time is in s, speed in m/s.

    Raises:
        UsageError: The arrays differ in length or contain a number that is not finite, or the times do not
            increase.
    """

    time: Array
    x: Array
    y: Array
    z: Array
    heading: Array
    pitch: Array
    roll: Array
    speed: Array

    def __post_init__(self) -> None:
        columns = [getattr(self, each.name) for each in fields(self)]
        same = self.time.ndim == 1 and len(self.time) > 1 and {c.shape for c in columns} == {self.time.shape}
        if not (same and np.isfinite(columns).all() and (np.diff(self.time) > 0).all()):
            raise UsageError(
                "these poses cannot be exported; give arrays of one length, two values or more, all finite, "
                "with rising times"
            )

    @classmethod
    def of(cls, columns: Mapping[str, ArrayLike]) -> Self:
        """Returns the poses from a mapping with one column per field of this class, such as the columns of a
        Drive.

        Other columns are ignored.

        Raises:
            UsageError: A column is missing, or the columns are not valid poses.
        """
        missing = [each.name for each in fields(cls) if each.name not in columns]
        if missing:
            raise UsageError(f"the poses have no {', '.join(missing)}; give those columns as well")
        return cls(**{each.name: np.asarray(columns[each.name], float) for each in fields(cls)})

    def __len__(self) -> int:
        return len(self.time)
