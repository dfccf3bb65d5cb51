"""Corrects the plans of routes and maps where the words leave no choice.

Descriptions of single roads do not need these rules.
"""

from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.from_start import with_distances_from_start
from roadgpt.brief.readers.model.map_signs import with_counted_signs
from roadgpt.brief.readers.model.map_words import with_counted_map
from roadgpt.brief.readers.model.side_roads import with_end_of_side_street, with_sides_of_side_roads
from roadgpt.brief.readers.model.slots import SlottedText


def with_words_of_network(brief: Brief, text: SlottedText, words: str) -> Brief:
    """Returns the Brief of a route or a map, corrected by rules where the words are clear.

    Args:
        brief: the Brief of the plan.
        text: the description, as the network read it.
        words: the same, as it was written.
    """
    brief = with_counted_signs(with_counted_map(brief, text), text)
    brief = with_end_of_side_street(with_distances_from_start(brief, words), words)
    return with_sides_of_side_roads(brief, text, words)
