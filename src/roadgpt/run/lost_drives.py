"""Counts lost drives, to give up a simulator that is dead: one that lost three drives in a row.

Wherever many roads are driven, each drive is counted here. A drive is lost if the simulator could not be
started, went away, or gave no answer (``SimulatorError``); a failure of the driver, or of the physics on one
road, is no loss. A drive that works begins the count anew.
"""

from typing import Generic, TypeVar

from roadgpt.errors import GivenUpError

Key = TypeVar("Key")
MOST = 3  # in a row; each may have cost minutes of waiting for the simulator to start


class LostDrives(Generic[Key]):
    """The drives in a row that a simulator lost."""

    def __init__(self) -> None:
        self.lost: list[Key] = []
        """Keys of the lost drives."""

    def count(self, key: Key, is_lost: bool) -> bool:
        """Counts a drive; returns True if it is time to give up."""
        if not is_lost:
            self.lost.clear()
            return False
        self.lost.append(key)
        return len(self.lost) >= MOST

    @staticmethod
    def given_up(reason: str, again: str) -> GivenUpError:
        """Returns the error to raise.

        Args:
            reason: the simulator's own sentence about the last drive.
            again: how to drive the roads that were not driven.
        """
        return GivenUpError(f"the simulator failed {MOST} times in a row and is given up ({reason})", again)
