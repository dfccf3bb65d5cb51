"""Builds 60 descriptions of roads in landscapes and measures land and road: the reader beside keywords. Three
writers who had not seen RoadGPT wrote the truths first. Then it makes 40 changes of landscapes that a fourth
asks for, and measures before and after.

    python benchmarks/bench_land_words.py [COUNT] [-v]"""

import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from roadgpt import Brief, build, draft, read
from roadgpt.brief.land_words import land_in
from roadgpt.brief.scene import Scene
from roadgpt.design.room import world_for
from roadgpt.errors import RoadGPTError
from roadgpt.ground.ground import Ground
from roadgpt.network.landscape import crossings, ground_around
from roadgpt.road import Road, World
from roadgpt_edit.editing import edit

COUNT = int(next(filter(str.isdigit, sys.argv[1:]), 60))
SPREADS = {"flat": (0, 10), "rolling": (4, 28), "hilly": (10, 80), "mountain": (30, 999)}
"""m between the tenths of heights within 80 m of the road, by kind of land."""


def waters(ground: Ground) -> set[str]:
    """The kinds of water in land: rivers are long and narrow, coasts take a tenth of the border."""
    x, y = np.meshgrid(ground.x, ground.y)
    wet = ~np.isnan(ground.water(x.ravel(), y.ravel())).reshape(x.shape)
    parts, count = ndimage.label(wet)
    border, found = np.concatenate([parts[0], parts[-1], parts[:, 0], parts[:, -1]]), set()
    for part in range(1, count + 1):
        area = (parts == part).sum() * ground.cell**2
        wide = 2 * ground.cell * ndimage.distance_transform_edt(np.pad(parts == part, 1, "edge")).max()
        if area > 600:
            is_river = wide < 60 and area > 4 * wide**2
            found.add("river" if is_river else "coast" if (border > 0).mean() > 0.12 else "lake")
    return found


def right(road: Road, world: World, truth: dict[str, Any]) -> dict[str, bool]:
    """What of a truth about land, length and climb holds."""
    ground, long = ground_around(road, world), road.length
    s = np.linspace(0.0, long, max(50, int(long / 2)))
    points, heading = road.at(s), road.heading(s)
    left = np.column_stack([-np.sin(heading), np.cos(heading)])

    def off(aside: float, is_land: bool = False) -> np.ndarray:
        x, y = (points[:, :2] + aside * left).T
        return (ground.relief.at(x, y) if is_land else ground.height(x, y)) - points[:, 2]

    def wet(side: int) -> float:
        rows = [ground.water(*(points[:, :2] + side * aside * left).T) for aside in range(10, 125, 6)]
        return float((~np.isnan(rows)).any(axis=0).mean())

    one, other = (float(np.median([off(side * aside) for aside in (50, 70, 90)])) for side in (1, -1))
    under, climb = off(0.0, is_land=True), points[-1, 2] - points[0, 2]
    level = ground.water_level(points[:, 0], points[:, 1])
    built = crossings(road, world)
    outside = np.ones(len(s), bool)
    for each in built:
        outside &= (s < each.start - 15) | (s > each.end + 15)
    beside = np.stack([off(side * 25.0, is_land=True) for side in (1, -1)])[:, outside]
    crest = [np.max([off(side * aside) for aside in range(40, 140, 10)], axis=0) > 14 for side in (1, -1)]
    around = np.quantile([off(aside) for aside in (-80, -60, -40, 40, 60, 80)], [0.1, 0.9])
    wets, there = (wet(1), wet(-1)), waters(ground)
    lies = {
        "beside": max(wets) > 0.15, "left": wets[0] > max(0.15, wets[1]),
        "right": wets[1] > max(0.15, wets[0]),
        "crossed": bool((level > under + points[:, 2]).mean() > 0.01),
    }  # fmt: skip
    held = {
        "valley": min(one, other) > 6, "on_ridge": max(one, other) < -6,
        "ridge_beside": max(each.mean() for each in crest) > 0.4,
        "crosses_valley": under.min() < -4, "crosses_ridge": under.max() > 4,
        "cutting": bool((beside.min(axis=0) > 2.5).any()),
        "embankment": bool((beside.max(axis=0) < -2.5).any()),
        "forest": any(each.kind == "forest" for each in world.scene.landscape),
    }  # fmt: skip
    for key, value in truth.items():
        if key in ("lake", "river", "coast"):
            is_there = key in there or (key == "lake" and "coast" in there)  # a lake may reach the border
            held[key] = is_there and lies[value]
        elif key in ("bridges", "tunnels"):
            held[key] = sum(each.kind == key[:-1] for each in built) == value
        elif key == "land":
            low, high = SPREADS[value]
            held[key] = low < around[1] - around[0] < high or world.scene.land == value
        elif key == "length_m":
            held[key] = abs(long - value) <= 0.12 * value
        elif key == "climb":
            grade = climb / long
            held[key] = {"up": grade > 0.008, "down": grade < -0.008, "level": abs(grade) < 0.012}[value]
    return {key: bool(held[key]) for key in truth if key in held}


def by_keywords(brief: Brief, text: str) -> World:
    """The World whose landscape is what single words of a text name."""
    wish = land_in(text)
    return world_for(brief, World().changed(scene=Scene(landscape=wish.lands), ground=wish.kind or ""))


def looks(road: Road, world: World) -> dict[str, Any]:
    """What can be measured of the landscape of a road."""
    ground, built = ground_around(road, world), crossings(road, world)
    s = np.linspace(0.15, 0.85, 60) * road.length
    points, heading = road.at(s), road.heading(s)
    left = np.column_stack([-np.sin(heading), np.cos(heading)])
    asides = np.arange(10.0, 200.0, 2.0)
    found: dict[str, Any] = {"away": {}, "there": set()}
    beside: dict[tuple[str, str], float] = {}
    kinds = waters(ground) | ({"lake"} if "coast" in waters(ground) else set())
    for side, sign in (("left", 1.0), ("right", -1.0)):
        rows = [points[:, :2] + sign * aside * left for aside in asides]
        wet = np.array([~np.isnan(ground.water(*row.T)) for row in rows])
        high = np.array([ground.relief.at(*row.T) for row in rows]) - points[:, 2]
        if wet.any(axis=0).mean() > 0.15:
            first = asides[wet.argmax(axis=0)][wet.any(axis=0)]
            beside |= {(kind, side): float(np.median(first)) for kind in kinds}
        if (high.max(axis=0) > 25.0).mean() > 0.4:
            beside["ridge", side] = float(np.median(asides[high.argmax(axis=0)]))
    for (kind, _), far in beside.items():
        found["away"][kind] = min(far, found["away"].get(kind, far))
    forests = [each.side for each in world.scene.landscape if each.kind == "forest"]
    found["there"] = {*beside, *(("forest", side) for side in ("left", "right") if {side, None} & {*forests})}
    for kind in ("bridge", "tunnel"):
        own = [each for each in built if each.kind == kind]
        found[f"{kind}_m"], found[f"{kind}s"] = sum(each.end - each.start for each in own), len(own)
    rows = [points[:, :2] + aside * left for aside in (-80, -40, 40, 80)]
    lands = [ground.relief.at(*row.T) - points[:, 2] for row in rows]
    found["land"] = float(np.subtract(*np.quantile(lands, [0.9, 0.1])))
    found["kind"] = (world.site.made_ground or (world.scene.hills,))[0]
    return found


def changed_rightly(before: dict[str, Any], after: dict[str, Any], truth: dict[str, Any]) -> bool:
    """Whether the landscape of a road changed as a truth says."""
    held = []
    for key, value in truth.items():
        if key == "gone":
            held.append(value not in {kind for kind, _ in after["there"]})
        elif key == "there":
            held.append(tuple(value) in after["there"])
        elif key == "away":
            one, other = (each["away"].get(value[0], np.nan) for each in (before, after))
            ways = {"more": other > one + 3, "less": other < one - 3}
            held.append(bool(ways[value[1]] if value[1] in ways else abs(other - value[1]) < 15))
        elif key == "land" and value not in ("higher", "lower"):
            held.append(after["kind"] == value)
        else:
            ways = {"more": 1, "higher": 1, "less": -1, "lower": -1}
            difference = after[key] - before[key]
            held.append(
                difference * ways[value] > 0
                if value in ways
                else after[key] == (0 if value == "none" else value)
            )
    return all(held)


def requests() -> None:
    rows = (Path(__file__).parent / "land_requests.jsonl").read_text(encoding="utf-8").splitlines()[:COUNT]
    right, refused = 0, 0
    for row in map(json.loads, rows):
        brief = read(row["road"], reader="plan", is_map_fixed=False)
        world = world_for(brief, World())
        design = draft(brief, world, seed=3)
        try:
            made = edit(design, row["request"], world)
        except RoadGPTError as error:
            refused += 1
            if "-v" in sys.argv:
                print(f"  {row['request']}\n    {error}")
            continue
        one, other = (
            looks(place.lay(build(each)), place)
            for each, place in ((design, world), (made.design, made.world))
        )
        is_right = changed_rightly(one, other, row["truth"])
        right += is_right
        if "-v" in sys.argv and not is_right:
            print(f"  {row['road']}: {row['request']}\n    {row['truth']}: {'; '.join(made.changes)}")
    print(f"requests: {right} of {len(rows)} right, {refused} refused")


def main() -> None:
    requests()
    path = Path(__file__).parent / "land_descriptions.jsonl"
    rows = path.read_text(encoding="utf-8").splitlines()[:COUNT]
    for name in ("reader", "keywords"):
        whole, kept, asked, silent = 0, Counter[str](), Counter[str](), 0
        for row in map(json.loads, rows):
            try:
                brief = read(row["text"], is_map_fixed=False)
                world = by_keywords(brief, row["text"]) if name == "keywords" else world_for(brief, World())
                world = world.in_scene_of(brief).with_lanes_of(brief)
                found = right(world.lay(build(draft(brief, world, seed=3))), world, row["truth"])
            except RoadGPTError as error:
                found, silent = dict.fromkeys(row["truth"], False), silent + 1
                if "-v" in sys.argv:
                    print(f"  {row['text']}\n    {error}")
            found = {key: value for key, value in found.items() if key not in ("turns", "hairpins")}
            whole += all(found.values())
            asked.update(found.keys())
            kept.update(key for key, is_right in found.items() if is_right)
            if "-v" in sys.argv and not all(found.values()):
                print(f"  {row['text']}\n    {[key for key, is_right in found.items() if not is_right]}")
        said = f"{kept.total()} of {asked.total()} said things"
        print(f"{name}: {whole} of {len(rows)} right, {silent} refused; {said}")
        print("  " + ", ".join(f"{key} {kept[key]}/{asked[key]}" for key in sorted(asked)))


if __name__ == "__main__":
    main()
