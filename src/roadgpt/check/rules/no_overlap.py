"""The ribbon of the road nowhere lies over itself, whatever the heights: SBFT's rule against crossing.

The ribbon is cut into quads about 1 m long. A quad that is not convex has folded: the bend is tighter than
half the road is wide. Other quads must stand apart; where a stretch comes back to an earlier one, far enough
along to have turned round, by twice the little that true edges bulge beyond the quads' straight ones.
"""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.ribbon import bulge, gaps, is_convex, near_pairs, quads_of, sides
from roadgpt.road import Road, World


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Says where the road first runs into itself, and over which of its places."""
    samples, half = road.sample(), world.road_width / 2
    quads = quads_of(*sides(samples, half))
    folded = np.flatnonzero(~is_convex(quads))
    if folded.size:
        return (_finding(road, int(folded[0]), "the road folds onto itself; widen the bend"),)
    slack = 2 * bulge(samples, half)
    i, j = near_pairs(quads, reach=slack)
    step = samples.s[1] - samples.s[0]
    turned_round = (j - i) * step > np.pi * half
    lies_over = gaps(quads, i, j) <= np.where(turned_round, slack, 0.0)
    if not lies_over.any():
        return ()
    again = int(j[lies_over].min())
    earlier = float(samples.s[int(i[lies_over & (j == again)].min())])
    return (_finding(road, again, f"the road lies over its own stretch at s = {earlier:.0f} m"),)


def _finding(road: Road, index: int, what: str) -> Finding:
    samples = road.sample()
    s, x, y = (float(v[index]) for v in (samples.s, samples.x, samples.y))
    return Finding("no_overlap", f"at s = {s:.0f} m, near ({x:.0f}, {y:.0f}): {what}", s, x, y)
