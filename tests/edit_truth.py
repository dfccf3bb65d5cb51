"""Is a changed road what a change request asks for? Truths were written by hand from a referee's measures.

``truth`` is of T1, T2, ... (turns), S1, S2, ... (straights), start and end (the first and last thing), and
whole (the road): deg, radius, len, grade, length as [low, high]; sharper or gentler than [degrees, radius];
slope as a size. ``touched`` are numbers of old segments that may change or go; all others must be there, in
order, as they were.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from roadgpt.check.measures import RoadMeasures, measure
from roadgpt.road import Design, build, read_design

HERE = Path(__file__).parent / "edit"
Described = dict[str, Any]


def roads() -> dict[str, Design]:
    """The roads that are changed, by name."""
    rows = map(json.loads, (HERE / "edit_roads.jsonl").read_text(encoding="utf-8").splitlines())
    return {row["road"]: read_design(row["design"])[0] for row in rows}


def requests() -> list[dict[str, Any]]:
    """Requests with their plans and truths; the plan of one that cannot be read is '!'."""
    return [*map(json.loads, (HERE / "edits.jsonl").read_text(encoding="utf-8").splitlines())]


def ours(points: Any) -> Described:
    """A road as check.measures sees it."""
    found: RoadMeasures = measure(points)
    features = [
        {
            "kind": f.kind,
            "dir": f.side,
            "deg": f.degrees,
            "radius": f.radius,
            "len": f.length,
            "grade": f.grade,
            "pieces": [{"grade": piece.grade} for piece in f.pieces],
        }
        for f in found.features
    ]
    return {
        "features": features,
        "length": found.length,
        "grade": found.grade,
        "low": found.lowest_grade,
        "high": found.highest_grade,
    }


def theirs(referee: Any, points: Any) -> Described:
    """A road as the referee sees it."""
    found = referee.measure(points)
    features = [{**f, "grade": f["slope"], "pieces": [{"grade": p["slope"]} for p in f.get("pieces", [])]}
                for f in found["features"]]  # fmt: skip
    low, high = found["g20"]
    return {"features": features, "length": found["length"], "grade": found["mean"], "low": low, "high": high}


def misses(row: Mapping[str, Any], old: Design, new: Design, see: Callable[[Any], Described]) -> list[str]:
    """What a changed road does not keep of the truth; empty where the request was honoured."""
    seen = see(build(new).centreline())
    turns = [f for f in seen["features"] if f["kind"] == "turn"]
    sides = "".join(turn["dir"][0].upper() for turn in turns)
    out = [] if _alike(sides, row["sides"]) else [f"turns are {sides} and not {row['sides']}"]
    for name, wanted in row["truth"].items():
        out += [f"{name}: {said}" for said in _broken(_thing(name, seen), wanted)]
    return out


def _alike(sides: str, wanted: str) -> bool:
    return len(sides) == len(wanted) and all(w in ("?", s) for s, w in zip(sides, wanted, strict=True))


def _thing(name: str, seen: Described) -> Described | None:
    if name == "whole":
        return seen
    features = seen["features"]
    if name in ("start", "end"):
        return features[0 if name == "start" else -1] if features else None
    kind = {"T": "turn", "S": "straight"}[name[0]]
    own = [f for f in features if f["kind"] == kind]
    return own[int(name[1:]) - 1] if len(own) >= int(name[1:]) else None


def _broken(thing: Described | None, wanted: Mapping[str, Any]) -> Iterator[str]:
    if thing is None:
        yield "is not there"
        return
    for key, value in wanted.items():
        if key in ("sharper", "gentler"):
            sign = 1 if key == "sharper" else -1
            degrees, radius = sign * (thing["deg"] - value[0]), sign * (value[1] - thing["radius"])
            if degrees < -1 or radius < -0.03 * value[1] or (degrees < 4 and radius < 0.07 * value[1]):
                yield f"{thing['deg']:.0f} degrees, {thing['radius']:.0f} m is not {key} than {value}"
        elif key == "grade" and isinstance(value, str):
            if not _goes(thing, value):
                yield f"grade {thing['grade']:.1f} is not {value}"
        else:
            got = abs(thing["grade"]) if key == "slope" else thing[key]
            if not value[0] <= got <= value[1]:
                yield f"{key} {got:.1f} is not in {value}"


def _goes(thing: Described, way: str) -> bool:
    """Up, down or flat: of the whole road everywhere, of a straight as a whole."""
    if "low" in thing:
        low, high, grade = thing["low"], thing["high"], thing["grade"]
        if way == "flat":
            return low >= -1 and high <= 1
        return (grade >= 1 and low >= -1) if way == "up" else (grade <= -1 and high <= 1)
    grade = thing["grade"]
    return {"up": grade >= 1, "down": grade <= -1, "flat": abs(grade) < 1}[way]


def changed_besides(old: Design, new: Design, touched: Sequence[int]) -> list[int]:
    """Numbers of old segments that nobody spoke of and that are not there any more as they were."""
    rest = iter(new.segments)
    gone = []
    for number, segment in enumerate(old.segments, 1):
        if number in touched:
            continue
        kept = list(rest)
        if segment in kept:
            rest = iter(kept[kept.index(segment) + 1 :])
        else:
            gone.append(number)
            rest = iter(kept)
    return gone
