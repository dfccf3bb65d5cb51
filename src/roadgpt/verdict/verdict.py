"""Defines the Verdict: whether the car kept its lane, by how many metres, and where it first failed."""

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
    """The result of one drive. Positions are those of the car's centre of gravity where it first failed."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid", allow_inf_nan=False)

    outcome: Outcome
    cause: Cause | None
    """None if the car kept its lane to the goal."""
    description: str
    """One sentence."""
    sbft_description: str
    """The ``description`` of the SBFT tool competition, without the name of the simulation."""
    max_oob: float
    """Largest share of the car's box outside the right lane, 0..1, over the whole drive except the step at
    which it reached the goal or was stuck."""
    margin: float
    """Metres, see `roadgpt.verdict.margin`: how much farther sideways the car could have been before failing,
    at the step where it was closest; negative exactly if it left its lane or fell."""
    oob_counter: int
    """How many times the share outside rose above the tolerance."""
    beyond: float | None = None
    """Metres by which the car's body reached beyond the outer edge of a marking of its lane, the maximum over
    the same steps as ``max_oob``; 0 if it never did. The centre line bounds the lane on its left, the edge
    line on its right. None in a file of an older version without a drive beside it."""
    at_s: float | None = None
    """Metres along the road where it failed; None if it kept its lane."""
    at_xy: tuple[float, float] | None = None
    """Metres."""
    at_time: float | None = None
    """Seconds since the start."""
    side: Side | None = None
    """The side on which it left its lane or fell; None for other outcomes."""

    @property
    def severity(self) -> Severity:
        """How far outside its lane the car was, independent of the outcome."""
        return severity(self.max_oob)

    @property
    def kept(self) -> bool:
        """Whether the car kept its lane and reached the goal."""
        return self.outcome == "PASS"

    def to_json(self) -> dict[str, Any]:
        """Returns plain data, ``kept`` included, from which ``Verdict.from_json`` restores the verdict."""
        data = asdict(self)
        data["at_xy"] = None if self.at_xy is None else list(self.at_xy)
        return {"kept": self.kept, **data}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """Restores the verdict that ``to_json`` returned.

        Raises:
            UsageError: a field is missing or unknown, or its value is invalid.
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
