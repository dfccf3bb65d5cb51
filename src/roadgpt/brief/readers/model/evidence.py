"""Decides by rules which numbers a plan may contain although the description does not state them.

Words can imply a number ("right angle", "mountain road"). A plan may contain such a number only if some word
of the description, in any of the five languages, can imply it.
"""

import re
from dataclasses import dataclass

from roadgpt.brief.readers.model.computed_numbers import Compared

ANGLE = re.compile(
    r"kink|dog|leg|square|right.angle|angle|wink|knick|orthog|perpend|angolo|angulo|equerre|coude|quiebr|codo|gomito"
    r"|piega|quarter|decroch|recod|baionn|ninety|neunzig|quatre|noventa|novanta|forty|\d|unused"
    r"|hairpin|switchback|haarnadel|kehre|epingle|lacet|horquilla|tornant"
    r"|half|halb|semi|demi|medi[oa]|mezz|round|back|opposite|turned|facing|headed|way we came"
    r"|gegen|zuruck|retour|contrari|vuelta|inver|empez|comin|stair|trepp|escal|scal"
    r"|letter|buchstab|lettre|letra|lettera|outline|form|shape|\b[zluvn]\b"
)
MOUNTAIN = re.compile(
    r"mount|mont|berg|alp|pass|\bcol\b|puerto|gebirg|sierra|valico|dolomit|andes|pyren|serra|vette|cordill|himal"
    r"|steep|steil|raide|pente|pentu|empinad|pendiente|pendenz|ripid|erto|erta|brusc"
    r"|grade|gradient|slope|inclin|neig|roll|wav|well|ond|hill|hugel|colin|coll|lom|vallon|bosse|up.{1,6}down|auf.{1,6}ab"
)
HILLY = re.compile(
    r"hill|roll|undul|wave|wavy|up.{1,20}down|wellig|welle|hugel|auf.{1,6}ab|vallon|colin|coll|ond|saliscend|russ|coaster"
    r"|rise|climb|bosse|lomas|subid|dune|hump|crest|heav|hoch.*runter|vagues|vaux"
    r"|flat|level|eben|flach|platt?|llan|plan|pian|lomer|inver|fall|gefall|steig|rasant|pendenz|pendient|pente"
)


@dataclass(frozen=True, slots=True)
class Evidence:
    """The numbers that a description can imply: angles ("right angle"), a grade ("mountain road"), a number
    of hills ("rolling"), and figures that it tells by others ("twice as long").
    """

    angles: bool = True
    mountains: bool = True
    hills: bool = True
    compared: Compared | None = None

    @classmethod
    def of(cls, text: str) -> "Evidence":
        """Returns which numbers a description can imply; the text must be in lower case and without
        accents.
        """
        patterns = (ANGLE, MOUNTAIN, HILLY)
        angles, mountains, hills = (pattern.search(text) is not None for pattern in patterns)
        return cls(angles, mountains, hills, Compared.of(text))
