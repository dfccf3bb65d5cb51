"""Defines what is required of a road, and the class Look: a design together with the road built from it. A
Look says what is wrong with the road."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from roadgpt import check
from roadgpt.brief.outline import Outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.check.matching import fits, turn_complaints
from roadgpt.check.measures import MeasuredFeature, Measures, measure
from roadgpt.check.rules.promises import complaints
from roadgpt.design.road_elements import RoadElements, features_of, shows_slopes, shows_turns
from roadgpt.road import Design, Geometry, Road, World


class Requirements(NamedTuple):
    """The requirements for a road, in addition to those for each of its elements."""

    world: World  # the size of the map, and the limits that the rules check
    outline: Outline = Outline(groups=(), turns=Range())  # requirements for the whole road; none by default
    before: Design | None = None
    """The road before an edit; the parabolas between its slopes are kept. With None, they are chosen
    anew, and each turn must be measured with the slope that it has in the design."""
    geometry: Geometry = "arcs"


@dataclass(frozen=True)
class Look:
    """A design with the road that was built from it, the findings of the rules, and measurements."""

    design: Design  # the design, moved inside the map and above the ground if necessary
    elements: RoadElements
    road: Road
    findings: tuple[check.Finding, ...]
    requirements: Requirements

    @cached_property
    def found(self) -> Measures:
        """The measured turns, straights and grades."""
        return measure(self.road.centreline())

    @cached_property
    def has_turns(self) -> bool:
        """Whether the measured road has the same sequence of left and right turns as the elements."""
        return shows_turns(self.found, self.elements)

    @cached_property
    def seen(self) -> tuple[MeasuredFeature | None, ...]:
        """The measured feature of each element; only defined if ``has_turns`` is True."""
        return features_of(self.elements, self.found)

    @cached_property
    def objection(self) -> str:
        """A sentence that says which rule or requirement the road does not meet; empty if it meets all of
        them."""
        if self.findings:
            return self.findings[0].sentence
        if not self.has_turns:
            wanted, shown = sum(element.is_turn for element in self.elements), len(self.found.turns)
            if wanted != shown:
                return f"{shown} turns would be seen and not {wanted}, as some run into each other"
            return "a turn would be seen to the wrong side"
        if self.requirements.before is None and not shows_slopes(self.found, self.elements):
            return "a turn would be seen on another slope"
        return self._unmet()

    def _unmet(self) -> str:
        """Returns a sentence about the first requirement that the measurements do not meet; empty if none."""
        turns = 0
        for element, seen in zip(self.elements, self.seen, strict=True):
            turns += element.is_turn
            asked = element.asked
            if asked and not seen and asked.length and asked.length.lo >= LEAST_STRAIGHT:
                return f"a straight of {element.length:.1f} m would not be seen"
            if not asked or not seen or fits(seen, asked):
                continue
            if element.is_turn:
                return turn_complaints(turns, seen, asked)[0].sentence
            wanted = f"asked for {asked.length or 'any'} m at {asked.grade or 'any'} %"
            return f"the straight would be {seen.length:.1f} m long at {seen.grade:.1f} %, {wanted}"
        return next(
            (complaint.sentence for complaint in complaints(self.found, self.requirements.outline)), ""
        )
