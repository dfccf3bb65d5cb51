"""Takes one road of an OpenDRIVE file by itself, and selects the lane that is driven."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from math import inf
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry.elevation import closed
from roadgpt.network import ImportedRoad, Leg, Network, NetworkRoad, Route
from roadgpt.network.maps import world_values
from roadgpt.network.road_or_route import ONLY
from roadgpt.network.stretch import turned
from roadgpt.road import Profile, Road
from roadgpt.road.profile import Marking, as_cubics
from roadgpt.road.world import LANE_WIDTHS
from roadgpt_formats.opendrive.junctions import tell_unread
from roadgpt_formats.opendrive.roads import FileRoad, RoadBuilder, file_road, left_out, limited, unread
from roadgpt_formats.opendrive.tree import DRIVING, NUMBER, MapRemarks, read_tree

PLACES = 1_000  # stations at which widths are sampled


def read_road(path: Path, road: str | None) -> ImportedRoad:
    """Returns one road of a file; see ``roadgpt.network.read_opendrive``."""
    found: list[tuple[tuple[bool, bool, float], Element, Counter[str]]] = []

    def wants(tag: str, attributes: Mapping[str, str]) -> bool:
        return tag == "road" and road in (None, attributes.get("id"))

    def take(node: Element, passed: Counter[str]) -> None:
        is_driven = any(lane.get("type") in DRIVING for lane in node.findall("lanes/laneSection/*/lane"))
        length = node.get("length", "0")
        length_ = float(length) if NUMBER.fullmatch(length) else 0.0
        rank = (is_driven, node.get("junction", "-1") == "-1", length_)
        if not found or rank > found[0][0]:
            found[:] = [(rank, node, passed)]

    try:
        ids, header = read_tree(path, take, wants)
        if not found:
            told = ", ".join(ids[:12]) + (", ..." if len(ids) > 12 else "")
            raise UsageError(f"there is no road {road} in it; there are: {told}")
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    ((_, node, passed),) = found
    remarks, id_ = MapRemarks(of_one_road=True), node.get("id", "?")[:40]
    try:
        if road is None and len(ids) > 1:
            which = f"the longest of {len(ids)} with a driving lane"
            remarks.add(f"road {id_} is taken, {which}; use --road ID for another", "")
        file = file_road(node, remarks)
        if file is None:
            kinds = {lane.get("type", "?") for lane in node.findall("lanes/laneSection/*/lane")} - {"none"}
            told = ", ".join(sorted(kinds)[:6]) or "none"
            raise UsageError(f"it has no lane of type driving (its lanes are: {told}); take another road")
        made, values = _alone(file, remarks)
    except UsageError as error:
        raise UsageError(f"{path}: road {id_}: {error}") from error
    tell_unread(node, remarks, "", None)
    others = unread(node) | ({f"junction {file.junction[:40]}"} if file.junction else set())
    profile = made.profile
    assert profile is not None
    s = np.linspace(0.0, made.length, PLACES)
    width, shoulder = (round(float(np.median(each)), 4) for each in (profile.width(s), profile.shoulder(s)))
    is_usual = not file.left_hand and profile == Profile.of(1, 1, width, shoulder)
    if file.left_hand:  # which only a network can hold
        network = Network((NetworkRoad(ONLY, made.mirrored),))
        made = Route.along(network, (Leg(ONLY, -profile.driven_id),)).on_ground()
    return ImportedRoad(
        made.with_profile(None) if is_usual else made,
        id_,
        node.get("name", "")[:80],
        width,
        shoulder,
        values.get("speed_limit"),
        values.get("friction"),
        (*remarks.sentences(), *left_out(passed, others, header)),
    )


def _alone(file: FileRoad, remarks: MapRemarks) -> tuple[Road, dict[str, float]]:
    """Returns a road that leads in the direction in which most of its lanes are driven on the right, and what
    it states about its speed limit and friction; where traffic drives on the left, that of the mirror image.
    Raises UsageError if no road file can hold it."""
    road, _ = RoadBuilder(file, remarks).build(file.whole)
    hand, own_side, other = (1, "left", "right") if file.left_hand else (-1, "right", "left")
    road = road.mirrored if file.left_hand else road
    profile = road.profile
    assert profile is not None
    along, against = (
        sum(each.end - each.start for each in file.whole.sections if any(n * side > 0 for n in each.driving))
        for side in (hand, -hand)
    )
    if not profile.along_ids or (profile.against_ids and against > 2 * along):
        what = f"no lane to the {own_side} of its line is driven"
        remarks.add(f"{what}; the road follows the direction of its {other} lanes", "")
        road = turned(road)
        assert road.profile is not None
        profile = road.profile
    if not profile.along_ids:
        raise UsageError("none of its lanes is wide enough for a car; take another road")
    if not any(True for _ in file.node.iter("roadMark")):
        remarks.add("it has no road marks in its file; the usual ones are painted here", "")
        profile = _painted(profile)
    profile = _driven(profile, road.length, remarks)
    own = profile.right[profile.driven]
    values, told = world_values([(road.length, own)])
    for each in told:
        remarks.add(each, "")
    # what holds for the driven lane is said by the World
    left, right = list(profile.left), list(profile.right)
    for side in (left, right):
        for n, lane in enumerate(side):
            limit = None if lane.speed_limit == own.speed_limit else lane.speed_limit
            friction = None if lane.friction == own.friction else lane.friction
            side[n] = replace(lane, speed_limit=limit, friction=friction)
    made = road.with_profile(replace(profile, left=tuple(left), right=tuple(right)))
    return Road.from_json(made.to_json()), values  # so that no road is written that cannot be read


def _painted(profile: Profile) -> Profile:
    """Returns a cross-section with the usual markings of its driving lanes."""
    ends = {ids[-1] for ids in (profile.along_ids, profile.against_ids) if ids}
    centre: Marking = "broken" if profile.count == (1, 1) else "solid"

    left, right = list(profile.left), list(profile.right)
    for side, lanes in ((1, left), (-1, right)):
        for n, lane in enumerate(lanes, 1):
            if lane.kind == "driving":
                lanes[n - 1] = replace(lane, marking="solid" if side * n in ends else "broken")
    return replace(profile, left=tuple(left), right=tuple(right), centre_marking=centre)


def _driven(profile: Profile, length: float, remarks: MapRemarks) -> Profile:
    """Returns the cross-section with the lane that the car keeps to, which is wide enough everywhere."""
    widths = {n: as_cubics(profile.right[n - 1].width) for n in (-each for each in profile.along_ids)}
    wide = [n for n, width in widths.items() if not width.beyond(LANE_WIDTHS[0], inf)]
    driven = wide[-1] if wide else min(widths)
    if driven != min(widths):
        which = f"the outermost that is {LANE_WIDTHS[0]:g} m wide everywhere"
        place = [*widths].index(driven) + 1
        remarks.add(f"the car keeps to lane {place} from the centre line, {which}", "")
    right = list(profile.right)
    if found := widths[driven].beyond(*LANE_WIDTHS):
        low, high = LANE_WIDTHS
        where = f"{found[1]:.4g} m at s = {found[0]:.4g} m, outside {low:g} to {high:g} m"
        remarks.add("the width of the driven lane is limited", "", where)
        width = closed(limited(widths[driven].rows, length, low, high), length)
        right[driven - 1] = replace(right[driven - 1], width=width)
    return replace(profile, right=tuple(right), driven=driven - 1)
