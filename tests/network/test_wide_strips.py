"""Maps of other tools have roads with strips of 20 to 40 m beside them; other roads keep their shoulders."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from network.random_maps import map_route
from roadgpt.network import Network, Route
from roadgpt.network.landscape import ground_around
from roadgpt.network.route import area_with_verges
from roadgpt.network.surface import NetworkSurface
from roadgpt.road import World

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
    assert area_with_verges(network).equals(network.paved.buffer(usual, quad_segs=8))
    member = network.roads_outside[-1]
    wide = with_wide_strips(network, member.id)
    line = shapely.LineString(member.road.centreline(1.0)[:, :2])
    far = member.profile.paved_reach + STRIP + 0.5
    more = area_with_verges(wide).difference(area_with_verges(network))
    assert line.buffer(far).covers(more)
    assert more.area > STRIP * member.road.length / 2
    for one, other in zip(NetworkSurface.of(network).areas, NetworkSurface.of(wide).areas, strict=True):
        assert one.shoulder.buffer(0.01).covers(other.shoulder)


def test_the_ground_meets_a_wide_strip_and_leaves_all_other_roads_alone() -> None:
    network = map_route(1).network
    wide = with_wide_strips(network, network.roads_outside[-1].id)
    world = World().changed(ground="hilly:1")
    before, after = (ground_around(Route.along(each, []), world) for each in (network, wide))
    road = wide.roads_outside[-1].road
    s = np.linspace(1.0, road.length - 1.0, 20)
    for t in (-30.0, 30.0):
        x, y, z = road.at(s, t).T
        assert after.height(x, y) == pytest.approx(z, abs=0.01)
        assert not np.allclose(before.height(x, y), z, atol=0.01)
    for other in network.roads_outside[:-1]:
        x, y, z = other.road.at(np.linspace(0.0, other.road.length, 20)).T
        assert before.height(x, y) == pytest.approx(z, abs=0.01)
        assert after.height(x, y) == pytest.approx(z, abs=0.01)
