"""Makes the list of information that is needed to reproduce a report: command, seed, versions, and
hashes of the weights of the neural network that reads descriptions."""

from collections.abc import Mapping, Sequence
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from roadgpt.road import World
from roadgpt.run import Setup
from roadgpt.study.road_record import StudyPartRecord

DIGITS = 16  # of a hash
UNITS = {
    "speed_limit": (3.6, " km/h"),
    "max_grade": (100.0, " %"),
    "bank": (100.0, " %"),
    "friction": (1.0, ""),
    "oob_tolerance": (1.0, ""),
}
"""Factor and unit with which a field of the World is shown; fields that are not listed are in metres."""
WEIGHTS = (".onnx", ".npz", ".safetensors", ".bin")


def card_of(
    command: str, roads: int, seed: int, setup: Setup, world: World, parts: Sequence[StudyPartRecord]
) -> dict[str, str]:
    """Returns the information needed to reproduce a report, as labels with their texts in the order shown
    on the page."""
    out = {"command": command} if command else {}
    out |= {
        "seed": str(seed),
        "roads of each": f"{roads:,}",
        "made by": ", ".join(dict.fromkeys(part.designer for part in parts)),
    }
    out["reader"] = setup.reader + _hashes(setup.reader)
    if setup.drives:
        out["driven by"] = f"{setup.driver} in {setup.simulator}"
    if setup.chat is not None and setup.chat.model:
        out["language model"] = setup.chat.model
    out["world"] = ", ".join(_said(name, value) for name, value in world.model_dump().items())
    surfaces = {f"{road.friction:g}" for part in parts for road in part.roads if road.friction is not None}
    if surfaces - {f"{world.site.friction:g}"}:
        out["friction of the roads"] = f"{' and '.join(sorted(surfaces))}, by what the words say"
    return out | {"versions": _versions(parts)}


def _said(name: str, value: float | str) -> str:
    """Returns a field of a World as a sentence shows it, in the unit in which users give it."""
    factor, unit = UNITS.get(name, (1.0, " m"))
    shown = value if isinstance(value, str) else f"{value * factor:.4g}{unit}"
    if isinstance(value, bool):
        shown = "counted" if value else "not counted"
    return f"{name.replace('_', ' ')} {shown}"


def _versions(parts: Sequence[StudyPartRecord]) -> str:
    """Returns the versions of all libraries; several of one if it changed before a study was resumed."""
    found: dict[str, dict[str, None]] = {}
    for part in parts:
        for road in part.roads:
            for name, number in road.versions.items():
                found.setdefault(name, {})[number] = None
    return ", ".join(f"{name} {' and '.join(numbers)}" for name, numbers in found.items()) or "–"


def _hashes(reader: str) -> str:
    """Returns the hashes of the reader's weights, which show whether two studies used the same reader."""
    name, _, folder = reader.partition(":")
    if name != "model":
        return ""
    spec = find_spec("roadgpt.brief.readers.model")
    home = Path(spec.origin).parent / "weights" if spec and spec.origin else None
    place = Path(folder) if folder else home
    if place is None or not place.is_dir():
        return ""
    files: Mapping[str, bytes] = {
        path.name: path.read_bytes() for path in sorted(place.iterdir()) if path.suffix in WEIGHTS
    }
    told = (f"{name} sha256 {sha256(data).hexdigest()[:DIGITS]}" for name, data in files.items())
    return f" ({', '.join(told)})" if files else ""
