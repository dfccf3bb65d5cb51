"""The Verdict: whether the car kept its lane, by how many metres, and where it first did not."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Literal, Self

from pydantic import ConfigDict, ValidationError

from roadgpt.errors import UsageError
from roadgpt.reading import strictly
from roadgpt.verdict.severity import Severity, severity

Outcome = Literal["PASS", "FAIL"]
Cause = Literal["out of lane", "fell", "stuck", "timeout"]
Side = Literal["left", "right"]


@dataclass(frozen=True)
class Verdict:
    """What became of one drive. Places are those of the car's centre of gravity where it first failed."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid", allow_inf_nan=False)

    outcome: Outcome
    cause: Cause | None
    """None when the car kept its lane to the goal."""
    description: str
    """One sentence."""
    sbft_description: str
    """What the SBFT tool competition writes into ``description``, without the name of the simulation."""
    max_oob: float
    """Largest share of the car's box outside the right lane, 0..1, over the whole drive but the step at which
    it came to the goal or was stuck."""
    margin: float
    """Metres, see `roadgpt.verdict.margin`: how far sideways the car still was from failing where it came
    closest; negative exactly when it left its lane or fell."""
    oob_counter: int
    """How many times the car went from inside the tolerance to outside it."""
    beyond: float | None = None
    """Metres that the car's body reached beyond the outer edge of a marking of its lane, at most and at the
    same steps as ``max_oob``; 0 where it never did. The centre line bounds the lane on its left, the edge
    line on its right. None in a file of an older version that has no drive beside it."""
    at_s: float | None = None
    """Metres along the road where it failed; None when it kept its lane."""
    at_xy: tuple[float, float] | None = None
    """Metres."""
    at_time: float | None = None
    """Seconds since the start."""
    side: Side | None = None
    """Where it left its lane or fell; None for other outcomes."""

    @property
    def severity(self) -> Severity:
        """How far outside its lane the car was, whatever the outcome."""
        return severity(self.max_oob)

    @property
    def kept(self) -> bool:
        """The car kept its lane, and came to the goal."""
        return self.outcome == "PASS"

    def to_json(self) -> dict[str, Any]:
        """Plain data, ``kept`` included; ``Verdict.from_json`` gives the verdict back."""
        data = asdict(self)
        data["at_xy"] = None if self.at_xy is None else list(self.at_xy)
        return {"kept": self.kept, **data}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The verdict that ``to_json`` wrote.

        Raises:
            UsageError: a field is missing or unknown, or holds what a verdict cannot.
        """
        try:
            fields = {key: value for key, value in data.items() if key != "kept"}
            return strictly(cls, fields)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            said = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
            raise UsageError(f"the verdict cannot be read ({said}): judge the drive again") from error
        except (AttributeError, TypeError, ValueError) as error:
            raise UsageError(f"the verdict cannot be read ({error}): judge the drive again") from error
