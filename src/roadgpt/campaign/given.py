"""Roads that a campaign is given instead of words. Each is kept as a road file in the folder of the campaign,
so that its tests depend on nothing else:

roads/0001.json    the road or its design, with the World that it is driven in, as ``network.source`` reads it
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter

from roadgpt.campaign.model import GivenRoad
from roadgpt.errors import UsageError
from roadgpt.reading import ABSENT, json_of, read_bytes
from roadgpt.run.atomic import json_text, to_bytes, whole_folder

if TYPE_CHECKING:
    from roadgpt.network.source import RoadSource

FOLDER = "roads"


@cache
def _roads() -> TypeAdapter[tuple[GivenRoad, ...]]:
    return TypeAdapter(tuple[GivenRoad, ...])


def given_roads(settings: Mapping[str, Any]) -> tuple[GivenRoad, ...]:
    """Returns the roads in the settings of a plan or a cell; none if its roads are not given."""
    return _roads().validate_python(settings.get("roads", ()))


def kept_road(number: int, name: str, source: str, data: Mapping[str, Any]) -> tuple[GivenRoad, bytes]:
    """Returns road ``number``, from 1, and the content of the file that keeps its ``data``."""
    content = to_bytes(json_text(data, indent=None))
    its = sha256(content).hexdigest()
    return GivenRoad(sha256=its, file=f"{number:04d}.json", name=name, source=source), content


def write_roads(folder: Path, roads: Sequence[GivenRoad], contents: Sequence[bytes]) -> None:
    """Writes the files of the roads into the folder of a campaign, all or none."""
    with whole_folder(folder / FOLDER) as draft:
        for road, content in zip(roads, contents, strict=True):
            (draft / road.file).write_bytes(content)


def content_of(road: GivenRoad, folder: Path) -> bytes:
    """Returns the file of a road in the folder of a campaign; raises UsageError if it is not as it was."""
    path = folder / FOLDER / road.file
    try:
        content = read_bytes(path)
    except OSError as error:
        content, why = b"", error.strerror
    else:
        why = "its content has changed"
    if sha256(content).hexdigest() != road.sha256:
        raise UsageError(
            f"{path}, which keeps {road.name}, cannot be used: {why}; put it back as it was, or begin the "
            "campaign in another folder"
        )
    return content


def source_of(road: GivenRoad, content: bytes) -> "RoadSource":
    """Returns what the file of a road holds."""
    from roadgpt.network.source import source_in

    found = source_in(road.name, json_of(content.decode()), {}, Path(road.file))
    if isinstance(found, UsageError):
        raise found
    return found


def changes(roads: Sequence[GivenRoad], now: Mapping[str, str]) -> Iterator[str]:
    """Yields what has changed where the roads were found; ``now`` has the digests there, by name."""
    for road in roads:
        its = now.get(road.name, ABSENT)
        if its != road.source:
            yield f"{road.name} {'is gone' if its == ABSENT else 'has changed'}"
    yield from (f"{name} is new" for name in now if name not in {road.name for road in roads})
