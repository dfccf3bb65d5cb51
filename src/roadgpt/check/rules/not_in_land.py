"""Requires a road to have room in its land: for every bridge and tunnel that is asked for, without walls that
are higher than 15 m, without a part whose verge lies over another part, and without earth on bridges.

A wall stands where two parts of the roads have no room for slopes between them. Without land, or on flat land
that nobody asked for, nothing is checked."""

from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.amount import span
from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.network import Network
from roadgpt.road import Road, World

if TYPE_CHECKING:
    from roadgpt.ground.ground import Ground

HIGHEST = 15.0  # m, of a wall; higher ones are dams (ICOLD counts from 15 m on)
STEP = 0.3  # m between verges that lie over each other, at most
INSIDE = 0.99  # of the way from the line of a road to its rims
BESIDE = 0.1  # m beside a rim, where the ground is looked at


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports bridges and tunnels without room, the highest wall if it is too high, the highest step between
    verges, and the highest earth on bridges."""
    if route is None or not world.has_ground:
        return ()
    from roadgpt.network.landscape import crossings, ground_around

    found, built = [], [each.kind for each in crossings(route, world)]
    for kind in ("bridge", "tunnel"):
        asked = sum(round(span(each.count).lo) for each in world.scene.landscape if each.kind == kind)
        if built.count(kind) < asked:
            sentence = f"asked for {asked} {kind}{'s' * (asked > 1)}, has room for {built.count(kind)}"
            found.append(Finding("not_in_land", sentence))
    ground = ground_around(route, world)
    found += _above_another(network, ground)
    decks = [each for each in ground.pavement.spans if each.kind == "bridge"]
    for member, s in ((network.road(each.road), np.arange(each.start, each.end, 1.0)) for each in decks):
        points = np.concatenate([member.road.at(s, t * INSIDE) for t in (*member.profile.rims(s), 0.0 * s)])
        above = ground.beside(*points[:, :2].T) - points[:, 2]
        if above.max() > STEP:
            x, y = points[above.argmax(), :2].tolist()
            sentence = f"at ({x:.0f}, {y:.0f}) earth stands {above.max():.1f} m above the deck of a bridge"
            found.append(Finding("not_in_land", sentence, None, x, y))
    rims = ground.pavement.segments
    if len(rims):
        ahead = rims[:, 3:5] - rims[:, :2]
        ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
        middle = (rims[:, :3] + rims[:, 3:]) / 2
        x, y = middle[:, :2].T + BESIDE * np.stack([ahead[:, 1], -ahead[:, 0]])
        wall = np.abs(ground.beside(x, y) - middle[:, 2])
        at = int(wall.argmax())
        if wall[at] > HIGHEST:
            sentence = (
                f"at ({x[at]:.0f}, {y[at]:.0f}) a wall of {wall[at]:.0f} m stands between parts of the road "
                f"that are too close for their heights; {HIGHEST:g} m is the most"
            )
            found.append(Finding("not_in_land", sentence, None, float(x[at]), float(y[at])))
    return tuple(found)


def _above_another(network: Network, ground: "Ground") -> list[Finding]:
    """Reports where the verge of one part of the roads lies farthest above or below another part."""
    worst, place = STEP, None
    for member in network.roads_outside:
        s = np.linspace(0.0, member.road.length, max(2, round(member.road.length)))
        for each in ground.pavement.spans:
            s = s[(each.road != member.id) | (s < each.start) | (s > each.end)]
        for rim in member.profile.rims(s):
            points = member.road.at(s, rim * INSIDE)
            steps = np.nan_to_num(np.abs(ground.road(*points[:, :2].T) - points[:, 2]))
            if steps.max(initial=0.0) > worst:
                worst, place = float(steps.max()), points[steps.argmax()]
    if place is None:
        return []
    sentence = f"at ({place[0]:.0f}, {place[1]:.0f}) two parts of the road meet with a step of {worst:.1f} m"
    return [Finding("not_in_land", sentence, None, float(place[0]), float(place[1]))]
