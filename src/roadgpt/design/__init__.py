"""Drafts: makes Designs from Briefs, with geometry and rules at hand. Main function: ``draft``.

A designer is a class without arguments, or one that takes ChatSettings as ``settings``, whose objects have
one method:

    def draft(self, brief, world, notes, earlier, seed) -> Design

``notes`` are the sentences of rules that objected to a draft before; ``earlier`` are the designs of the
campaign so far, none of which it repeats. The same arguments give the same Design. It raises DesignError,
with one sentence of advice, where no road can keep every promise on this map.

Besides, a designer may have ``report``, a DesignReport of its last draft. One whose class says
``redrafts = False`` is not asked again when rules object. One whose class has a ``geometry`` means its
segments so, whatever the user prefers: "spline" for RoadGPT's hops.
"""

from collections.abc import Sequence
from functools import cache
from typing import Protocol, cast

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.chat import ChatSettings, instantiate, settings_for
from roadgpt.road import Design, World


class Designer(Protocol):
    """Turns a Brief into a Design."""

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> Design:
        """Returns a Design that meets every requirement of the Brief and is valid on this map.

        Raises:
            DesignError: there is none, as far as this designer can tell.
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
) -> Design:
    """Returns a Design for a Brief, made by the designer of that name.

    Args:
        brief: what was asked for.
        world: map and limits.
        notes: sentences of rules that objected to the draft before.
        earlier: designs of the campaign so far, which are not repeated.
        seed: of all that is left to chance.
        designer: name of a part on the shelf ``designers``.
        chat: the language model, for designers that ask one; None: what the user's settings say.

    Raises:
        DesignError: no road keeps every promise on this map.
        PartError: there is no designer of that name.
        ChatError: a language model could not be asked.
    """
    return designer_of(designer, chat).draft(brief, world, notes, earlier, seed)


def designer_of(name: str, chat: ChatSettings | None = None) -> Designer:
    """Returns the designer of that name."""
    return _made(name, settings_for(plugins.find("designers", name), chat))


@cache
def _made(name: str, chat: ChatSettings | None) -> Designer:
    """The one designer of that name: it remembers the shapes of earlier designs."""
    return cast(Designer, instantiate(plugins.find("designers", name), chat))


__all__ = ["Designer", "designer_of", "draft"]
