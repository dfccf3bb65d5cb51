"""Lists which versions of BeamNG.tech and beamngpy work together, and gives advice for versions that do not.

BeamNG and beamngpy each send a protocol version in their first message, and beamngpy continues only if both
are the same. RoadGPT therefore drives with every pair of versions that passes this check, and logs a warning
if it has not been tested with the installed beamngpy.

Sources: BeamNGpy 1.36's compatibility page for the versions, and the source code of BeamNGpy's releases for
the protocols.
"""

import logging
from typing import NamedTuple


class VersionPair(NamedTuple):
    """Versions of BeamNG.tech and beamngpy that work together, and their protocol."""

    tech: str
    client: str
    protocol: str
    is_tried: bool = False
    """Whether RoadGPT's tests pass with this version of beamngpy."""


VERSION_PAIRS = (
    VersionPair("0.39", "1.36", "v1.27", True),
    VersionPair("0.38", "1.35.1", "v1.26", True),
    VersionPair("0.37", "1.34.1", "v1.24", True),
    VersionPair("0.36", "1.33.1", "v1.23", True),
    VersionPair("0.35", "1.32", "v1.23", True),
    VersionPair("0.34", "1.31", "v1.22", True),
    VersionPair("0.33", "1.30", "v1.22", True),
    VersionPair("0.26", "1.24", "v1.19"),
)


def warn_if_untested(version: str) -> None:
    """Logs a warning if this version of beamngpy has not been tested with RoadGPT."""
    if any(pair.is_tried and pair.client == version for pair in VERSION_PAIRS):
        return
    tried = ", ".join(pair.client for pair in VERSION_PAIRS if pair.is_tried)
    logging.getLogger("roadgpt").warning(
        "roadgpt: beamngpy %s has not been tried with RoadGPT, which uses it anyway; tested versions: %s",
        version,
        tried,
    )


def mismatch_advice(game: str, client: str, version: str) -> str:
    """Returns advice for a user whose BeamNG and beamngpy use different protocols.

    Args:
        game: protocol version of the BeamNG that answered.
        client: protocol version of the installed beamngpy.
        version: version of the installed beamngpy.
    """
    theirs = [pair for pair in VERSION_PAIRS if pair.protocol == game]
    ours = [pair for pair in VERSION_PAIRS if pair.protocol == client]
    said = f"BeamNG.tech {' or '.join(pair.tech for pair in theirs)}" if theirs else "this BeamNG.tech"
    start = f"{said} uses protocol {game}, and the installed beamngpy {version} uses {client}"
    techs = " or ".join(pair.tech for pair in ours)
    other = f"install BeamNG.tech {techs}" if ours else "install the BeamNG.tech that goes with it"
    if not theirs:
        table = ", ".join(f"{pair.tech} with {pair.client}" for pair in VERSION_PAIRS if pair.is_tried)
        return f"{start}; {other}, or the beamngpy that goes with yours ({table})"
    return f"{start}; run 'python -m pip install beamngpy=={theirs[0].client}', or {other}"
