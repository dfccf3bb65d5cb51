"""Reads the settings of BeamNG from environment variables. RoadGPT also writes the command-line
options for BeamNG to these variables, so that worker processes get the same settings.

Each field of ``BeamngSettings`` has a variable: ``ROADGPT_BEAMNG_`` plus the field's name in capitals, such
as ROADGPT_BEAMNG_PORT.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from roadgpt.errors import UsageError, advice_on

OF_USER: dict[str, Any] = {"of_user": True, "open": True}
PREFIX = "ROADGPT_BEAMNG_"
PORT = 25252  # BeamNG's default since 0.34


def _switch(flag: str, sentence: str, usual: Any) -> Any:
    return Field(usual, description=sentence, json_schema_extra={"flag": f"--{flag}"})


class BeamngSettings(BaseModel):
    """All settings of BeamNG, with their defaults."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    libraries: ClassVar[tuple[str, ...]] = ("beamngpy",)
    """Libraries whose versions are recorded; that of the Python client determines the version of BeamNG."""

    home: Path | None = Field(
        None, description="Folder of the BeamNG.tech to start (for --simulator beamng)."
    )
    """BeamNG's folder. If it is None, RoadGPT does not start BeamNG, but uses one that is already running."""
    user: Path | None = Field(
        None, description="BeamNG's user folder; each further worker gets one next to it."
    )
    host: str = Field(
        "127.0.0.1", description="Host of a BeamNG that is already running.", json_schema_extra=OF_USER
    )
    port: int = Field(
        PORT, ge=1, le=65535, description="Port of BeamNG. [default: 25252]", json_schema_extra=OF_USER
    )
    """Port of the first worker; the others use the next free ports."""
    headless: bool = _switch("headless", "Run BeamNG without a window.", False)
    nogpu: bool = _switch("nogpu", "Run BeamNG without rendering.", False)
    """Whether BeamNG runs without graphics; without graphics, drivers that need images cannot be used."""
    gfx: Literal["dx11", "vk"] | None = _switch("gfx", "Graphics API that BeamNG uses.", None)
    level: str = Field(
        "",
        description="BeamNG level for the roads. [default: SBFT's level tig if installed, else a flat one]",
    )
    model: str = "etk800"
    aggression: float = Field(
        0.7, ge=0.3, le=1.0, description="Aggression of BeamNG's AI, 0.3 to 1. [default: 0.7]"
    )
    """Aggression of BeamNG's AI; the default is that of the SBFT competition."""
    rate: Annotated[int, Field(ge=20, le=200)] = 50
    """Physics steps and samples per second."""
    recycle: int = Field(100, ge=1, description="Restart BeamNG after this many roads. [default: 100]")
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
