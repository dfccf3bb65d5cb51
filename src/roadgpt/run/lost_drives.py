"""A simulator that is dead: three drives in a row that it lost itself, and nobody goes on asking it.

Wherever many roads are driven, what came of each is counted here. A drive is lost where the simulator could
not be started, went away, or gave no answer (``SimulatorError``); that a driver fails, or the physics of one
road breaks down, is no loss. One that works again in between begins the count anew.
"""

from typing import Generic, TypeVar

from roadgpt.errors import GivenUpError

Key = TypeVar("Key")
MOST = 3  # in a row; each may have cost minutes of waiting for the simulator to start


class LostDrives(Generic[Key]):
    """Drives in a row that a simulator lost."""

    def __init__(self) -> None:
        self.lost: list[Key] = []
        """Those that came to nothing, by whatever tells them apart."""

    def count(self, key: Key, is_lost: bool) -> bool:
        """Count what came of a drive; True where it is time to give up."""
        if not is_lost:
            self.lost.clear()
            return False
        self.lost.append(key)
        return len(self.lost) >= MOST

    @staticmethod
    def given_up(said: str, again: str) -> GivenUpError:
        """What to say.

        Args:
            said: of the last drive, the simulator's own sentence.
            again: how the roads that were not driven are driven.
        """
        return GivenUpError(f"the simulator failed {MOST} times in a row and is given up ({said})", again)
