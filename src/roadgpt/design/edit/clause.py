"""Defines a clause of a change request: the places that it names, and its other words."""

from dataclasses import dataclass, field

from roadgpt.design.edit.lexing import RequestLexeme
from roadgpt.design.edit.request import Place, Target

IDLE = {"too", "make", "keep", "with", "of", "at", "as", "to", "by", "a", "the", "on", "much", "slightly"}
"""Words that ask for nothing by themselves."""


@dataclass
class RequestClause:
    """One clause of a change request: the places and the new elements that it names, and its other words."""

    targets: list[Target] = field(default_factory=list)
    new: list[Target] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    row: list[RequestLexeme] = field(default_factory=list)
    """The lexemes that do not name places: verbs, comparatives and amounts."""
    unknown: list[str] = field(default_factory=list)
    begins_unknown: bool = False
    """Whether the first word of the clause was not understood; it should be a verb."""
    words: str = ""

    @property
    def names(self) -> set[str]:
        """Names of the lexemes in ``row``."""
        return {lexeme.name for lexeme in self.row}

    @property
    def keeps(self) -> bool:
        """Whether the clause only says what must stay as it is."""
        return "keep" in self.names and not self.is_action

    @property
    def is_amount(self) -> bool:
        """Whether the clause is only a number."""
        named = self.targets or self.new or self.places or self.unknown
        return not named and "#" in self.names and self.names <= IDLE | {"#"}

    @property
    def is_action(self) -> bool:
        """Whether the clause asks for a change."""
        is_side = "make" in self.names and any(target.is_bare for target in self.targets)
        return bool(self.new) or is_side or bool(self.names - IDLE)
