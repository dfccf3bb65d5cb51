"""Reads a change request, such as "make the second turn wider", and returns it as an EditRequest.

``read_request`` reads words with RoadGPT's neural network, or with a language model (``chatting``);
``plan.read_change_plan`` reads plans. To which turns and straights of a road a request refers is found by
who changes the road."""

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache

from roadgpt.brief.beside import slipperiest
from roadgpt.brief.change.clauses import told_in, unnamed_in
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.change.request import EditRequest, refuse_clashes
from roadgpt.brief.change.spoken import spoken
from roadgpt.brief.languages import pattern_of
from roadgpt.brief.plan import SCENE
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.trained import DOUBT
from roadgpt.brief.refusal import MOST_CHARACTERS, causes_of
from roadgpt.chat import ChatSettings
from roadgpt.errors import BriefError, EditError
from roadgpt.language.table import SURFACES

ADVICE = "say for example: make the second turn sharper"
BY_RULES = 0.9  # how sure a reading by rules alone is
SHOWN = 60
"""The largest number of letters of a request that a message repeats."""


def checked_request(words: str | EditRequest) -> EditRequest:
    """Returns a change request after checking that all its changes can be made at once. A request in words
    is first read.

    Raises:
        EditError: the words cannot be read, as for ``read_request``; a change does not fit its place; or two
            changes need separate requests."""
    request = read_request(words) if isinstance(words, str) else words
    refuse_clashes(request.changes)
    return request


def read_request(words: str, chat: ChatSettings | None = None) -> EditRequest:
    """Reads what a change request asks for, with RoadGPT's neural network, or with the language model that
    ``chat`` names.

    Raises:
        EditError: the request is empty or too long, asks for no change that can be read, contradicts itself,
            or asks for something that cannot be built.
        ChatError: the language model could not be asked."""
    if not words.strip():
        raise EditError(f"no change was asked for; {ADVICE}")
    if len(words) > MOST_CHARACTERS:
        raise EditError(
            f"a change request of {len(words)} characters is too long; use {MOST_CHARACTERS} or less"
        )
    if chat is not None:
        from roadgpt.brief.change.chatting import request_by_chat  # most requests need no language model

        surface, named = _surface_in(words)
        request = request_by_chat(words, chat, surface)
        unused = request.unused if surface else tuple(dict.fromkeys((*named, *request.unused)))
        return replace(request, unused=unused)
    told, rest, dropped = told_in(words)
    if told:
        own = replace(read_change_plan(f"{SCENE} {'; '.join(told)}"), words=words, unused=tuple(dropped))
        return replace(own, confidence=BY_RULES) if not rest else _with_rest(own, ", ".join(rest))
    try:
        reading = _reader().read_change(words, lambda line: change_plan(read_change_plan(line)))
    except BriefError as error:
        raise EditError(str(error)) from error
    surface, named = _surface_in(words)
    missed = unnamed_in(words, reading.plan) if SCENE in reading.plan else named
    unused = tuple(dict.fromkeys((*missed, *reading.unused)))
    if surface:
        unused = tuple(word for word in unused if word not in named)
        if reading.plan.split() == ["!impossible", surface]:
            return EditRequest(words, (), unused, reading.confidence, surface=surface)
    if reading.plan.startswith("!"):
        raise _refusal(words, reading.plan, next(iter(reading.others), ""))
    request = spoken(read_change_plan(reading.plan))
    return replace(
        request,
        words=words,
        unused=unused,
        confidence=reading.confidence,
        others=reading.others,
        surface=surface,
    )


def _with_rest(told: EditRequest, words: str) -> EditRequest:
    """Returns a request with what the networks read in other words, which are unused where it is doubtful."""
    with suppress(EditError):
        rest = read_request(words)
        if rest.confidence >= DOUBT:
            scene, unused = (*told.scene, *rest.scene), (*told.unused, *rest.unused)
            return replace(rest, words=told.words, scene=scene, unused=unused, others=())
    return replace(told, unused=(*told.unused, words), confidence=DOUBT)


def _surface_in(words: str) -> tuple[str, tuple[str, ...]]:
    """Returns the slipperiest surface that the words ask for, and the words that name a surface. The surface
    is "" if there is none, or if the words may deny it."""
    found = {name: tuple(pattern_of(name, "surfaces", re.I).findall(words)) for name in SURFACES}
    named = [name for name, those in found.items() if those]
    is_denied = pattern_of("denials", flags=re.I).search(words)
    return "" if is_denied else slipperiest(named) or "", tuple(
        word for name in named for word in found[name]
    )


def other_readings(request: EditRequest) -> Iterator[EditRequest]:
    """Yields the other likely readings of a change request, the likeliest first, each with a confidence of
    ``DOUBT`` or less. A reading whose changes need separate requests is left out."""
    for plan in request.others:
        other = spoken(read_change_plan(plan))
        with suppress(EditError):
            refuse_clashes(other.changes)
            yield replace(other, words=request.words, confidence=min(request.confidence, DOUBT))


@cache
def _reader() -> ModelReader:
    return ModelReader()


def _refusal(words: str, plan: str, other: str) -> EditError:
    """Returns the error for a request that is refused; if it is only unclear, the error offers a plan."""
    shown = " ".join(words.split())
    shown = shown if len(shown) <= SHOWN else f"{shown[: SHOWN - 3].rstrip()}..."
    kind, causes = causes_of(plan)
    match kind:
        case "!contradiction":
            about = f" about {causes}" if causes else ""
            return EditError(f"'{shown}' contradicts itself{about}; leave one of the wishes out")
        case "!impossible":
            return EditError(
                f"'{shown}' cannot be done: {causes or 'no road can be like that'}; leave that out"
            )
        case "!unclear":
            advice = f'or is this meant: --plan "{other}"' if other else ADVICE
            return EditError(f"'{shown}' does not say what is to change where; {advice}")
        case _:
            return EditError(f"'{shown}' is no change of a road that I know; {ADVICE}")


__all__ = ["EditRequest", "checked_request", "other_readings", "read_request"]
