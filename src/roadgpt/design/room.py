"""Finds the World for the roads of a description: friction and lanes that the words name, and a map that is
large enough for such roads."""

from collections.abc import Iterator

from roadgpt.brief.beside import surface_remark
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import plan, scene_plan
from roadgpt.brief.scene import Scene, land_remark, scene_text
from roadgpt.brief.scene_fit import fitted
from roadgpt.brief.scene_places import with_places
from roadgpt.design.road_search import sufficient_map
from roadgpt.road import World
from roadgpt.road.world import KMH, Limits

MOTORWAY_LIMIT = 110 / KMH  # m/s, least design speed of urban and rural freeways (Green Book, chapter 8)


def world_for(brief: Brief | None, world: World) -> World:
    """Returns the World for the roads of a Brief.

    The Brief sets the scene, and a surface that it or the scene names, such as a wet road, the friction. For
    a single road, the Brief also sets the lanes and the centre line. The map gets the size that the Brief
    gives; if it gives none and roads of this Brief do not fit on the usual map, a larger map is set. A value
    that was given to the World is kept; the usual speed limit grows to the speed at which a scene begins, and
    to MOTORWAY_LIMIT for a scene on a motorway.
    Raises BriefError if the scene needs what the Brief excludes."""
    found = world.in_scene_of(brief).on_surface_of(brief).with_numbers_of(brief)
    if brief is not None:
        limit = found.limits.speed_limit
        if limit == Limits().speed_limit and brief.limit is None:
            usual = MOTORWAY_LIMIT if brief.motorway and found.scene != Scene() else limit
            if max(found.first_speed, usual) > limit:
                found = found.changed(speed_limit=max(found.first_speed, usual))
        brief = fitted(brief, found.scene, found.limits.speed_limit, world.given_map)
    found = found.with_lanes_of(brief)
    if brief is None or world.given_map is not None:
        return found
    if brief.map_size is not None:
        return found.changed(map_size=brief.map_size)
    if brief.is_of_network:
        from roadgpt.design.network_search import room_for_network  # a single road does not need it

        size = room_for_network(brief, found)
    else:
        size = sufficient_map(brief, found)
    return found if size is None else found.changed(map_size=size)


def world_remarks(brief: Brief, usual: World, found: World) -> tuple[str, ...]:
    """Returns sentences that say how a Brief affects a World: its friction, its lanes and its map. ``usual``
    is the World that was given, of which no sentence says that it could be given, and ``found`` the one that
    ``world_for`` returned."""
    names, is_set = (*brief.beside, *brief.scene.surfaces), "friction" in usual.site.model_fields_set
    said = [surface_remark(names, found.site.friction, found.scene.surfaces, is_set)]
    said += [*lane_remarks(brief, usual, found), speed_remark(brief, usual, found)]
    said += [scene_remark(brief, found), need_remark(brief, found), map_remark(brief, usual, found)]
    own = {"lane width": (brief.lane_width, found.section.lane_width, "--lane-width")}
    own["speed limit"] = brief.limit, KMH * found.limits.speed_limit, "--speed-limit"
    for name, (asked, now, option) in own.items():
        if asked is not None and abs(asked - now) > 1e-6:
            said.append(f"the words ask for a {name} of {asked:g}, but {option} {now:g} is set and used")
    return tuple(filter(None, said))


def lane_remarks(brief: Brief, usual: World, found: World) -> Iterator[str]:
    """Yields a sentence if the description asks for lanes, and another if it asks for a centre line that the
    road does not get; nothing for networks, also where the scene needs a junction."""
    if with_places(brief, found.scene).is_of_network:
        return
    lanes, centre, own = brief.lanes_text, brief.centre, found.section.lanes
    if lanes is not None and own != lanes:
        yield f"the words ask for lanes {lanes}, but --lanes {own} is set and used"
    elif lanes is not None and "lanes" not in usual.section.model_fields_set:
        yield f"the words ask for lanes {lanes}; --lanes gives others"
    if centre is not None and found.section.centre_line != centre:
        yield f"the words ask for a {centre} centre line, but another one is set and used"


def need_remark(brief: Brief, found: World) -> str:
    """Returns a sentence on what the scene needs of the road and the words leave open; empty if nothing."""
    asked = fitted(brief, found.scene, found.limits.speed_limit, found.given_map)
    return "" if asked == brief else f"the scene needs more than the words say: {plan(asked)}"


def scene_remark(brief: Brief, found: World) -> str:
    """Returns a sentence on a scene that is not that of the words; empty if there is none."""
    meant = World().in_scene_of(brief).scene
    if meant == found.scene and (brief.scene != Scene() or meant == Scene()):
        return ""  # the sentence of the words has it
    told, own = meant.told, found.scene.told
    if not (lost := [name for name in told if told[name] != own.get(name)]):
        friction = f"friction {found.site.friction:g}" if found.scene.surfaces else ""
        parts = (scene_text(found.scene), friction, land_remark(found.scene))
        is_land = found.scene.on_the_road == Scene()
        return f"{'the land' if is_land else 'on the road'}: {'; '.join(filter(None, parts))}"
    of_words = scene_text(Scene.model_validate({name: told[name] for name in lost}))
    other = f"the scene '{scene_plan(found.scene)}'" if found.scene != Scene() else "an empty scene"
    return f"the words say {of_words}, but {other} is set and used"


def speed_remark(brief: Brief, usual: World, found: World) -> str:
    """Returns a sentence on the usual speed limit, which a design speed does not change."""
    speeds = sorted({road.speed for road in brief.roads if road.speed is not None})
    if "speed_limit" in usual.limits.model_fields_set:
        return ""
    limit = f"{KMH * found.limits.speed_limit:g} km/h at most; --speed-limit gives another limit"
    if brief.motorway and found.limits.speed_limit == MOTORWAY_LIMIT:
        return f"on a motorway, all drive at {limit}"
    said = " and ".join(f"{speed:g}" for speed in speeds)
    return f"designed for {said} km/h, but driven at {limit}" if speeds else ""


def map_remark(brief: Brief, usual: World, found: World) -> str:
    """Returns a sentence on the size of the map, if the words ask for one or the usual map is too small."""
    before, now, asked = usual.site.map_size, found.site.map_size, brief.map_size
    if asked not in (None, now):
        return f"the words ask for a map of {asked:g} m; but one of {now:g} m is set and used"
    if asked is not None and usual.given_map is None:
        return f"the words ask for a map of {asked:g} m; --map-size gives another"
    if now in (before, asked):
        return ""
    return f"this does not fit on a map of {before:g} m, so the map is {now:g} m wide; --map-size sets it"
