"""Chooses among plans of routes and maps, and corrects them where the words leave no choice.

Descriptions of single roads do not need these rules.
"""

from collections.abc import Sequence
from itertools import pairwise

from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.alike_junctions import with_counted_junctions
from roadgpt.brief.readers.model.armed_junctions import with_told_arms
from roadgpt.brief.readers.model.exit_words import with_passed_exits
from roadgpt.brief.readers.model.from_start import with_distances_from_start
from roadgpt.brief.readers.model.map_signs import with_counted_signs
from roadgpt.brief.readers.model.map_words import asks_for_grid, with_counted_map
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.brief.readers.model.numbered_junctions import with_numbered_junctions
from roadgpt.brief.readers.model.other_roads import with_other_roads
from roadgpt.brief.readers.model.own_lane import with_told_lane, without_own_lane
from roadgpt.brief.readers.model.ramp_lengths import with_ramp_lengths
from roadgpt.brief.readers.model.route_lengths import (
    with_length_of_route,
    with_length_past_lanes,
    with_lengths_of_ends,
)
from roadgpt.brief.readers.model.sharp_sides import with_sharp_side
from roadgpt.brief.readers.model.side_roads import with_sides_of_side_roads
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.readers.model.told_junctions import (
    has_all_told,
    has_told_ends,
    has_told_kinds,
    lacks_ends_as_junctions,
    most_of_kinds,
    names_kinds,
    number_of_listed,
    with_told_letter,
    with_told_total,
)
from roadgpt.brief.readers.model.told_takes import with_told_takes
from roadgpt.brief.readers.model.whole_drive import with_whole_drive


def as_counted(found: Sequence[ScoredPlan], text: SlottedText) -> ScoredPlan | None:
    """Returns the likeliest plan without more junctions of a kind than the words can mean, and with a grid if
    the words can only mean one as a map; None if there is none that is likely. Maps of kinds that the words
    mention, and with as many dead ends as they count, are preferred.
    """
    most, listed = most_of_kinds(text), number_of_listed(text)
    no_village = asks_for_grid(text)
    plans = [
        (draft, brief)
        for draft, brief in ((draft, read_plan(draft.line)) for draft in found)
        if is_of_junctions(draft.line)
        and has_told_kinds(brief, most)
        and listed in (None, len(brief.junctions))
        and not (no_village and brief.map is not None and brief.map.junctions)
    ]
    for is_preferred in (has_all_told, names_kinds, has_told_ends, lacks_ends_as_junctions):
        plans = [each for each in plans if is_preferred(each[1], text)] or plans
    return plans[0][0] if plans else None


def with_words_of_network(brief: Brief, text: SlottedText, words: str) -> Brief:
    """Returns the Brief of a route or a map, corrected by rules where the words are clear.

    Args:
        brief: the Brief of the plan.
        text: the description, as the network read it.
        words: the same, as it was written.
    """
    brief = with_told_takes(with_told_total(brief, text), text)
    brief = with_ramp_lengths(with_counted_junctions(brief, text), text)
    brief = with_lengths_of_ends(with_length_past_lanes(with_length_of_route(brief, text), text), text)
    brief = with_counted_signs(with_counted_map(brief, text), text)
    brief = with_told_lane(_into_new_lane(brief), words)
    brief = with_sharp_side(with_told_arms(brief, text), words)
    brief = with_passed_exits(without_own_lane(with_told_letter(brief, text), words), words)
    brief = with_distances_from_start(with_numbered_junctions(brief, text), words)
    brief = with_sides_of_side_roads(brief, text, words)
    return with_other_roads(with_whole_drive(brief, words), words)


def _into_new_lane(brief: Brief) -> Brief:
    """Returns a route that changes into the lane that begins, if the side of the change is not said."""
    places = list(brief.junctions)
    for n, (before, place) in enumerate(pairwise(brief.junctions), 1):
        if before.kind == "lane_gain" and place.kind == "lane_change" and before.side and place.take is None:
            places[n] = place.model_copy(update={"take": before.side})
    return brief.model_copy(update={"junctions": tuple(places)})
