"""Errors that depend on the size of the map; they carry the Brief, since the road may fit on another map."""

from roadgpt.brief.model import Brief
from roadgpt.errors import BriefError


class TooMuchError(BriefError):
    """Raised if a description asks for more than the usual map of 250 m can hold; a larger map may hold it.

    Attributes:
        brief: the requirements; ``brief.read`` checks them against the actual map.
    """

    def __init__(self, sentence: str, brief: Brief) -> None:
        super().__init__(sentence)
        self.brief = brief


class NoRoomError(BriefError):
    """Raised if the map is too small for the requirements.

    Attributes:
        brief: the requirements.
    """

    def __init__(self, sentence: str, brief: Brief) -> None:
        super().__init__(sentence)
        self.brief = brief
