"""Which kinds of road users and weather the words of a text name. The trained networks know the older kinds
alone: what they have never seen stands before them as the word of the kind that they read instead, and what
they wrote for it is named afterwards."""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple, cast

from roadgpt.brief.languages import FUNCTION_WORDS, TABLE, language_of, pattern_of, word_set
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import SCENE, plan
from roadgpt.brief.readers.model.number_words import plain
from roadgpt.brief.scene import Scene, usual_weather
from roadgpt.language.names import ActorKind, WeatherKind
from roadgpt.language.table import ROAD_USERS, WEATHER, RoadUser, WeatherRow, Words

DENIED, ARTICLES = word_set("denying"), word_set("ones") | word_set("of_known")
HAPPENING = {names: pattern_of(names, "happening") for names in TABLE["happening"]}
"""What tells of deeds and places, by the words of plans for them."""
AGAIN = word_set("of_known")
"""Words before somebody who has been named before."""
OWN = word_set("of_oneself")
"""Words before, or behind, the tested car."""


class _Phrase(NamedTuple):
    """What a phrase names, in one language."""

    name: ActorKind | WeatherKind | None
    """None: nothing, although a word in it does."""
    is_many: bool
    is_seen: bool = True
    """Whether the networks know it."""


class Mention(NamedTuple):
    """A place in a text that names a kind."""

    name: ActorKind | WeatherKind
    is_many: bool
    is_seen: bool
    language: str
    start: int
    end: int
    before: str
    """The plain word before it."""
    is_denied: bool
    """Whether it is named as what is not there."""
    is_own: bool
    """Whether it is the tested car."""


def _row_of(name: str) -> RoadUser | WeatherRow:
    return ROAD_USERS[cast("ActorKind", name)] if name in ROAD_USERS else WEATHER[cast("WeatherKind", name)]


def known_as(name: str) -> Any:
    """Returns the kind of road user or weather that the networks write for one."""
    return _row_of(name).read_as or name


def words_of(name: str, language: str) -> list[tuple[str, str]]:
    """Returns the words that mean a kind in a language, one and many."""
    row = _row_of(name)
    also = row.also.get(language, ()) if isinstance(row, RoadUser) else ()
    return [*row.words.get(language, ()), *also]


@cache
def _phrases(language: str) -> tuple[re.Pattern[str], Mapping[str, _Phrase]]:
    """Returns the pattern of all phrases of a language, and what each of them names."""
    found: dict[str, _Phrase] = {}

    def add(
        words: Words,
        name: ActorKind | WeatherKind | None,
        known: Sequence[tuple[str, str]] = (),
        is_seen: bool = True,
    ) -> None:
        for pair in words.get(language, ()):
            for is_many, phrase in enumerate(pair):
                for each in [own[is_many] for own in known] if "{}" in phrase else [""]:
                    found.setdefault(plain(phrase.format(each)), _Phrase(name, bool(is_many), is_seen))

    for kind, row in ROAD_USERS.items():
        known = words_of(row.read_as, language) if row.read_as else []
        add(row.words, kind, known)
        add(row.also, kind, known)
        add(row.unseen, kind, known, is_seen=False)
        add(row.none, None)
    for air, weather in WEATHER.items():
        add(weather.words, air)
        add(weather.unseen, air, is_seen=False)
        add(weather.none, None)
    longest = sorted(found, key=len, reverse=True)
    return re.compile(rf"(?<![\w-])(?:{'|'.join(map(re.escape, longest))})(?![\w-])"), found


def mentions_in(words: str) -> Iterator[Mention]:
    """Yields what the words name, in the order of the text."""
    said = plain(words)
    for language in _languages(said):
        pattern, phrases = _phrases(language)
        for found in pattern.finditer(said):
            name, is_many, is_seen = phrases[found[0]]
            *rest, last = ["", *re.findall(r"\w+", said[: found.start()])[-2:]]
            is_denied = last in DENIED or (last in ARTICLES and rest[-1] in DENIED)
            is_own = not OWN.isdisjoint((last, *re.findall(r"\w+", said[found.end() :])[:1]))
            if name is not None:
                yield Mention(name, is_many, is_seen, language, *found.span(), last, is_denied, is_own)
        if pattern.search(said):
            return


def _languages(said: str) -> list[str]:
    """Returns the language of a text; all of them, if none of its words tells it."""
    words = {*re.findall(r"[^\W\d_]+", said)}
    is_told = any(words & its for its in FUNCTION_WORDS.values())
    return [language_of(words)] if is_told else [*FUNCTION_WORDS]


def unused_in(brief: Brief, words: str) -> dict[str, str]:
    """Returns the words of a text that tell of road users, weather, deeds and places of which a Brief has
    nothing, and by them what they name: a kind, or words of plans. Cars are left out: the tested car is one;
    so is what is denied."""
    scene, told = brief.scene, {*re.findall(r"[a-z_]+(?:=0\b)?", plan(brief))}
    there = {"car", *(str(role.kind) for role in scene.actors), *(str(air.kind) for air in scene.weather)}
    there |= {action.whom.split()[0] for action in scene.actions if action.whom}
    named = [each for each in mentions_in(words) if not (each.is_denied or each.is_own)]
    found = {words[each.start : each.end]: str(each.name) for each in named if each.name not in there}
    said = plain(words)
    for names, pattern in HAPPENING.items():
        for each in pattern.finditer(said) if told.isdisjoint(names.split()) else ():
            if DENIED.isdisjoint(re.findall(r"\w+", said[: each.start()])[-3:]):
                found.setdefault(words[each.start() : each.end()], names)
    return found


def unnamed_in(brief: Brief) -> list[str]:
    """Returns the kinds of others in the scene of a Brief of whose group its words name nobody. Cars are left
    out: what they do often tells of them."""
    rows = (_row_of(each.name) for each in mentions_in(brief.words))
    named = {row.group for row in rows if isinstance(row, RoadUser)}
    kinds = dict.fromkeys(role.kind for role in brief.scene.actors if role.kind != "car")
    return [kind.replace("_", " ") for kind in kinds if ROAD_USERS[kind].group not in named]


def with_known_words(words: str) -> tuple[str, dict[str, str]]:
    """Returns the words with those of kinds that the networks know in place of others that they have never
    seen, and what was written for each of them."""
    instead = dict[str, str]()
    for mention in reversed([*mentions_in(words)]):
        if not mention.is_seen:
            known = words_of(known_as(mention.name), mention.language)[0][mention.is_many]
            instead[known] = words[mention.start : mention.end]
            words = words[: mention.start] + known + words[mention.end :]
    return words, instead


def with_kinds(brief: Brief, words: str) -> Brief:
    """Returns a Brief whose scene has the kinds that the words name, where the networks wrote the kind that
    they know; and the weather that they do not write. Where it is not clear who of several is meant, the kind
    stays as it is, and the word counts as unused."""
    named, scene, unused = [*mentions_in(words)], brief.scene, [*brief.unused]
    told = _once_each([each for each in named if each.name in ROAD_USERS])
    kinds = {place: role.kind for place, role in enumerate(scene.actors)}
    for known in dict.fromkeys(known_as(each.name) for each in told):
        those = [each for each in told if known_as(each.name) == known]
        places = [place for place, role in enumerate(scene.actors) if role.kind == known]
        kinds |= _renamed(known, places or _unnamed(known, scene, told), those, words, unused)
    airs, beside = {each.name for each in named if each.name in WEATHER and not each.is_denied}, brief.beside
    for air in (each for each in WEATHER if each in airs and WEATHER[each].read_as):
        known = known_as(air)
        amount = scene.amount_of(known)
        is_told = amount is not None and amount != usual_weather(known).amount
        if known not in airs:
            scene, beside = scene.with_weather(known, None), tuple(each for each in beside if each != known)
        scene = scene.with_weather(air, amount if is_told else usual_weather(air).amount)
    used = {plain(words[each.start : each.end]) for each in named if each.name in airs or each.is_denied}
    unused = [word for word in unused if plain(word) not in used]
    scene = _with_kinds(scene, [kinds[place] for place in sorted(kinds)])
    changes = {"scene": scene, "beside": beside, "unused": tuple(dict.fromkeys(unused))}
    return brief.model_copy(update=changes)


def with_kinds_changed(line: str, words: str) -> str:
    """Returns a plan of changes in which the kinds that the words name stand for those that a network knows;
    where the words also name one of these, they stay."""
    road, mark, scene = line.partition(SCENE)
    named = {each.name for each in mentions_in(words)}
    for known in {known_as(name) for name in named} - named:
        like = [name for name in named if known_as(name) == known]
        scene = re.sub(rf"\b{known}\b", like[0], scene) if len(like) == 1 else scene
    return road + mark + scene


def _unnamed(known: ActorKind, scene: Scene, told: list[Mention]) -> list[int]:
    """Returns the places of actors of a like kind that the words do not name: a network took the word for
    theirs, as it may read a pickup as a truck."""
    named = {known_as(each.name) for each in told}
    group = ROAD_USERS[known].group
    alike = [place for place, role in enumerate(scene.actors) if ROAD_USERS[role.kind].group == group]
    return [place for place in alike if scene.actors[place].kind not in named]


def _once_each(told: list[Mention]) -> list[Mention]:
    """Returns the mentions without the tested car, and without those of somebody who was named before."""
    out, before = list[Mention](), set[str]()
    for each in told:
        if not (each.is_denied or each.is_own or (each.before in AGAIN and each.name in before)):
            out.append(each)
        before.add(each.name)
    return out


def _renamed(
    known: ActorKind, places: list[int], told: list[Mention], words: str, unused: list[str]
) -> dict[int, ActorKind]:
    """Returns the kinds of those actors that the networks read as one kind that they know."""
    new = [each for each in told if each.name != known]
    names = [cast("ActorKind", each.name) for each in (told if len(told) == len(places) else new)]
    if len({*names}) == 1 and len(told) == len(new):
        names = names[:1] * len(places)
    said = [words[each.start : each.end] for each in new]
    if names and len(names) == len(places):
        unused[:] = [word for word in unused if word not in said]
        return dict(zip(places, names, strict=True))
    unused += said
    return {}


def _with_kinds(scene: Scene, kinds: list[ActorKind]) -> Scene:
    """Returns the scene with other kinds of its actors; events name the same ones as before."""
    now = dict(zip(_numbered([role.kind for role in scene.actors]), _numbered(kinds), strict=True))
    actors = []
    for role, kind in zip(scene.actors, kinds, strict=True):
        actions = []
        for action in role.actions:
            mark = action.at
            if mark and (mark.of, mark.number) in now:
                new = now[cast("ActorKind", mark.of), mark.number]
                mark = mark.model_copy(update=dict(zip(("of", "number"), new, strict=True)))
            actions.append(action.model_copy(update={"at": mark}))
        actors.append(role.model_copy(update={"kind": kind, "actions": tuple(actions)}))
    return scene.model_copy(update={"actors": tuple(actors)})


def _numbered(kinds: Sequence[ActorKind]) -> list[tuple[ActorKind, int]]:
    return [(kind, kinds[: place + 1].count(kind)) for place, kind in enumerate(kinds)]
