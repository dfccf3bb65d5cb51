"""Random things for Hypothesis: worlds, briefs and designs."""

from hypothesis import strategies as st

from roadgpt.brief.model import Amount, Brief, Clause, at_least, at_most, between, exactly
from roadgpt.road import Design, Segment, World

SLOPES = ("up", "down", "flat", "nearly_flat", "gently_up", "gently_down", "steeply_up", "steeply_down")
TURNS = (
    "turn", "hairpin", "switchback", "u_turn", "s_bend", "chicane", "slalom", "serpentine", "zigzag",
    "winding",
)  # fmt: skip


def worlds() -> st.SearchStrategy[World]:
    """Maps of 100 to 600 m, else as RoadGPT's."""
    return st.builds(World().changed, map_size=st.sampled_from([100.0, 150.0, 200.0, 250.0, 400.0, 600.0]))


def maybe(strategy: st.SearchStrategy, often: int = 4) -> st.SearchStrategy:
    """Nothing, but for one time in so many."""
    return st.integers(1, often).flatmap(lambda n: strategy if n == 1 else st.none())


def amounts(low: float, high: float, whole: bool = False) -> st.SearchStrategy[Amount]:
    """Numbers as people ask for them: exactly, at least, at most, between."""
    numbers = st.integers(int(low), int(high)) if whole else st.floats(low, high).map(lambda x: round(x, 1))
    pairs = st.tuples(numbers, numbers).map(lambda pair: between(min(pair), max(pair)))
    return st.one_of(
        numbers.map(exactly), numbers.map(exactly), numbers.map(at_least), numbers.map(at_most), pairs
    )


def straights() -> st.SearchStrategy[Clause]:
    """Straights, crests and dips with any length and slope."""
    return st.builds(
        Clause,
        kind=st.sampled_from(["straight", "straight", "straight", "crest", "dip"]),
        length=maybe(amounts(15, 120)),
        size=maybe(st.sampled_from(["long", "short"])),
        slope=maybe(st.sampled_from(SLOPES), 2),
        incline=st.none(),
    )


def turns() -> st.SearchStrategy[Clause]:
    """One turn or several, of any kind."""
    return st.builds(
        Clause,
        kind=st.sampled_from([*TURNS, "turn", "turn", "turn"]),
        count=st.one_of(st.integers(1, 4).map(exactly), st.integers(1, 3).map(at_least)),
        side=maybe(st.sampled_from(["left", "right"]), 2),
        alternating=st.booleans(),
        sharpness=maybe(st.sampled_from(["gentle", "sweeping", "sharp"])),
        degrees=maybe(amounts(20, 170), 6),
        radius=maybe(amounts(12, 90), 6),
        length=maybe(amounts(20, 80), 10),
        slope=maybe(st.sampled_from(SLOPES), 2),
    )


def briefs() -> st.SearchStrategy[Brief]:
    """Anything that can be asked for, contradictions included."""
    return st.builds(
        Brief,
        clauses=st.lists(st.one_of(turns(), turns(), straights()), max_size=4).map(tuple),
        turns=maybe(amounts(0, 7, whole=True)),
        left=maybe(amounts(0, 4, whole=True), 6),
        right=maybe(amounts(0, 4, whole=True), 6),
        alternating=maybe(st.just(True), 6).map(bool),
        sharpness=maybe(st.sampled_from(["gentle", "sweeping", "sharp"]), 6),
        slope=maybe(st.sampled_from(SLOPES)),
        turning=maybe(amounts(60, 400), 8),
        steepest=maybe(amounts(2, 15), 8),
        climb=maybe(amounts(-25, 25), 8),
        hills=maybe(amounts(1, 5, whole=True), 8),
        length=maybe(amounts(60, 500), 6),
        starts=maybe(st.one_of(turns(), straights()), 8),
        ends=maybe(st.one_of(turns(), straights()), 8),
        hard=maybe(st.just(True), 8).map(bool),
    )


def sensible_briefs() -> st.SearchStrategy[Brief]:
    """What does not contradict itself and has room on a map of 250 m: a few things in order, or wishes."""
    turn = st.builds(
        Clause,
        kind=st.sampled_from(["turn", "turn", "hairpin", "s_bend", "switchback", "chicane", "u_turn"]),
        side=maybe(st.sampled_from(["left", "right"]), 2),
        slope=maybe(st.sampled_from(SLOPES), 2),
    )
    bend = st.builds(
        Clause,
        kind=st.just("turn"),
        count=st.integers(1, 2).map(exactly),
        sharpness=maybe(st.sampled_from(["gentle", "sharp"]), 2),
        degrees=maybe(st.floats(30, 90).map(lambda x: exactly(round(x))), 3),
    )
    straight = st.builds(
        Clause,
        kind=st.just("straight"),
        size=maybe(st.sampled_from(["long", "short"]), 3),
        slope=maybe(st.sampled_from(SLOPES), 2),
    )
    in_order = st.builds(Brief, clauses=st.lists(st.one_of(turn, bend, straight), max_size=3).map(tuple))
    wishes = st.builds(
        Brief,
        turns=st.integers(2, 5).map(exactly),
        slope=maybe(st.sampled_from(SLOPES), 2),
        sharpness=maybe(st.sampled_from(["gentle", "sharp"]), 3),
        alternating=st.booleans(),
        length=maybe(st.integers(250, 400).map(exactly), 3),
        hard=maybe(st.just(True), 4).map(bool),
    )
    return st.one_of(in_order, wishes)


def segments() -> st.SearchStrategy[Segment]:
    """Segments within RoadGPT's ranges, as a person or a language model writes them."""

    def segment(distance: float, turn: float, incline: float, straight: bool) -> Segment:
        if straight or turn == 0:
            return Segment(distance=distance, direction="straight", incline=incline)
        side = "left" if turn > 0 else "right"
        return Segment(distance=distance, direction=side, incline=incline, turn_degrees=turn)

    return st.builds(
        segment,
        distance=st.floats(10, 90).map(lambda x: round(x, 1)),
        turn=st.integers(-70, 70).map(float),
        incline=st.integers(-15, 15).map(float),
        straight=st.booleans(),
    )


def designs() -> st.SearchStrategy[Design]:
    """Random segment lists: most cross themselves or leave the map, as those of a language model do."""
    place = st.floats(0, 250).map(lambda x: round(x, 1))
    return st.builds(
        Design,
        starting_point=st.tuples(place, place, st.floats(-20, 20)),
        theta=st.integers(0, 359).map(float),
        segments=st.lists(segments(), min_size=1, max_size=8).map(tuple),
    )
