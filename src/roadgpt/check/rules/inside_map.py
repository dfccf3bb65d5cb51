"""The whole ribbon of the road lies inside the map, off its border: 0 to the map's size along x and y.

Source: RoadGPT's two checks (the furthest points lie no further apart than the map is wide, no part meets the
border) and the SBFT competition's, whose operators bind so that a road far outside passes; here it does not.
"""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.ribbon import bulge, sides
from roadgpt.road import Road, World


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Says where the road's edge first leaves the map, and whether it is too wide for any place on it."""
    half, size = world.road_width / 2, world.map_size
    edges = np.stack(sides(road.sample(), half), axis=1)  # (n, 2 sides, 2)
    slack = bulge(road.sample(), half)
    if edges.min() > slack and edges.max() < size - slack:
        return ()
    out = np.any((edges <= slack) | (edges >= size - slack), axis=2)
    first = int(out.any(axis=1).argmax())
    x, y = (float(v) for v in edges[first, int(out[first].argmax())])
    s = float(road.sample().s[first])
    verb = "leaves the map at" if first else "starts outside the map at"
    sentence = f"at s = {s:.0f} m: the road {verb} ({x:.0f}, {y:.0f}); the map runs from 0 to {size:g} m"
    found = [Finding("inside_map", sentence, s, x, y)]
    for axis, extent in zip("xy", np.ptp(edges, axis=(0, 1)), strict=True):
        if extent >= size:
            wide = f"the road spans {extent:.0f} m along {axis}, and the map is only {size:g} m wide"
            found.append(Finding("inside_map", wide))
    return tuple(found)
