"""The driver ``reference`` in traffic: nobody is touched by its fault where nobody has to give way."""

import pytest

from roadgpt.road import Limits, World
from roadgpt.run import Setup, perform

PLANS = [
    "straight 300 | lanes=1 against=1",
    "turn left 90 r60; straight 200; turn right 90 r50; straight 150",
    "straight 150 // crossroads right lights // straight 120",
    "| lanes=2 against=2 len=150 // crossroads straight lights // | lanes=2 against=2 len=150",
    "straight 120 // crossroads straight priority // straight 120 // t_junction right priority // |",
]


@pytest.mark.parametrize("plan", PLANS)
def test_nobody_is_touched_by_the_fault_of_reference(plan: str) -> None:
    setup = Setup(reader="plan", driver="reference")
    run = perform(f"{plan} && medium", 7, World(limits=Limits(speed_limit=50 / 3.6)), setup)
    assert run.drive is not None
    assert run.verdict is not None
    assert run.drive.others is not None
    assert len(run.drive.others.actors) > 2
    contacts = [each.contact for each in run.verdict.incidents or () if each.contact is not None]
    assert not any(contact.nuplan_at_fault for contact in contacts)
    assert run.drive.ended == "goal"
