"""Finds the World for the roads of a description: the friction of a surface that the words name, and a map
that is large enough for such roads.
"""

from roadgpt.brief.beside import surface_remark
from roadgpt.brief.model import Brief
from roadgpt.design.road_search import sufficient_map
from roadgpt.road import World


def world_for(brief: Brief | None, world: World) -> World:
    """Returns the World for the roads of a Brief.

    A surface that the Brief names, such as a wet road, sets the friction, unless the World was given one. If
    the World was given no map size and roads of this Brief do not fit on the usual map, the map is enlarged.
    """
    found = world.on_surface_of(brief)
    if brief is None or "map_size" in world.site.model_fields_set:
        return found
    size = sufficient_map(brief, found)
    return found if size is None else found.changed(map_size=size)


def world_remarks(brief: Brief, usual: World, found: World) -> tuple[str, ...]:
    """Returns sentences that say what a Brief has changed about a World: its friction, and its map."""
    said = (surface_remark(brief.beside, found.site.friction), map_remark(usual, found))
    return tuple(remark for remark in said if remark)


def map_remark(usual: World, found: World) -> str:
    """Returns a sentence that says how large the map has become; empty if it is as large as before.

    Args:
        usual: the World that was given.
        found: the World for the roads, as ``world_for`` returns it.
    """
    before, now = usual.site.map_size, found.site.map_size
    if now == before:
        return ""
    return f"this does not fit on a map of {before:g} m, so the map is {now:g} m wide; --map-size sets it"
