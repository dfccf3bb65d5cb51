"""Imports two things from RoadGPT's client for other interpreters (``names/roadgpt_client.py``): messages as
JSON Lines (one JSON value per line), and the base class of RoadGPT's own generator. The client runs on Python
3.8 and without RoadGPT, so RoadGPT imports from the client; the reverse is not possible.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a type checker knows the file under the name that generators' interpreters use
    from roadgpt_client import ClientTestGenerator, Message, received, send
else:
    from roadgpt_sbft.names.roadgpt_client import ClientTestGenerator, Message, received, send

__all__ = ["ClientTestGenerator", "Message", "received", "send"]
