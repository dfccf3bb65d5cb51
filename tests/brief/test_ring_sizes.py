"""The size of a roundabout whose outer diameter is given in metres."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.ring_sizes import least_diameter, with_diameters
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.design import draft
from roadgpt.network import build_route
from roadgpt.road import World
from roadgpt_training.tokens import tokens_of
from tables import rows


@pytest.mark.parametrize(("text", "written", "wanted"), rows(__file__, "diameter_decides_size"))
def test_a_diameter_decides_the_size(text: str, written: str, wanted: str) -> None:
    assert plan(with_diameters(read_plan(written), written.split(), slotted(text))) == wanted


@pytest.mark.parametrize(("text", "plan", "wanted"), rows(__file__, "diameter_required_there"))
def test_a_diameter_is_required_where_there_is_room(text: str, plan: str, wanted: list[float | None]) -> None:
    said = slotted(text)
    brief = with_diameters(read_plan(plan), tokens_of(plan, said.slots) or (), said)
    assert [each.outer and each.outer.lo for each in brief.junctions] == wanted


@pytest.mark.parametrize(
    "rest", ["", " arms=3", " arms=4", " arms=5", " arms=6", " lanes=2", " arms=6 lanes=2"]
)
def test_from_the_least_diameter_on_every_draft_has_it(rest: str) -> None:
    brief = read_plan(f"roundabout{rest}")
    least = least_diameter(brief.junctions[0], brief.stretches)
    for across in (least, 66.0):
        asked = read_plan(f"roundabout{rest} outer={across:g}")
        route = build_route(draft(asked, World(), seed=1), World())
        (ring,) = route.network.roundabouts
        assert 2 * (ring.radius + ring.width) == pytest.approx(across, abs=0.5)
