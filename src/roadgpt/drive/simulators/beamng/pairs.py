"""Which BeamNG.tech goes with which beamngpy, and what to do where two do not go together.

Both say a protocol version in their first message, and it must be the same. Source: compatibility page of
BeamNGpy 1.36 and the sources of its releases.
"""

from typing import NamedTuple


class Pair(NamedTuple):
    """What belongs together."""

    tech: str
    client: str
    protocol: str


PAIRS = (
    Pair("0.39", "1.36", "v1.27"),
    Pair("0.38", "1.35.1", "v1.26"),
    Pair("0.37", "1.34.1", "v1.24"),
    Pair("0.35", "1.32", "v1.23"),
    Pair("0.33", "1.30", "v1.22"),
    Pair("0.26", "1.24", "v1.19"),
)
OLDEST = "0.37"  # that this simulator drives


def cure(game: str, client: str, version: str) -> str:
    """What to do where a game of one protocol meets a client of another.

    Args:
        game: protocol of the BeamNG that answered; client: of the installed beamngpy.
        version: of the installed beamngpy.
    """
    theirs = next((pair for pair in PAIRS if pair.protocol == game), None)
    ours = next((pair for pair in PAIRS if pair.protocol == client), None)
    said = f"BeamNG.tech {theirs.tech}" if theirs else "this BeamNG.tech"
    start = f"{said} speaks protocol {game}, and the installed beamngpy {version} speaks {client}"
    other = f"install BeamNG.tech {ours.tech}" if ours else "install the BeamNG.tech that goes with it"
    if theirs is None:
        table = ", ".join(f"{pair.tech} with {pair.client}" for pair in PAIRS[:3])
        return f"{start}; {other}, or the beamngpy that goes with yours ({table})"
    if float(theirs.tech) < float(OLDEST):
        return f"{start}; {other}: versions before {OLDEST} are not driven"
    return f"{start}; say 'python -m pip install beamngpy=={theirs.client}', or {other}"
