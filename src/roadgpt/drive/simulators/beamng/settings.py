"""Reads the settings of BeamNG from environment variables. RoadGPT also writes the command-line
options for BeamNG to these variables, so that worker processes get the same settings.

Each field of ``BeamngSettings`` has a variable: ``ROADGPT_BEAMNG_`` plus the field's name in capitals, such
as ROADGPT_BEAMNG_PORT.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from roadgpt.errors import UsageError

PREFIX = "ROADGPT_BEAMNG_"
PORT = 25252  # BeamNG's default since 0.34


class BeamngSettings(BaseModel):
    """All settings of BeamNG, with their defaults."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    home: Path | None = None
    """BeamNG's folder. If it is None, RoadGPT does not start BeamNG, but uses one that is already running."""
    user: Path | None = None
    """BeamNG's user folder; worker processes after the first get folders next to it."""
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=1, le=65535)] = PORT
    """Port of the first worker; the others use the next free ports."""
    headless: bool = False
    nogpu: bool = False
    """Whether BeamNG runs without graphics; without graphics, drivers that need images cannot be used."""
    gfx: Literal["dx11", "vk"] | None = None
    level: str = ""
    """Level in which roads are placed; empty: the level ``tig`` if it is installed, else a flat level that
    comes with BeamNG."""
    model: str = "etk800"
    aggression: Annotated[float, Field(ge=0.3, le=1.0)] = 0.7
    """Aggression of BeamNG's AI; the default is that of the SBFT competition."""
    rate: Annotated[int, Field(ge=20, le=200)] = 50
    """Physics steps and samples per second."""
    recycle: Annotated[int, Field(ge=1)] = 100
    """Number of roads after which BeamNG is restarted; BeamNG has been seen to fail after about 500 roads
    (BeamNGpy issue 159)."""
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

        Raises:
            UsageError: the value of a variable is invalid.
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
            raise UsageError(f"{name} cannot be '{first['input']}': {first['msg'].lower()}") from error

    @property
    def launches(self) -> bool:
        """Whether RoadGPT starts BeamNG, instead of using a running BeamNG."""
        return self.home is not None

    def summary(self) -> str:
        """Returns one line with the settings that affect how a road is driven."""
        level = self.level or "tig, or another flat level"
        return f"{self.model} on {level}, aggression {self.aggression:g}, {self.rate} steps/s"
