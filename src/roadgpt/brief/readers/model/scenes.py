"""What stands among a description beside the shape of its road: the scene, the kind of road, its design speed
and where one comes from. A network of its own reads it; here it is put together with the road."""

from collections.abc import Iterator, Sequence

from roadgpt.brief.feasible import is_possible
from roadgpt.brief.languages import TABLE
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.trained import ANY_WORLD, left_out
from roadgpt.brief.scene import Scene

NAMES: dict[str, frozenset[str]] = {name: frozenset(words.split()) for name, words in TABLE["others"].items()}
"""The words for other road users, weather and light that a scene should have if they are said, by what they
are."""
BEHIND = frozenset(["stop", "stops", "lane", "lanes", "bay", "bays", "shelter", "crossing"])
"""Words before which "bus", "bicycle" or "pedestrian" names a thing beside the road."""
AS_SCENE: dict[str, tuple[str, ...]] = {
    "traffic": ("flow", "oncoming"),
    "pedestrian": ("adult", "child"),
    "cyclist": ("bicycle",),
    "animal": ("animal",),
    "obstacle": ("cones", "barrier", "lost_load"),
    "rain": ("rain", "wet"),
    "fog": ("fog",),
    "snowfall": ("snow",),
    "night": ("night",),
    "sun": ("low_sun",),
    "wet": ("wet",),
    "snow": ("snow",),
    "ice": ("ice",),
    "bridge": ("bridge",),
    "tunnel": ("tunnel",),
    "trees": ("forest", "tree_lined"),
    "buildings": ("town",),
    "water": ("lake", "river", "coast"),
    "landscape": ("valley", "ridge"),
    "parking": ("parked",),
    "speed": ("speed",),
    "place": ("place", "town"),
}
"""What the networks for roads name beside the road, with what a scene has instead."""


def read_told(line: str) -> Brief:
    """Returns the Brief of what the network for scenes wrote; raises BriefError if it cannot be read."""
    return read_plan(line) if line else Brief()


def things_in(scene: Scene) -> frozenset[str]:
    """Returns the names of what a scene has, such as "truck" and "fog"."""
    kinds = [role.kind for role in scene.actors]
    things = [name for name in ("flow", "oncoming", "parked", "fog", "rain") if getattr(scene, name)]
    lands = [land.kind for land in scene.landscape]
    speeds = ["speed"] if scene.speed or any(role.speed for role in scene.actors) else []
    return frozenset(filter(None, [*kinds, *things, *lands, *speeds, scene.light, scene.surface]))


def joined(road: Brief, told: Brief, unused: Sequence[str]) -> Brief:
    """Returns a road with what is told beside it. A design speed that the road cannot have gives way."""
    fields = {name: getattr(told, name) for name in ("surroundings", "speed", "comes_from", "scene")}
    if road.map is not None:
        fields = {"scene": told.scene}
    there = things_in(told.scene) | {
        *(["speed"] if told.speed else []),
        *(["place"] if told.surroundings else []),
    }
    kept = [name for name in road.beside if there.isdisjoint(AS_SCENE.get(name, ()))]
    motorway = road.motorway or (told.motorway and not road.junctions and road.map is None)
    if motorway:
        fields |= {"surroundings": None}
    brief = road.model_copy(
        update={**fields, "beside": tuple(kept), "motorway": motorway, "unused": tuple(unused)}
    )
    if brief.speed is None or is_possible(brief, *ANY_WORLD):
        return brief
    slower = brief.model_copy(update={"surroundings": None, "speed": None})
    return slower if is_possible(slower, *ANY_WORLD) else brief


def not_used(
    text: SlottedText, of_road: Sequence[str], told: Brief, of_scene: Sequence[str]
) -> Iterator[str]:
    """Yields, as they are written, the numbers of a text that neither plan has, and the words for other road
    users, weather and light that the scene lacks."""
    missing, slot = {*left_out(of_road, text)}.intersection(left_out(of_scene, text)), 0
    there = things_in(told.scene)
    for word, after in zip(text.words, (*text.words[1:], None), strict=True):
        if word.text.startswith("[unused") and word.written:
            if slot in missing or slot >= len(text.slots):
                yield word.written
            slot += 1
        elif after is None or after.text not in BEHIND:
            names = [name for name, words in NAMES.items() if word.text in words]
            if any(there.isdisjoint(name.split("_or_")) for name in names):
                yield word.written
