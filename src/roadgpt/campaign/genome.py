"""Genes: a Design as a sequence of turns and straights, which can be changed without knowing segments.

RoadGPT's format cuts turns of more than 70 degrees into segments; a gene is the whole turn. ``design_of``
cuts
it again, so that a road that the planner drafted comes back as it was, to the last written digit.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil, inf, radians
from typing import NamedTuple

import numpy as np

from roadgpt.check.extremes import lowest
from roadgpt.design.heights import rounded
from roadgpt.design.layout import Place
from roadgpt.design.repair.proposal import SEEN
from roadgpt.design.spans import Slope, Span, cut, turn_span
from roadgpt.design.vertical import Pace, joined, made_to_fit, runs_of, too_abrupt, widened
from roadgpt.road import Design, Segment, World
from roadgpt.road.alignment import LONGEST_TRANSITION, TRANSITION_SHARE
from roadgpt.road.design import MAX_INCLINE
from roadgpt.road.elevation import elevation_of

SPARE = 1.0  # m: a turn that is longer than its radius needs by more is a turn between two straights
SHORTEST = 0.5  # m, of a straight that is written
ABOVE_GROUND = 1.0  # m from the ground to the lowest place of a road
CENTIMETRE = 100.0  # per metre: how heights are written


class Gene(NamedTuple):
    """A turn, or a straight where ``turn`` is 0."""

    turn: float = 0.0
    """Degrees, left positive."""
    length: float = 0.0
    """Metres, of a straight; the length of a turn follows from its angle and radius."""
    radius: float = inf
    """Metres."""
    ramp: float = 0.0
    """Metres, of the clothoid at each end of a turn."""
    incline: float = 0.0
    """Percent."""
    vertical_radius: float = 0.0
    """Metres, of the parabola from the slope of the gene before; 0 leaves it open."""

    @property
    def span(self) -> Span:
        """The turn or straight with its numbers as they will be written."""
        if not self.turn:
            return Span(max(self.length, SHORTEST))
        return turn_span(abs(self.turn), 1 if self.turn > 0 else -1, self.radius, self.ramp, None)


Genes = tuple[Gene, ...]


def genes_of(design: Design) -> Genes:
    """Returns the genes of a design in driving order; neighbouring straights of one incline become one."""
    out: list[Gene] = []
    for group in _groups(design.segments):
        for gene in _of_group(group):
            last = out[-1] if out else None
            if last and not last.turn and not gene.turn and last.incline == gene.incline:
                out[-1] = last._replace(length=last.length + gene.length)
            else:
                out.append(gene)
    return tuple(out)


def _groups(segments: Sequence[Segment]) -> Iterator[list[Segment]]:
    """Yields the segments of each turn, and each straight by itself."""
    group = [segments[0]]
    for before, segment in pairwise(segments):
        if _goes_on(before, segment, group[0].radius):
            group.append(segment)
        else:
            yield group
            group = [segment]
    yield group


def _goes_on(before: Segment, segment: Segment, radius: float | None) -> bool:
    """Checks whether a segment belongs to the same turn as the one before."""
    same = (before.turn_degrees, before.incline) == (segment.turn_degrees, segment.incline)
    return bool(segment.turn_degrees) and same and (segment.radius is None or segment.radius == radius)


def _of_group(group: Sequence[Segment]) -> Iterator[Gene]:
    first = group[0]
    vertical = first.vertical_radius or 0.0
    length = sum(segment.distance for segment in group)
    turn = sum(segment.turn_degrees for segment in group)
    if not turn:
        yield Gene(length=length, incline=first.incline, vertical_radius=vertical)
        return
    ramp = first.transition or min(TRANSITION_SHARE * first.distance, LONGEST_TRANSITION)
    radius = (length - ramp) / radians(abs(turn))
    spare = 0.0
    if first.radius and first.radius < radius:
        spare = length - ramp - first.radius * radians(abs(turn))
        radius = first.radius
    straight = Gene(length=spare / 2, incline=first.incline)
    bend = Gene(turn=round(turn, 6), radius=radius, ramp=ramp, incline=first.incline)
    row = (straight, bend, straight) if spare > SPARE else (bend,)
    yield from (row[0]._replace(vertical_radius=vertical), *row[1:])


def spans_of(genes: Genes) -> list[Span]:
    """Returns the spans of genes, as planners lay them out."""
    return [gene.span for gene in genes]


def segments_of(genes: Genes, world: World) -> tuple[Segment, ...]:
    """Returns the segments of genes in RoadGPT's format.

    Grades are rounded away from the limit at which a road counts as flat. Slopes that change too fast for the
    speed limit are moved towards each other.
    """
    pace = Pace.along(spans_of(genes), world)
    segments = joined(_cut(genes, [gene.incline for gene in genes]), pace)
    if not too_abrupt(segments, pace):
        return segments
    most = min(100 * world.max_grade, MAX_INCLINE)
    inclines = [gene.incline for gene in genes]
    lengths = [gene.span.length for gene in genes]
    short = {i for i, gene in enumerate(genes) if not gene.turn and lengths[i] < SEEN}
    runs = runs_of(inclines, short)
    grades = made_to_fit(inclines, lengths, runs, [(-most, most)] * len(genes), pace)
    return widened(joined(_cut(genes, grades), pace), pace)


def _cut(genes: Genes, grades: Sequence[float]) -> list[Segment]:
    """Returns the segments of genes with these grades, in percent."""
    out: list[Segment] = []
    for gene, grade in zip(genes, grades, strict=True):
        span, incline = gene.span, float(rounded(np.array(grade))) + 0.0
        out += cut(span, [Slope(span.length, incline, gene.vertical_radius or None)])
    return out


def design_of(genes: Genes, place: Place, world: World) -> Design:
    """Returns the design that starts at a place of the map, its lowest point a little above the ground."""
    segments = segments_of(genes, world)
    profile = elevation_of(segments, 0.0)
    _, sag = lowest(profile, profile.stations[-1])
    ground = max(0.0, world.z_floor) + ABOVE_GROUND
    height = ceil((ground - sag) * CENTIMETRE) / CENTIMETRE
    return Design(starting_point=(place.x, place.y, height), theta=place.theta, segments=segments)
