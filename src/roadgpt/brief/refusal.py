"""Errors that depend on the size of the map; they carry the Brief, since another map may hold the road."""

from roadgpt.brief.model import Brief
from roadgpt.errors import BriefError


class TooMuchError(BriefError):
    """Raised if more is asked for than the usual map of 250 m is known to hold; another map may hold it.

    Attributes:
        brief: what is asked for; ``brief.read`` checks it against the actual map.
    """

    def __init__(self, sentence: str, brief: Brief) -> None:
        super().__init__(sentence)
        self.brief = brief


class NoRoomError(BriefError):
    """Raised if the map is too small for what is asked for.

    Attributes:
        brief: what is asked for.
    """

    def __init__(self, sentence: str, brief: Brief) -> None:
        super().__init__(sentence)
        self.brief = brief
