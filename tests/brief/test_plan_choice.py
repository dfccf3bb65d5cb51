"""Which of several plans is chosen: the likeliest, or a nearly as likely one that fits the words better."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.plan_choice import brief_of, most_plausible
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan

ROUTE = "| motorway lanes=3 // diverge main // diverge ramp"


def plans(*scored: tuple[str, float]) -> list[ScoredPlan]:
    """Plans with their scores; a number in brackets, such as [1], is that of a slot."""
    out = []
    for line, score in scored:
        tokens = tuple(line.replace("=", "= ").split())
        shown = line.replace("[1]", "1000").replace("[2]", "120")
        out.append(ScoredPlan(tokens, shown, score, (), agreement=1.0))
    return out


@pytest.mark.parametrize(
    ("behind", "chosen"), [(1.7, f"{ROUTE} len=120 || len=1000"), (2.3, f"{ROUTE} len=120")]
)
def test_a_plan_with_every_number_is_preferred_if_it_is_almost_as_likely(behind: float, chosen: str) -> None:
    text = slotted("Route of 1 km on a motorway: past an exit, leave at the next, deceleration lane 120 m")
    found = plans((f"{ROUTE} len=[2]", -0.1), (f"{ROUTE} len=[2] || len=[1]", -0.1 - behind))
    assert most_plausible(found, text).line == chosen


def test_a_contradiction_with_every_number_stays_one() -> None:
    text = slotted("a road that falls all the way and ends 1 km higher")
    found = plans(("turn | down climb=[1]", -0.1), ("turn | down climb=..[1]", -1.4))
    assert most_plausible(found, text).line == "turn | down climb=1000"


def test_a_plan_with_the_told_number_of_turns_is_preferred() -> None:
    found = plans(("turn x7 alternating", -0.1), ("turn x5", -0.5), ("turn x6 alternating", -1.0))
    assert most_plausible(found, slotted("six turns that alternate")).line == "turn x6 alternating"
    assert most_plausible(found, slotted("six turns or seven turns")).line == "turn x7 alternating"


@pytest.mark.parametrize(
    ("words", "behind", "chosen"),
    [
        ("a winding road with at least five bends", 2.7, "| turns=5.."),
        ("strada tortuosa, almeno cinque curve", 2.7, "| turns=5.."),
        ("eine kurvige Straße, höchstens fünf Kurven", 2.7, "winding"),
        ("a winding road with at least five bends", 4.7, "winding"),
        ("a winding road, 5 % uphill", 2.7, "winding"),
        ("a winding road with five bends, then six turns", 2.7, "winding"),
    ],
)
def test_turns_that_are_counted_once_are_not_left_out(words: str, behind: float, chosen: str) -> None:
    bound = "| turns=..6" if "höchstens" in words else "| turns=5.."
    assert most_plausible(plans(("winding", -0.1), (bound, -behind)), slotted(words)).line == chosen


def test_refusals_stay() -> None:
    found = plans(("!contradiction length", -0.1), ("turn | len=[1]", -0.2))
    assert most_plausible(found, slotted("a bend on a road of 1 km")).line == "!contradiction length"


@pytest.mark.parametrize(
    ("words", "read", "meant"),
    [
        (
            "pass two side streets on the left, then turn into the third one on the left",
            " // ".join(["junction straight ways=left+straight"] * 3 + ["junction left"]),
            " // ".join(["junction straight ways=left+straight"] * 2 + ["junction left ways=left+straight"]),
        ),
        (
            "a grid of four by three blocks, lights at all six inner crossroads",
            "map columns=4 rows=3 lights",
            "map columns=4 rows=3; crossroads x6 lights",
        ),
        (
            "exactly six T junctions and no other junction, stop signs at exactly two of the junctions",
            "map t_junction x6 stop; t_junction x2",
            "map t_junction x2 stop; t_junction x4",
        ),
        (
            "map: three-arm roundabout and a crossroads",
            "map crossroads; roundabout x3",
            "map crossroads; roundabout",
        ),
    ],
)
def test_words_complete_a_route_or_a_map(words: str, read: str, meant: str) -> None:
    assert plan(brief_of(read, slotted(words), words)) == plan(read_plan(meant))
