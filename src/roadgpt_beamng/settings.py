"""Reads the settings of BeamNG from environment variables. RoadGPT also writes the command-line
options for BeamNG to these variables, so that worker processes get the same settings.

Each field of ``BeamngSettings`` has a variable: ``ROADGPT_BEAMNG_`` plus the field's name in capitals, such
as ROADGPT_BEAMNG_PORT.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from roadgpt.errors import UsageError, advice_on
from roadgpt.settings import Row, field, rows_in

PREFIX = "ROADGPT_BEAMNG_"
ROWS = rows_in(Path(__file__).with_name("options.toml"))["beamng"]


class BeamngSettings(BaseModel):
    """All settings of BeamNG, with their defaults."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    options: ClassVar[Mapping[str, Row]] = ROWS
    libraries: ClassVar[tuple[str, ...]] = ("beamngpy",)
    """Libraries whose versions are recorded; that of the Python client determines the version of BeamNG."""

    home: Path | None = field(ROWS["home"])
    """BeamNG's folder. If it is None, RoadGPT does not start BeamNG, but uses one that is already running."""
    user: Path | None = field(ROWS["user"])
    host: str = field(ROWS["host"])
    port: int = field(ROWS["port"])
    """Port of the first worker; the others use the next free ports."""
    headless: bool = field(ROWS["headless"])
    nogpu: bool = field(ROWS["nogpu"])
    """Whether BeamNG runs without graphics; without graphics, drivers that need images cannot be used."""
    gfx: Literal["dx11", "vk"] | None = field(ROWS["gfx"])
    level: str = field(ROWS["level"])
    model: str = "etk800"
    aggression: float = field(ROWS["aggression"])
    """Aggression of BeamNG's AI; the default is that of the SBFT competition."""
    rate: Annotated[int, Field(ge=20, le=200)] = 50
    """Physics steps and samples per second."""
    recycle: int = field(ROWS["recycle"])
    """BeamNG has been seen to fail after about 500 roads (BeamNGpy issue 159)."""
    start_timeout: Annotated[float, Field(gt=0)] = 180.0
    """Seconds within which BeamNG must answer after its start."""
    load_timeout: Annotated[float, Field(gt=0)] = 120.0
    """Seconds within which a level must be loaded."""
    first_load_timeout: Annotated[float, Field(gt=0)] = 600.0
    """Seconds within which the first level must be loaded; BeamNG may compile shaders during this time."""
    poll_timeout: Annotated[float, Field(gt=0)] = 20.0
    """Seconds within which BeamNG must give any other answer."""
    imitation: bool = False
    """Whether the driver ``beamng_like``, an imitation of BeamNG's AI, is run in BeamNG. If False,
    BeamNG's AI drives in its place."""

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> Self:
        """Returns the settings that the environment variables define.

        If the variables of ``home`` and ``host`` are not set, BNG_HOME gives the folder of BeamNG.
        """
        given = {
            name: environment[PREFIX + name.upper()]
            for name in cls.model_fields
            if environment.get(PREFIX + name.upper())
        }
        if "home" not in given and environment.get("BNG_HOME") and "host" not in given:
            given["home"] = environment["BNG_HOME"]
        try:
            return cls(**given)
        except ValidationError as error:
            first = error.errors()[0]
            name = PREFIX + str(first["loc"][0]).upper()
            raise UsageError(f"{name} cannot be '{first['input']}'; {advice_on(first)}") from error

    @property
    def launches(self) -> bool:
        """Whether RoadGPT starts BeamNG, instead of using a running BeamNG."""
        return self.home is not None

    def summary(self) -> str:
        """Returns one line with the settings that affect how a road is driven."""
        level = self.level or "tig, or another flat level"
        return f"{self.model} on {level}, aggression {self.aggression:g}, {self.rate} steps/s"
