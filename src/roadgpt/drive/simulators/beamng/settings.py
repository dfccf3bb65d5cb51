"""How BeamNG is started and driven: from the environment, where the command line puts its options.

Each field is read from ``ROADGPT_BEAMNG_`` and its name in capitals, so that worker processes have them too.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from roadgpt.errors import UsageError

PREFIX = "ROADGPT_BEAMNG_"
PORT = 25252  # BeamNG's own since 0.34


class Settings(BaseModel):
    """All that can be set; what is not given is as RoadGPT and the SBFT competition have it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    home: Path | None = None
    """BeamNG's folder; None: nothing is launched, a running BeamNG is asked."""
    user: Path | None = None
    """BeamNG's user folder; further workers get folders beside it."""
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=1, le=65535)] = PORT
    """Of the first worker; the others take the next free ones."""
    headless: bool = False
    nogpu: bool = False
    """Draws nothing; drivers that want images cannot drive."""
    gfx: Literal["dx11", "vk"] | None = None
    level: str = ""
    """Where roads are laid; empty: ``tig`` where it is installed, else a flat one that comes with BeamNG."""
    model: str = "etk800"
    aggression: Annotated[float, Field(ge=0.3, le=1.0)] = 0.7
    """Of BeamNG's AI; the competition's."""
    rate: Annotated[int, Field(ge=20, le=200)] = 50
    """Steps and samples per second."""
    recycle: Annotated[int, Field(ge=1)] = 100
    """Roads after which BeamNG is started anew; it was seen to fail after about 500 (BeamNGpy issue 159)."""
    start_timeout: Annotated[float, Field(gt=0)] = 180.0
    """s, until BeamNG answers."""
    load_timeout: Annotated[float, Field(gt=0)] = 120.0
    """s, for a level to load."""
    first_load_timeout: Annotated[float, Field(gt=0)] = 600.0
    """s, for the first level, with which BeamNG may compile shaders."""
    poll_timeout: Annotated[float, Field(gt=0)] = 20.0
    """s, for any other answer."""
    imitation: bool = False
    """Let ``beamng_like`` drive itself; else BeamNG's own AI, which it imitates, takes its seat."""

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> Self:
        """What the environment says.

        Raises:
            UsageError: a value cannot be.
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
        """Is BeamNG started here, or does it run already?"""
        return self.home is not None

    def summary(self) -> str:
        """What decides on how a road is driven, in one line."""
        level = self.level or "tig, or what is there"
        return f"{self.model} on {level}, aggression {self.aggression:g}, {self.rate} steps/s"
