"""Counts lost drives, so that a command stops using a simulator that has lost three drives in a row.

All commands that drive many roads count their drives here. A drive is lost if the simulator could not be
started, ended unexpectedly, or did not answer (``SimulatorError``); a failure of the driver, or of the
physics on one road, does not count. A drive that is not lost resets the count.
"""

from typing import Generic, TypeVar

from roadgpt.errors import GivenUpError

Key = TypeVar("Key")
MOST = 3  # in a row; each may have cost minutes of waiting for the simulator to start


class LostDrives(Generic[Key]):
    """Counts how many drives in a row a simulator has lost."""

    def __init__(self) -> None:
        self.lost: list[Key] = []
        """Keys of the lost drives."""

    def count(self, key: Key, is_lost: bool) -> bool:
        """Counts the drive that ``key`` identifies; returns True if the last three drives were all lost."""
        if not is_lost:
            self.lost.clear()
            return False
        self.lost.append(key)
        return len(self.lost) >= MOST

    @staticmethod
    def given_up(reason: str, again: str) -> GivenUpError:
        """Returns the error to raise when RoadGPT gives up on the simulator: its error message for the last
        drive, and how the user can drive the remaining roads later (``again``).
        """
        return GivenUpError(f"the simulator failed {MOST} times in a row and is given up ({reason})", again)
