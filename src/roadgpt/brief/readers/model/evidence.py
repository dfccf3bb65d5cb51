"""What must be in a description before a plan may have certain numbers; checked by rules.

Numbers that words carry without a digit ("right angle", "mountain road") are not written where no word of any
of the five languages could mean them.
"""

import re
from dataclasses import dataclass

ANGLE = re.compile(
    r"kink|dog|leg|square|right.angle|angle|winkel|knick|orthog|perpend|angolo|angulo|equerre|coude|quiebr|codo|gomito"
    r"|piega|quarter|decroch|recod|baionn|ninety|neunzig|quatre|noventa|novanta|forty|\d|unused"
)
MOUNTAIN = re.compile(
    r"mount|mont|berg|alp|pass|\bcol\b|puerto|gebirg|sierra|valico|dolomit|andes|pyren|serra|vette|cordill|himal"
)
HILLY = re.compile(
    r"hill|roll|undul|wave|wavy|up.{1,20}down|wellig|welle|hugel|auf.{1,6}ab|vallon|colin|coll|ond|saliscend|russ|coaster"
    r"|rise|climb|bosse|lomas|subid|dune|hump|crest|heav|hoch.*runter|vagues|vaux"
)


@dataclass(frozen=True, slots=True)
class Evidence:
    """Which of these numbers a description could mean."""

    angles: bool = True
    mountains: bool = True
    hills: bool = True

    @classmethod
    def of(cls, text: str) -> "Evidence":
        """Of the words of a description as the model sees them: lower case, no accents."""
        patterns = (ANGLE, MOUNTAIN, HILLY)
        return cls(*(pattern.search(text) is not None for pattern in patterns))
