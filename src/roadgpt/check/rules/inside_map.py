"""Requires the whole surface of the road to lie inside the map, without touching its border.

The map extends from 0 to ``map_size`` along x and y. Source: two checks of the RoadGPT thesis (the road fits
into the map, and no part of it touches the border) and one of the SBFT competition. The competition's code
accepts some roads far outside the map, because of an operator precedence error; this rule rejects them. Near
the border, the competition's spline is checked as well, in both driving directions, because this spline may
run up to a metre beyond the end of the road."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.ribbon import bulge, extent, sides
from roadgpt.check.sbft import SPLINE_REACH, splines
from roadgpt.check.sbft import edges as sbft_edges
from roadgpt.road import Road, World


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports where the road leaves the map, and whether the road is larger than the map."""
    samples, size = road.sample(), world.site.map_size
    offsets = world.profile_of(road).edges(samples.s)
    low, high = extent(samples, offsets)
    room = min(low.min(), size - high.max())
    if room > 0:
        return () if room > SPLINE_REACH else _on_sbft_s_spline(road, world)
    edges, slack = np.stack(sides(samples, offsets), axis=1), bulge(samples, offsets)  # (n, 2 sides, 2)
    out = np.any((edges <= slack) | (edges >= size - slack), axis=2)
    first = int(out.any(axis=1).argmax())
    x, y = (float(v) for v in edges[first, int(out[first].argmax())])
    s = float(samples.s[first])
    verb = "leaves the map at" if first else "starts outside the map at"
    place = f"({round(x)}, {round(y)})"
    sentence = f"at s = {s:.0f} m: the road {verb} {place}; the map runs from 0 to {size:g} m"
    found = [Finding("inside_map", sentence, s, x, y)]
    for axis, spanned in zip("xy", np.ptp(edges, axis=(0, 1)), strict=True):
        if spanned >= size:
            wide = f"the road spans {spanned:.0f} m along {axis}, and the map is only {size:g} m wide"
            found.append(Finding("inside_map", wide))
    return tuple(found)


def _on_sbft_s_spline(road: Road, world: World) -> tuple[Finding, ...]:
    ways = splines(road.control_points())
    nodes = np.concatenate(ways)
    edges = np.concatenate([np.stack(sbft_edges(way, world.section.road_width), axis=1) for way in ways])
    if edges.min() > 0 and edges.max() < world.site.map_size:
        return ()
    node = int(np.any((edges <= 0) | (edges >= world.site.map_size), axis=(1, 2)).argmax())
    x, y = (float(v) for v in nodes[node])
    sentence = (
        f"near ({x:.0f}, {y:.0f}): with SBFT's spline the road leaves the map; keep away from its border"
    )
    return (Finding("inside_map", sentence, float(road.locate(x, y)[0]), x, y),)
