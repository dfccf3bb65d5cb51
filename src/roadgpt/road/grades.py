"""The heights of a Design: each segment's incline, joined by parabolas centred on the joints."""

from collections.abc import Sequence

from roadgpt.geometry import GradeProfile
from roadgpt.road.design import Segment

CREST_RADIUS = 250.0  # m: at 70 km/h a crest takes 1.5 m/s^2 off gravity, so wheels stay loaded
MOST_OF_SEGMENT = 0.9  # the two parabolas of a segment may take this share of it


def profile_of(segments: Sequence[Segment], z0: float) -> GradeProfile:
    """The profile over the plan stations of the segments; parabolas change no height at the far joints."""
    grades = [segment.incline / 100 for segment in segments]
    stations, values, at = [0.0], [grades[0]], 0.0
    for i in range(1, len(segments)):
        at += segments[i - 1].distance
        shorter = min(segments[i - 1].distance, segments[i].distance)
        half = min(CREST_RADIUS * abs(grades[i] - grades[i - 1]) / 2, MOST_OF_SEGMENT * shorter / 2)
        if half > 1e-6:
            stations += [at - half, at + half]
            values += [grades[i - 1], grades[i]]
    stations.append(at + segments[-1].distance)
    values.append(grades[-1])
    return GradeProfile(z0, tuple(stations), tuple(values))
