"""Reads a change request, such as "make the second turn wider", and returns it as an EditRequest.

``read_request`` reads words with RoadGPT's neural network; ``plan.read_change_plan`` reads plans.
``design.edit`` finds the turns and straights of the road to which a request refers.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache

from roadgpt.brief.change.clashes import refuse_clashes
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.change.request import EditRequest
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.confidence import DOUBT
from roadgpt.brief.refusal import MOST_CHARACTERS, causes_of
from roadgpt.errors import BriefError, EditError

ADVICE = "say for example: make the second turn sharper"
SHOWN = 60
"""The largest number of letters of a request that a message repeats."""


def checked_request(words: str | EditRequest) -> EditRequest:
    """Returns a change request after checking that all its changes can be made at once. A request in words
    is first read.

    Raises:
        EditError: the words cannot be read, as for ``read_request``; a change does not fit its place; or two
            changes need separate requests.
    """
    request = read_request(words) if isinstance(words, str) else words
    refuse_clashes(request.changes)
    return request


def read_request(words: str) -> EditRequest:
    """Reads what a change request asks for.

    Raises:
        EditError: the request is empty or too long, asks for no change that can be read, contradicts itself,
            or asks for something that cannot be built.
    """
    if not words.strip():
        raise EditError(f"no change was asked for; {ADVICE}")
    if len(words) > MOST_CHARACTERS:
        raise EditError(
            f"a change request of {len(words)} characters is too long; use {MOST_CHARACTERS} or less"
        )
    try:
        reading = _reader().read_change(words, _normal_form)
    except BriefError as error:
        raise EditError(str(error)) from error
    if reading.plan.startswith("!"):
        raise _refusal(words, reading.plan, next(iter(reading.others), ""))
    request = read_change_plan(reading.plan)
    return replace(
        request, words=words, unused=reading.unused, confidence=reading.confidence, others=reading.others
    )


def other_readings(request: EditRequest) -> Iterator[EditRequest]:
    """Yields the other likely readings of a change request, the likeliest first, each with a confidence of
    ``DOUBT`` or less. A reading whose changes need separate requests is left out.
    """
    for plan in request.others:
        other = read_change_plan(plan)
        with suppress(EditError):
            refuse_clashes(other.changes)
            yield replace(other, words=request.words, confidence=min(request.confidence, DOUBT))


@cache
def _reader() -> ModelReader:
    return ModelReader()


def _normal_form(line: str) -> str:
    return change_plan(read_change_plan(line))


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
