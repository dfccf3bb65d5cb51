"""Maps of other tools have roads with strips of 20 to 40 m beside them; other roads keep their shoulders."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from network.random_maps import map_route
from roadgpt.network import Network, Route
from roadgpt.network.route import ground_of
from roadgpt.network.surface import NetworkSurface
from roadgpt.road import World
from roadgpt.scene.scene import landscape

STRIP = 40.0  # m


def with_wide_strips(network: Network, number: int) -> Network:
    """The network, with another width of the outermost strips of one road."""
    member = network.road(number)
    left, right = ((*side[:-1], replace(side[-1], width=STRIP)) for side in
                   (member.profile.left, member.profile.right))  # fmt: skip
    road = member.road.with_profile(replace(member.profile, left=left, right=right))
    changed = (replace(each, road=road) if each.id == number else each for each in network.roads)
    return replace(network, roads=tuple(changed))


@pytest.mark.parametrize("seed", range(3))
def test_one_wide_strip_changes_the_ground_of_its_own_road_only(seed: int) -> None:
    network = map_route(seed).network
    usual = network.roads_outside[0].shoulder
    assert ground_of(network).equals(network.paved.buffer(usual, quad_segs=8))
    member = network.roads_outside[-1]
    wide = with_wide_strips(network, member.id)
    line = shapely.LineString(member.road.centreline(1.0)[:, :2])
    far = member.profile.paved_reach + STRIP + 0.5
    more = ground_of(wide).difference(ground_of(network))
    assert line.buffer(far).covers(more)
    assert more.area > STRIP * member.road.length / 2
    for one, other in zip(NetworkSurface.of(network).areas, NetworkSurface.of(wide).areas, strict=True):
        assert one.shoulder.buffer(0.01).covers(other.shoulder)


def test_the_land_keeps_below_a_wide_strip_and_near_all_other_roads() -> None:
    network = map_route(1).network
    wide = with_wide_strips(network, network.roads_outside[-1].id)
    before, after = (landscape(Route.along(each, []), World())[0] for each in (network, wide))
    road = wide.roads_outside[-1].road
    s = np.linspace(0, road.length, 20)
    for t in (-30.0, 30.0):
        x, y, z = road.at(s, t).T
        assert (after.height(x, y) < z).all()
    centre = shapely.LineString(road.centreline(1.0)[:, :2])
    x, y = np.meshgrid(before.x[6:-6], before.y[6:-6])
    is_far = shapely.distance(shapely.points(x, y), centre) > STRIP + 20
    assert is_far.any()
    follows = [land.away[6:-6, 6:-6][is_far] == 0 for land in (before, after)]
    assert follows[0].any()
    assert (follows[0] == follows[1]).all()
