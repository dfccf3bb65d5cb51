"""Which BeamNG.tech goes with which beamngpy, and what to do where two do not go together.

Both say a protocol version in their first message, and the client goes on only where they are the same. So
whatever passes that is driven, with a warning where nobody has tried this client with RoadGPT. Source of the
pairs: compatibility page of BeamNGpy 1.36; of the protocols: the sources of its releases.
"""

import logging
from collections.abc import Iterable
from typing import NamedTuple


class Pair(NamedTuple):
    """What belongs together."""

    tech: str
    client: str
    protocol: str
    is_tried: bool = False
    """Do RoadGPT's tests pass with this client?"""


PAIRS = (
    Pair("0.39", "1.36", "v1.27", True),
    Pair("0.38", "1.35.1", "v1.26", True),
    Pair("0.37", "1.34.1", "v1.24", True),
    Pair("0.36", "1.33.1", "v1.23", True),
    Pair("0.35", "1.32", "v1.23", True),
    Pair("0.34", "1.31", "v1.22", True),
    Pair("0.33", "1.30", "v1.22", True),
    Pair("0.26", "1.24", "v1.19"),
)


def warn_of(version: str) -> None:
    """Have the log say so where nobody has tried this version of beamngpy."""
    if any(pair.is_tried and pair.client == version for pair in PAIRS):
        return
    tried = ", ".join(pair.client for pair in PAIRS if pair.is_tried)
    logging.getLogger("roadgpt").warning(
        "roadgpt: beamngpy %s has not been tried with RoadGPT, which goes on with it; tried are %s",
        version,
        tried,
    )


def cure(game: str, client: str, version: str) -> str:
    """What to do where a game of one protocol meets a client of another.

    Args:
        game: protocol of the BeamNG that answered; client: of the installed beamngpy.
        version: of the installed beamngpy.
    """
    theirs = [pair for pair in PAIRS if pair.protocol == game]
    ours = [pair for pair in PAIRS if pair.protocol == client]
    said = f"BeamNG.tech {_either(pair.tech for pair in theirs)}" if theirs else "this BeamNG.tech"
    start = f"{said} speaks protocol {game}, and the installed beamngpy {version} speaks {client}"
    techs = _either(pair.tech for pair in ours)
    other = f"install BeamNG.tech {techs}" if ours else "install the BeamNG.tech that goes with it"
    if not theirs:
        table = ", ".join(f"{pair.tech} with {pair.client}" for pair in PAIRS if pair.is_tried)
        return f"{start}; {other}, or the beamngpy that goes with yours ({table})"
    return f"{start}; say 'python -m pip install beamngpy=={theirs[0].client}', or {other}"


def _either(names: Iterable[str]) -> str:
    return " or ".join(names)
