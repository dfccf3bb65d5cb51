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
                 splines; it overrides the user's choice
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, cast

from roadgpt.brief.model import Brief
from roadgpt.chat import ChatSettings, plugin_of
from roadgpt.design.unbuilt import check_built
from roadgpt.errors import DesignError
from roadgpt.road import Design, World

if TYPE_CHECKING:
    from roadgpt.network import AnyDesign


class Designer(Protocol):
    """A plug-in that turns a Brief into a Design."""

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> "AnyDesign":
        """Returns a Design that meets every requirement of the Brief and is valid on this map.

        If the Brief asks for a map of roads, the result is a MapDesign; if it asks for another network
        (``is_of_network``), the result is a NetworkDesign. The arguments are those of the function ``draft``.

        Raises:
            DesignError: this designer found no such Design, or cannot make networks.
        """
        ...


def draft(
    brief: Brief,
    world: World,
    notes: tuple[str, ...] = (),
    earlier: Sequence[Design] = (),
    seed: int = 0,
    designer: str = "planner",
    chat: ChatSettings | None = None,
) -> "AnyDesign":
    """Returns a Design for a Brief; for a network a NetworkDesign, and for a map of roads a MapDesign.

    Args:
        brief: the requirements for the road.
        world: size of the map, and limits that the rules check, such as the steepest grade.
        notes: sentences that say which rules the previous draft violated.
        earlier: designs of the campaign so far; the new one should differ from them.
        seed: seed of the random number generator.
        designer: name of an installed designer.
        chat: settings of the language model, for designers that use one; None for the user's settings.

    Raises:
        DesignError: no road meets all requirements on this map.
        UsageError: there is no designer of that name, a junction cannot meet its requirements, or the World
            has lanes or banked bends that a map of roads cannot have.
        ChatError: the language model could not be asked.
    """
    made = designer_of(designer, chat)
    check_designer(made, brief)
    return made.draft(brief, world, notes, earlier, seed)


def draft_road(brief: Brief, world: World, earlier: Sequence[Design] = (), seed: int = 0) -> Design:
    """Returns a Design for a Brief of a single road, made by the default designer.

    The arguments are those of ``draft``.

    Raises:
        DesignError: no road meets all requirements on this map, or the Brief asks for a network.
    """
    found = draft(brief, world, (), earlier, seed)
    if not isinstance(found, Design):
        raise DesignError(
            "this takes single roads only; leave out junctions, medians and traffic on the left"
        )
    return found


def check_designer(designer: Designer, brief: Brief) -> None:
    """Checks that a designer can make what a Brief asks for.

    Raises:
        DesignError: the Brief asks for something that cannot be built yet, or it asks for a network and the
            designer makes single roads only.
    """
    check_built(brief)
    if brief.is_of_network and not getattr(designer, "makes_junctions", False):
        raise DesignError(
            "this designer makes single roads without junctions, medians and traffic on the left; leave "
            "--designer out"
        )


def designer_of(name: str, chat: ChatSettings | None = None) -> Designer:
    """Returns the designer of the given name.

    Args:
        name: name of an installed designer.
        chat: settings of the language model, for designers that use one; None for the user's settings.

    Raises:
        PartError: there is no designer of that name.
    """
    return cast(Designer, plugin_of("designers", name, chat))  # made once: it caches shapes of designs


__all__ = ["Designer", "check_designer", "designer_of", "draft", "draft_road"]
