"""Reads ``campaign.json``, which stores the request of a campaign so that the campaign can be resumed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from roadgpt.brief.model import Frozen
from roadgpt.reading import read_model
from roadgpt.run.model import Request

CARD = "campaign.json"


class Card(Frozen):
    """The content of ``campaign.json``: a Request, the number of roads, and whether the campaign is done."""

    format: Literal[1] = 1
    request: Request
    roads: int
    is_finished: bool
    versions: Mapping[str, str] = {}
    """What decided the results of all roads besides the request, see ``run.versions``."""


def seed_in(folder: Path) -> int | None:
    """Returns the seed of the campaign in a folder; None if the folder holds no campaign.

    Raises:
        UsageError: the campaign's ``campaign.json`` is damaged or has another version.
    """
    return read_card(folder).request.seed if (folder / CARD).is_file() else None


def read_card(folder: Path) -> Card:
    """Reads the ``campaign.json`` of a campaign's folder.

    Raises:
        UsageError: there is no ``campaign.json``, or it is damaged or has another version.
    """
    absent = f"{folder} is not empty and was not made by roadgpt run; name another folder"
    found = read_model(Card, folder / CARD, "the card of a campaign", absent, most=4_000_000)
    return found.model_copy(update={"request": found.request.came_with(folder / CARD)})
