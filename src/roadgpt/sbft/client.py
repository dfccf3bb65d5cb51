"""Gives RoadGPT what its client for other interpreters (``names/roadgpt_client.py``) already has: messages as
JSON Lines, one JSON value per line, and the generator of which RoadGPT's own is a subclass. That file runs
alone, on Python 3.8 and without RoadGPT, so RoadGPT imports from it and not the other way round.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a type checker knows the file under the name that generators' interpreters use
    from roadgpt_client import ClientTestGenerator, Message, received, send
else:
    from roadgpt.sbft.names.roadgpt_client import ClientTestGenerator, Message, received, send

__all__ = ["ClientTestGenerator", "Message", "received", "send"]
