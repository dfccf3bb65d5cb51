"""Refusals that depend on the map, with the Brief that is refused: on another map it may be built."""

from roadgpt.brief.model import Brief
from roadgpt.errors import BriefError


class TooMuchError(BriefError):
    """More is asked for than the usual map of 250 m is known to hold; another may hold it.

    Attributes:
        brief: what is asked for; ``brief.read`` holds it against the real map.
    """

    def __init__(self, sentence: str, brief: Brief) -> None:
        super().__init__(sentence)
        self.brief = brief


class NoRoomError(BriefError):
    """The map has no room for what is asked for.

    Attributes:
        brief: what is asked for.
    """

    def __init__(self, sentence: str, brief: Brief) -> None:
        super().__init__(sentence)
        self.brief = brief
