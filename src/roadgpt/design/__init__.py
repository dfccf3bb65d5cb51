"""Makes Designs from Briefs. Main function: ``draft``.

A designer is a class, called without arguments, or with ChatSettings if it has a parameter ``settings``. Its
instances have one method:

    def draft(self, brief, world, notes, earlier, seed) -> Design

``notes`` are sentences that say which rules the previous draft violated, and where. ``earlier`` are the
designs of the campaign so far; the new one should differ from all of them. The same arguments give the same
Design. If no road can meet all requirements on this map, the method raises DesignError with one sentence of
advice.

A designer may also have these attributes:

report           a DesignReport of its last draft
redrafts         False if the designer must not be called again when its draft violates a rule
makes_junctions  True if the designer can make networks: routes with junctions, and maps of roads
geometry         the kind of geometry that its designs require, such as "spline" for RoadGPT's original
                 splines; it overrides the user's choice"""

from collections.abc import Sequence
from typing import Any, Protocol, cast

from roadgpt.brief.model import Brief, Frozen
from roadgpt.chat import ChatSettings, Usage, plugin_of
from roadgpt.design.unbuilt import check_built
from roadgpt.errors import DesignError
from roadgpt.road import Design, World

__all__ = ["DesignReport", "Designer", "check_designer", "designer_of", "draft", "draft_road"]


class DesignReport(Frozen):
    """How a language model made one draft: its proposal, the changes to it, requests, time and cost."""

    rounds: int = 0
    """Number of requests to the model."""
    changes: tuple[str, ...] = ()
    """Sentences that say what was changed in the model's proposal."""
    tokens: Usage = Usage()
    """Tokens that the model read and wrote."""
    seconds: float = 0.0
    """Time in seconds that the model took."""
    cost: float | None = None
    """Cost in USD; None if the price is not known."""
    model: str = ""
    """Name of the model as reported by its server."""
    proposed: dict[str, Any] | None = None
    """The model's proposal before any change, in RoadGPT's segment format; None if there was none."""


class Designer(Protocol):
    """A plug-in that turns a Brief into a Design."""

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> Design:
        """Returns a Design that meets every requirement of the Brief and is valid on this map. The arguments
        are those of the function ``draft``. Raises DesignError if this designer found no such Design."""
        ...


def draft(
    brief: Brief,
    world: World,
    notes: tuple[str, ...] = (),
    earlier: Sequence[Design] = (),
    seed: int = 0,
    designer: str = "planner",
    chat: ChatSettings | None = None,
) -> Design:
    """Returns a Design for a Brief of a road, a route or a map.

    ``notes`` are sentences that say which rules the previous draft violated, and ``earlier`` the designs of
    the campaign so far, from which the new one should differ. ``designer`` is the name of an installed
    designer, and ``chat`` the settings of the language model, for designers that use one; None for the user's
    settings.

    Raises DesignError if no road meets all requirements on this map, UsageError if there is no designer of
    that name, a junction cannot meet its requirements, or the World has lanes or banked bends that a map of
    roads cannot have, and ChatError if the language model could not be asked."""
    made = designer_of(designer, chat)
    check_designer(made, brief)
    return made.draft(brief, world, notes, earlier, seed)


def draft_road(brief: Brief, world: World, earlier: Sequence[Design] = (), seed: int = 0) -> Design:
    """Returns a Design for a Brief of a single road, made by the default designer; see ``draft``. Raises
    DesignError if no road meets all requirements on this map, or the Brief asks for a network."""
    found = draft(brief, world, (), earlier, seed)
    if not found.is_plain:
        raise DesignError(
            "this takes single roads only; leave out junctions, medians and traffic on the left"
        )
    return found


def check_designer(designer: Designer, brief: Brief) -> None:
    """Raises DesignError if a Brief asks for something that cannot be built yet, or for a network, and the
    designer makes single roads only."""
    check_built(brief)
    if brief.is_of_network and not getattr(designer, "makes_junctions", False):
        raise DesignError(
            "this designer makes single roads without junctions, medians and traffic on the left; leave "
            "--designer out"
        )


def designer_of(name: str, chat: ChatSettings | None = None) -> Designer:
    """Returns the designer of the given name, with settings of the language model for designers that use one;
    None for the user's settings. Raises PartError if there is no designer of that name."""
    return cast(Designer, plugin_of("designers", name, chat))  # made once: it caches shapes of designs
