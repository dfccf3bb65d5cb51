"""Defines errors and messages for refused descriptions, and the largest length of a description.

``TooMuchError`` and ``NoRoomError`` contain the Brief, because a larger map may hold the road.
``AnotherRoadError`` contains the plan and the Brief of a road that can be built."""

from roadgpt.brief.beside import NOT_BUILT, ON_ROUTES, SAID_OTHERWISE, TEXTS, networks_in
from roadgpt.brief.model import Brief
from roadgpt.errors import BriefError
from roadgpt.language.table import SURFACES

MOST_CHARACTERS = 6000
"""The largest number of characters in a description."""
EXAMPLE = "say for example 'an uphill road with 3 turns'"
"""The end of the message for a description that is empty or says nothing about a road."""
ADVICE, CLASHING, BEYOND = (TEXTS[part] for part in ("refusals", "clashing", "beyond"))
"""The refusals of the plan language, with the message for one that names no cause; and the causes of a
contradiction, and those for which a road cannot be built, with their wording in the message."""
BY_OPTION = {
    **SAID_OTHERWISE,
    **{name: f"the surface is set with --friction {each.friction:g}" for name, each in SURFACES.items()},
    "climb": "a height in metres cannot be changed yet; say the slope in percent",
}
"""Wishes that must be given by an option or in other words, by name, with the advice for each."""
OF_CAUSES = {"!contradiction": CLASHING, "!impossible": NOT_BUILT | BEYOND | BY_OPTION}
"""The causes that each refusal can have, with the wording of each cause in the message."""


def causes_of(line: str) -> tuple[str, str]:
    """Returns the kind of a refusal, such as "!impossible", and its causes in words ("" if it names none).
    Raises BriefError if the plan is not a refusal, or has causes that this kind of refusal cannot have."""
    kind, *causes = line.split()
    known = OF_CAUSES.get(kind, {})
    if kind not in ADVICE or any(cause not in known for cause in causes):
        raise BriefError(f"a plan has no refusal '{line.strip()[:60]}'; begin one with {', '.join(ADVICE)}")
    return kind, " and ".join(known[cause] for cause in dict.fromkeys(causes))


def refused(line: str) -> BriefError:
    """Returns, without raising it, the error for a plan that is a refusal, such as '!impossible loop'."""
    try:
        kind, said = causes_of(line)
    except BriefError as error:
        return error
    if not said:
        return BriefError(ADVICE[kind])
    if kind == "!contradiction":
        return BriefError(f"the description contradicts itself about {said}; leave one of them out")
    if all(cause in ON_ROUTES for cause in line.split()[1:]):
        return BriefError(networks_in(line.split()[1:]))
    if BY_OPTION.keys() & {*line.split()}:
        return BriefError(f"words do not do this: {said}")
    return BriefError(f"no such road can be built: {said}; leave that out")


class _TooLargeError(BriefError):
    def __init__(self, sentence: str, brief: Brief) -> None:
        super().__init__(sentence)
        self.brief = brief


class NoRoomError(_TooLargeError):
    """Raised if the map is too small for the requirements, which are in ``brief``."""


class TooMuchError(_TooLargeError):
    """Raised if a description asks for more than the usual map of 250 m can hold; ``brief.read`` checks the
    requirements in ``brief`` against the actual map, which may be larger."""


class AnotherRoadError(BriefError):
    """Raised if a description cannot be built as it is, but another road may be what is meant: the likeliest
    plan without a contradiction, or the road without what a reader put into ``Brief.beside`` although it
    cannot stand there, such as a roundabout.

    Attributes:
        offer: why the description cannot be built, and what is offered instead; a colon and the plan, or a
            description of the road, can be added.
        plan: the plan of the road that is offered.
        brief: the requirements of this plan."""

    def __init__(self, offer: str, plan: str, brief: Brief) -> None:
        super().__init__(f'{offer}: --plan "{plan}"')
        self.offer, self.plan, self.brief = offer, plan, brief
