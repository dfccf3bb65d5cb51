"""Writes the boundary of a junction: across each arm, and along the kerbs between neighbouring arms.

Source: ASAM OpenDRIVE 1.8.1, junction boundary. Its segments are in counter-clockwise order.
"""

from collections.abc import Iterator

from roadgpt.export.markup import XmlElement
from roadgpt.network import Connection, Junction, Network, RoadEnd


def boundary(network: Network, junction: Junction) -> XmlElement:
    """Returns the element ``boundary`` of a junction."""
    return XmlElement("boundary").extended(*_segments(network, junction))


def _segments(network: Network, junction: Junction) -> Iterator[XmlElement]:
    arms = [arm.end for arm in junction.arms]
    for n, end in enumerate(arms):
        yield XmlElement("segment", {"type": "joint", "roadId": str(end.road), "contactPoint": end.contact})
        beside = _between(junction, end, arms[(n + 1) % len(arms)])
        if beside is not None:
            lanes = len(network.road(beside.road).profile.right)
            yield XmlElement(
                "segment",
                {
                    "type": "lane",
                    "roadId": str(beside.road),
                    "boundaryLane": -lanes,
                    "sStart": "start",
                    "sEnd": "end",
                },
            )


def _between(junction: Junction, end: RoadEnd, after: RoadEnd) -> Connection | None:
    """Returns the connection at the kerb between an arm and the next one counter-clockwise.

    Traffic on the right that turns right into the next arm keeps to this kerb.
    """
    return next(
        (each for each in junction.connections if (each.incoming, each.outgoing) == (end, after)), None
    )
