"""What stands among a description beside the shape of its road: the scene, the kind of road, its design speed
and where one comes from. In the tokens of a plan it follows the road; here both are put together."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, get_args

from roadgpt.brief.amount import exactly
from roadgpt.brief.beside import TEXTS
from roadgpt.brief.expressions import says_left_hand
from roadgpt.brief.feasible import is_possible
from roadgpt.brief.languages import TABLE, pattern_of, word_set
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import SCENE, read_plan, read_scene
from roadgpt.brief.readers.model.before import SIGHT, without_asides
from roadgpt.brief.readers.model.clock import told_time
from roadgpt.brief.readers.model.number_words import plain
from roadgpt.brief.readers.model.slots import NumberSlot, SlottedText
from roadgpt.brief.readers.model.vocabulary import WISHES, plan_of
from roadgpt.brief.scene import Land, Scene
from roadgpt.brief.words import unaccented
from roadgpt.language.names import Compass
from roadgpt.language.table import LANDFORMS, ROAD_USERS, WEATHER, Words


def _names() -> Iterator[tuple[str, set[str]]]:
    """Yields the kinds of road users that a word may mean, joined by "_or_", and the plain words; the same of
    weather, surfaces and light."""
    like = {"person": "adult_or_child", "thing": "cones_or_barrier_or_lost_load"}
    for kind, row in ROAD_USERS.items():
        yield like.get(row.group, row.read_as or kind), _single(row.words) | _single(row.unseen)
    for air, weather in WEATHER.items():
        wet = ["wet", "slippery"] if (weather.read_as or air) == "rain" else []
        yield "_or_".join([weather.read_as or air, *wet]), _single(weather.words) | _single(weather.unseen)
    for name, words in TABLE["others"].items():
        yield name, {*words.split()}


def _single(words: Words) -> set[str]:
    said = {plain(each) for pairs in words.values() for pair in pairs for each in pair}
    return {each for each in said if "{" not in each and " " not in each}


NAMES: dict[str, set[str]] = {}
for _name, _said in _names():
    NAMES.setdefault(_name, set()).update(_said)
"""The words for other road users, weather and light that a scene should have if they are said, by what they
are."""
OF_SCENES = word_set("of_scenes").union(*NAMES.values())
"""The words by which a text may be about a scene."""
BEHIND = frozenset(["stop", "stops", "lane", "lanes", "bay", "bays", "shelter", "crossing"])
"""Words before which "bus", "bicycle" or "pedestrian" names a thing beside the road."""
NAMED: Mapping[str, Scene] = {name: read_scene(scene) for name, scene in TEXTS["scenes"].items()}
"""What some of the names that a network gives beside a road are as a scene."""
COMPASS: tuple[Compass, ...] = get_args(Compass)
BOUND_BRIEFLY = {f"{way[0]}b": way for way in COMPASS[::2]}
"""What "NB" and the like say of the direction in which somebody goes."""
GOING = ("heading", "going", "driving", "travelling", "traveling", "proceeding", "moving")
AS_SCENE: Mapping[str, list[str]] = {name: things.split() for name, things in TEXTS["as_scenes"].items()}
"""What a network names beside the road, with what a scene has instead."""


def parted(tokens: Sequence[str]) -> tuple[list[str], list[str]]:
    """Returns the tokens of a road, and those of what is told beside it."""
    at = next((at for at, token in enumerate(tokens) if token in (WISHES, SCENE)), len(tokens))
    told = [*tokens[at:]]
    return [*tokens[:at]], ["|", *told[1:]] if told[:1] == [WISHES] else told


def asked_in(tokens: Sequence[str], slots: Sequence[NumberSlot]) -> Brief:
    """Returns the Brief of a plan in tokens, its road in normal form; raises BriefError if it cannot be
    read."""
    brief = normal(read_plan(plan_of(parted(tokens)[0], slots)))
    told = told_in(tokens, slots)
    return brief if told == Brief() else joined(brief, told)


def told_in(tokens: Sequence[str], slots: Sequence[NumberSlot]) -> Brief:
    """Returns the Brief of what a plan in tokens tells beside its road; raises BriefError if it cannot be
    read."""
    told = parted(tokens)[1]
    return read_plan(plan_of(told, slots)) if told else Brief()


def things_in(brief: Brief) -> frozenset[str]:
    """Returns the names of what is told of a road beside its shape, such as "truck", "fog" and "speed"."""
    scene = brief.scene
    kinds = [role.kind for role in scene.actors]
    things = [name for name in ("flow", "oncoming", "parked") if getattr(scene, name)]
    things += [air.kind for air in scene.weather]
    lands = [land.kind for land in scene.landscape]
    is_fast = brief.speed or scene.speed or any(role.speed for role in scene.actors)
    others = ["speed" if is_fast else "", "place" if brief.surroundings else ""]
    return frozenset(filter(None, [*kinds, *things, *lands, *others, scene.light, scene.surface]))


SMALL_HOURS = ("22", "23", "00", "01", "02", "03", "04")
DENIED = word_set("denying")
LANDS = {kind: pattern_of(kind, "lands") for kind in ("rolling", "hilly", "flat")}
"""The words for kinds of land; mountains are the surroundings of a road."""
ON_BOTH_SIDES = pattern_of("both_sides", flags=re.IGNORECASE)


def joined(road: Brief, told: Brief) -> Brief:
    """Returns a road with what is told beside it. A design speed that the road cannot have gives way."""
    names = ["scene"] if road.map is not None else ["surroundings", "speed", "comes_from", "scene"]
    fields = {name: getattr(told, name) for name in names}
    there = things_in(told)
    kept = tuple(name for name in road.beside if there.isdisjoint(AS_SCENE.get(name, ())))
    motorway = road.motorway or (told.motorway and not road.junctions and road.map is None)
    fields |= {"surroundings": None} if motorway else {}
    brief = road.model_copy(update={**fields, "beside": kept, "motorway": motorway})
    if brief.speed is None or is_possible(brief, None, 0.0):
        return brief
    slower = brief.model_copy(update={"surroundings": None, "speed": None})
    return slower if is_possible(slower, None, 0.0) else brief


def with_named(brief: Brief) -> Brief:
    """Returns a Brief in which the scene has what the names beside the road say, if there is no scene yet. Of
    two that exclude each other, such as snow and ice, the second stays beside the road."""
    if brief.scene != Scene():
        return brief
    fields, beside = dict[str, Any](), list[str]()
    for name in brief.beside:
        told = NAMED.get(name, Scene())
        new = {field: value for field, value in told if value != getattr(Scene(), field)}
        if not new or any(fields.get(field, value) != value for field, value in new.items()):
            beside.append(name)
        else:
            fields |= new
    return brief.model_copy(update={"scene": Scene(**fields), "beside": tuple(beside)})


def with_told(brief: Brief, words: str) -> Brief:
    """Returns a Brief whose scene has what the networks leave out: the time of day that the words tell, night
    by its name or in the small hours, and parked cars on both sides where the words say so."""
    scene = brief.scene
    if scene == Scene():
        return brief
    fields: dict[str, Any] = {"landscape": _each_once(scene.landscape)}
    if scene.landscape and scene.land is None:
        kinds = (kind for kind, pattern in LANDS.items() if pattern.search(plain(words)))
        fields["land"] = next(kinds, None)
    if len(scene.parked) == 1 and ON_BOTH_SIDES.search(words):
        fields["parked"] = ("left", "right")
    clock, said = told_time(words), ["", *map(plain, re.findall(r"\w+", words))]
    if clock:
        fields["clock"] = clock
    is_named = any(word in NAMES["night"] and before not in DENIED for before, word in pairwise(said))
    if scene.light is None and (is_named or (clock or "")[:2] in SMALL_HOURS):
        fields["light"] = "night"
    named = NAMES["night"] if "light" in fields else ()
    unused = tuple(word for word in brief.unused if plain(word) not in named)
    changes = {"scene": scene.model_copy(update=fields), "unused": unused}
    if fields.get("land") in ("rolling", "hilly") and brief.slope:
        changes["hills"] = None  # the land is hilly, and the road has a slope of its own
    return brief.model_copy(update=changes)


TOLD = {name: pattern_of(name, "told", re.DOTALL) for name in TABLE["told"]}
"""What the words must tell where a network says it: it was not trained to see that they do not."""
UNTOLD = {"fog": "fog", "wet": "wet", "rain": "wet", "night": "night"}
"""By which of them names in ``Brief.beside`` are told."""


def without_untold(brief: Brief, words: str) -> Brief:
    """Returns a Brief without fog, a wet road, night, a low sun and traffic on the left if no word tells of
    them. Names of towns tell of traffic on the left, unless other words are American."""
    said, scene = unaccented(without_asides(words, SIGHT)), brief.scene
    told = {name for name, pattern in TOLD.items() if pattern.search(said)}
    needs = {"surface": scene.surface == "wet" and "wet", "light": scene.light}
    changes = {field: None for field, name in needs.items() if name and name not in told}
    if "fog" not in told:
        scene = scene.with_weather("fog", None)
    beside = tuple(each for each in brief.beside if UNTOLD.get(each) in {None, *told})
    is_left = "left_hand" in told or ("left_hand_towns" in told and "american" not in told)
    left_hand = brief.left_hand and (is_left or says_left_hand(words))
    kept = {"left_hand": left_hand, "beside": beside, "scene": scene.model_copy(update=changes)}
    return brief.model_copy(update=kept)


def _each_once(lands: Iterable[Land]) -> tuple[Land, ...]:
    """Returns a landscape in which nothing stands twice, but for single bridges, tunnels and the like."""
    found = list[Land]()
    for land in lands:
        if land not in found or (LANDFORMS[land.kind].structure and land.count == exactly(1)):
            found.append(land)
    return tuple(found)


def with_origin(brief: Brief, text: SlottedText) -> Brief:
    """Returns a Brief that comes from the south where its words say "northbound" of everybody, and from the
    north if it has that the wrong way round."""
    came = brief.comes_from
    if came is None:
        return brief
    opposite = COMPASS[(COMPASS.index(came) + len(COMPASS) // 2) % len(COMPASS)]
    goals = {*_goals([word.text for word in text.words])}
    return brief.model_copy(update={"comes_from": opposite if goals & {came, opposite} == {came} else came})


def _goals(words: Sequence[str]) -> Iterator[str]:
    """Yields the directions in which somebody goes, such as "north" for "northbound" and "heading north"."""
    for at, word in enumerate(words):
        if word in BOUND_BRIEFLY:
            yield BOUND_BRIEFLY[word]
        for way in COMPASS:
            is_bound = word == f"{way}bound" or (word == way and "bound" in words[at + 1 : at + 3])
            if is_bound or (at and words[at - 1] in GOING and word in (way, f"{way}ward", f"{way}wards")):
                yield way


def may_be_of_a_scene(text: SlottedText, refusal: str = "") -> bool:
    """Returns whether a text may be about a scene: by one of its words, or because it is refused as one of a
    road for something that a scene has."""
    is_named = any(word.text in OF_SCENES for word in text.words)
    return is_named or not AS_SCENE.keys().isdisjoint(refusal.split())


def without_scene(text: SlottedText, told: Brief, beside: Iterable[str]) -> Iterator[str]:
    """Yields, as they are written, the words of a text for other road users, weather and light that neither
    the scene has nor a name beside the road."""
    there = things_in(told).union(*(AS_SCENE.get(name, ()) for name in beside))
    for word, after in zip(text.words, (*text.words[1:], None), strict=True):
        if after is None or after.text not in BEHIND:
            names = [name for name, words in NAMES.items() if word.text in words]
            if any(there.isdisjoint(name.split("_or_")) for name in names):
                yield word.written
