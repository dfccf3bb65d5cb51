"""The normal form of a Brief: two Briefs that ask for the same road have the same normal form.

What describes only the origin of a Brief is cleared. Each requirement stands in one place and in one form: a
number replaces its word; what holds for every turn stands in the clauses if they name the turns; equal
neighbours are one clause; what only repeats the clauses, or follows from other numbers, is left out or filled
in always. A Brief without features and number of turns asks for at least one turn, and one of straights alone
for none, unless it asks for '0 or more turns'."""

from collections.abc import Iterable, Sequence
from math import inf

from roadgpt.brief.model import OTHER_SIDE, Amount, Brief, Clause, at_least, exactly, span
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import KINDS
from roadgpt.language.names import Side, Slope

STRAIGHT = frozenset(kind for kind, row in KINDS.items() if row.turns is None)
BUMPS = STRAIGHT - {"straight"}
SINGLE = frozenset(kind for kind, row in KINDS.items() if row.turns == Range(1, 1))
MOST_SINGLE = 60
MOST_STEPS = 9  # one step may enable another; contradictory Briefs need the most steps
UNSAID = {"words": "", "unused": (), "confidence": 1.0, "other": ""}
"""The fields of a Brief that require nothing."""
NAMED_BY = {"degrees": "sharpness", "radius": "sharpness", "length": "size"}
"""The numbers that like parts share, each with the field for a word that replaces the number."""
PLAIN: dict[Slope, Slope] = {
    "steeply_up": "up",
    "steeply_down": "down",
    "gently_up": "up",
    "gently_down": "down",
}


def normal(brief: Brief) -> Brief:
    """Returns the normal form of a Brief; a Brief in normal form is returned unchanged.

    For a route with junctions, the requirements for each road are brought into normal form."""
    if brief.junctions or brief.map is not None:
        stretches = [
            normal(road).model_copy(update={} if road.clauses or road.turns else {"turns": road.turns})
            for road in brief.stretches
        ]
        return brief.model_copy(update={**UNSAID, "stretches": tuple(stretches)})
    for _ in range(MOST_STEPS):
        before, brief = brief, _simpler(brief)
        if brief == before:
            break
    return brief


def _simpler(brief: Brief) -> Brief:
    clauses = tuple(one for clause in with_like_numbers(brief).clauses for one in _singles(_plain(clause)))
    whole = {**UNSAID, "slope": _slope(brief.slope, brief.incline is not None), "clauses": clauses}
    brief = _without_empty_bounds(brief).model_copy(update=whole)
    for step in (
        _with_ends_as_clauses,
        _with_turns_as_clause,
        _sided,
        _pushed_down,
        _with_one_slope,
        _merged,
        _without_repeats,
        _with_clause_as_turns,
        _with_unsaid_turns,
    ):
        brief = step(brief)
    return brief


def with_continued_grades(clauses: Sequence[Clause]) -> list[Clause]:
    """Returns the clauses; one that goes on climbing or falling behind a clause with a number for its grade
    gets the same number: "down at 3 percent, then a right turn, still downhill". Straights that follow each
    other have grades of their own, since only their grades tell them apart."""
    out: list[Clause] = []
    for clause in clauses:
        last = out[-1] if out else None
        goes_on = last and last.incline and last.slope == clause.slope and clause.slope in ("up", "down")
        is_open = not clause.incline and clause.climb is None and clause.kind not in BUMPS
        if last and goes_on and is_open and {last.kind, clause.kind} != {"straight"}:
            clause = clause.model_copy(update={"incline": last.incline})
        out.append(clause)
    return out


def with_like_numbers(brief: Brief) -> Brief:
    """Returns a Brief in which all clauses of a kind get the angle, radius or length that one clause has.

    A clause with a word instead of the number, such as "sharp", stays as it is. If clauses of a kind have
    different numbers, they all stay as they are. A Brief without ``alike`` is returned unchanged."""
    if not brief.alike:
        return brief
    clauses = brief.clauses
    for name, word in NAMED_BY.items():
        given = {(each.kind, number) for each in clauses if (number := getattr(each, name)) is not None}
        kinds = [kind for kind, _ in given]
        only = {kind: number for kind, number in given if kinds.count(kind) == 1}
        clauses = tuple(
            each.model_copy(update={name: only.get(each.kind)})
            if getattr(each, name) is None and getattr(each, word) is None
            else each
            for each in clauses
        )
    return brief.model_copy(update={"clauses": clauses})


def clauses_turn(clauses: Iterable[Clause]) -> bool:
    """Returns True if any of the clauses contains a turn."""
    return any(clause.kind not in STRAIGHT for clause in clauses)


def _turns_beside_clauses(brief: Brief) -> bool:
    return bool(brief.left or brief.right or brief.hard) or clauses_turn(brief.both_ends)


def _with_unsaid_turns(brief: Brief) -> Brief:
    """Requires a turn of a road without features, and forbids turns on a road of straights."""
    turns, is_straight = brief.turns, not clauses_turn(brief.clauses)
    if turns is None and not brief.clauses:
        turns = exactly(0) if brief.left == brief.right == exactly(0) else at_least(1)
    elif turns is None and is_straight and not _turns_beside_clauses(brief):
        turns = exactly(0)
    alternating = brief.alternating and not (is_straight and turns == exactly(0))
    return brief.model_copy(update={"turns": turns, "alternating": alternating})


def _without_empty_bounds(brief: Brief) -> Brief:
    """'0 to 4 turns' becomes at most 4; '0 or more' requires nothing and is removed."""
    update: dict[str, Amount | None] = {}
    # if only straights are named, "0 or more turns" allows turns that are excluded otherwise
    is_straight = brief.clauses and not clauses_turn(brief.clauses) and not _turns_beside_clauses(brief)
    for name in ("turns", "left", "right", "hills"):
        amount: Amount | None = getattr(brief, name)
        if amount and amount.hi == 0:
            update[name] = exactly(0)
        elif amount and amount.lo == 0 and not (name == "turns" and amount.hi is None and is_straight):
            update[name] = None if amount.hi is None else Amount(hi=amount.hi)
    return brief.model_copy(update=update)


def total(clauses: Iterable[Clause]) -> Amount:
    """Returns the total number of turns of the clauses; exactly 0 if none of them contains a turn."""
    lo, hi = 0.0, 0.0
    for clause in clauses:
        if clause.kind not in STRAIGHT:
            least, most = turns_of(clause)
            lo, hi = lo + least, hi + most
    return Amount(lo=lo, hi=None if hi == inf else hi)


def turns_of(clause: Clause) -> tuple[float, float]:
    """Returns the smallest and largest number of turns in a clause; the largest may be ``inf``."""
    own = KINDS[clause.kind].turns
    least, most = (own.lo, own.hi) if own else (1.0, 1.0)
    # a count of 0 is refused later, by brief.feasible
    lo, hi = max(span(clause.count).lo, 1.0), max(span(clause.count).hi, 1.0)
    if KINDS[clause.kind].whole:
        return lo * least, hi * most
    return (least, most) if clause.count == exactly(1) else (lo, hi)


def _plain(clause: Clause) -> Clause:
    kind, count = clause.kind, clause.count
    figures = {name: getattr(clause, name) for name in ("count", "climb", "length", "incline")}
    if kind in BUMPS:
        return Clause(kind=kind, **figures)
    slope = _slope(clause.slope, clause.bump is None and bool(clause.incline or clause.climb))
    if kind == "straight":
        return Clause(kind=kind, slope=slope, size=None if clause.length else clause.size, **figures)
    own = KINDS[kind]
    least = own.turns.lo if own.turns else 1
    if least > 1 and not own.whole and count == at_least(least):
        count = exactly(1)
    one = count == exactly(1) and (own.turns is None or own.turns.hi == 1)
    alternating = clause.alternating and not own.alternating and not one
    return clause.model_copy(
        update={"slope": slope, "count": count, "alternating": alternating, "size": None}
    )


def _slope(slope: Slope | None, has_figure: bool) -> Slope | None:
    """Returns a slope without its adverb if it has a grade or a height; without a direction, that is up."""
    return PLAIN.get(slope or "up", slope or "up") if has_figure else slope


def _singles(clause: Clause) -> list[Clause]:
    """Splits straights, and turns that alternate from a known side, into single clauses."""
    number = int(clause.count.lo or 1) if clause.count.exact or clause.kind in STRAIGHT else 0
    if clause.kind in STRAIGHT:
        return [clause.model_copy(update={"count": exactly(1)})] * min(max(number, 1), MOST_SINGLE)
    alternates = clause.alternating or KINDS[clause.kind].alternating
    if clause.kind in SINGLE and alternates and clause.side and 1 < number <= MOST_SINGLE:
        one = clause.model_copy(update={"count": exactly(1), "alternating": False})
        sides = [clause.side if at % 2 == 0 else OTHER_SIDE[clause.side] for at in range(number)]
        return [one.model_copy(update={"side": side}) for side in sides]
    return [clause]


def _with_ends_as_clauses(brief: Brief) -> Brief:
    clauses = brief.clauses
    starts, ends = (None if end is None else _plain(end) for end in (brief.starts, brief.ends))
    if not clauses and (brief.turns is None or brief.turns == at_least(1)):
        return brief.model_copy(update={"starts": starts, "ends": ends})
    if not clauses and brief.turns == exactly(0) and (starts or ends):
        things = tuple(end for end in (starts, ends) if end)
        if clauses_turn(things):  # a contradiction; ``check`` reports it
            return brief
        return brief.model_copy(update={"starts": None, "ends": None, "clauses": things})
    if not clauses and brief.turns and (starts or ends):
        clauses = (Clause(kind="turn", count=brief.turns),)
        brief = brief.model_copy(update={"turns": None})
    if starts and (folded := _folded(clauses[:1], starts)) is not None:
        clauses, starts = folded + clauses[1:], None
    if ends and (folded := _folded(clauses[-1:], ends)) is not None:
        clauses, ends = clauses[:-1] + folded[::-1], None
    return brief.model_copy(update={"starts": starts, "ends": ends, "clauses": clauses})


def _folded(edge: tuple[Clause, ...], thing: Clause) -> tuple[Clause, ...] | None:
    """Returns the first or last feature and the rest of the clause there; None if they cannot be split."""
    if not edge or edge[0] == thing:
        return edge or None
    if thing.kind in STRAIGHT:
        return (thing, *edge)
    first = edge[0]
    number = thing.count.lo or 1
    more = (first.count.lo or 0) > number and thing.count.exact
    if first.kind != "turn" or not more or first.alternating or (first.side and first.side != thing.side):
        return None
    count = Amount(
        lo=(first.count.lo or 1) - number, hi=None if first.count.hi is None else first.count.hi - number
    )
    return (thing, first.model_copy(update={"count": count}))


def _with_turns_as_clause(brief: Brief) -> Brief:
    """Converts 'exactly 3 turns', or '3 turns or more, none to the right', to a clause."""
    turns, side = brief.turns, _forced_side(brief)
    if brief.clauses or not turns or not turns.lo or brief.both_ends or not (turns.exact or side):
        return brief
    clause = Clause(kind="turn", count=turns, side=None if turns.exact else side)
    alternating = brief.alternating and turns.exact
    return brief.model_copy(update={"turns": None, "alternating": alternating, "clauses": (clause,)})


def _sided(brief: Brief) -> Brief:
    """Fills in the sides of turns, and the number of turns to a side, where the numbers leave no choice."""
    turns = total(brief.clauses)
    if turns == exactly(0):
        return brief
    for one, other in OTHER_SIDE.items():
        counted: Amount | None = getattr(brief, one)
        rest = span(turns).lo - span(counted).lo
        if turns.exact and counted and counted.exact and getattr(brief, other) is None and rest >= 0:
            brief = brief.model_copy(update={other: exactly(rest)})
    side = _forced_side(brief)
    open_kinds = SINGLE - {"switchback"}
    clauses = tuple(
        c.model_copy(update={"side": side}) if c.kind in open_kinds and not (c.side or c.alternating) else c
        for c in brief.clauses
    )
    return brief.model_copy(update={"clauses": clauses}) if side else brief


def _forced_side(brief: Brief) -> Side | None:
    """Returns the direction of all turns if turns in the other direction are excluded; None if they are
    not."""
    sides = [one for one, other in OTHER_SIDE.items() if getattr(brief, other) == exactly(0)]
    return sides[0] if len(sides) == 1 else None


def _with_clause_as_turns(brief: Brief) -> Brief:
    """Converts the clause '3 turns or more' to a requirement for the whole road."""
    if len(brief.clauses) != 1 or brief.turns:
        return brief
    only = brief.clauses[0]
    is_apart = only.side or only.slope or only.length or only.bump
    if only.kind != "turn" or only.count.exact or is_apart:
        return brief
    shape = {"sharpness": only.sharpness, "degrees": only.degrees, "radius": only.radius}
    alternating = brief.alternating or only.alternating
    return brief.model_copy(update={"turns": only.count, "alternating": alternating, **shape, "clauses": ()})


def _pushed_down(brief: Brief) -> Brief:
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    if not turning:
        return brief
    # a bound stays a limit of the road if turns have a word such as "sharp" instead of a radius of their own
    is_worded = any(clause.sharpness and not clause.radius for clause in turning)
    radius = brief.radius if is_worded and brief.radius and not brief.radius.exact else None
    shared = brief.model_copy(update={"radius": None}) if radius else brief
    clauses = [clause if clause.kind in STRAIGHT else _shaped(shared, clause) for clause in brief.clauses]
    if brief.alternating and len(turning) == 1:
        alternate = [clause.model_copy(update={"alternating": True}) for clause in clauses]
        clauses = [one for clause in alternate for one in _singles(_plain(clause))]
    whole = {"sharpness": None, "degrees": None, "radius": radius}
    alternating = brief.alternating and len(turning) > 1
    return brief.model_copy(update={**whole, "alternating": alternating, "clauses": tuple(clauses)})


def _shaped(brief: Brief, clause: Clause) -> Clause:
    shape = ("sharpness", "degrees", "radius")
    said = {name: getattr(clause, name) or getattr(brief, name) for name in shape}
    if clause.radius or clause.sharpness:  # its own shape is not mixed with the shape asked of the whole road
        said["sharpness"], said["radius"] = clause.sharpness, clause.radius
    if not KINDS[clause.kind].shaped:
        said["sharpness"] = clause.sharpness
    return clause.model_copy(update=said)


def _with_one_slope(brief: Brief) -> Brief:
    said = {(clause.slope, clause.incline) for clause in brief.clauses}
    # the grade of a part with a height need not be the usual one of the word
    is_apart = any(clause.kind in BUMPS or clause.bump or clause.climb for clause in brief.clauses)
    if brief.slope or brief.hills or brief.both_ends or len(said) != 1 or is_apart:
        return brief
    slope, incline = said.pop()
    return brief.model_copy(update={"slope": slope, "incline": incline or brief.incline})


def _merged(brief: Brief) -> Brief:
    out: list[Clause] = []
    for clause in brief.clauses:
        is_said_alone = clause.incline in (None, brief.incline) and clause.climb is None
        if clause.slope and clause.slope == brief.slope and is_said_alone:
            clause = clause.model_copy(update={"slope": None, "incline": None})
        last = out[-1] if out else None
        if last is not None and _like(last, clause):
            count = exactly((last.count.lo or 0) + (clause.count.lo or 0))
            out[-1] = last.model_copy(update={"count": count})
        else:
            out.append(clause)
    return brief.model_copy(update={"clauses": tuple(out)})


def _like(one: Clause, other: Clause) -> bool:
    if not (one.kind in SINGLE or KINDS[one.kind].whole) or one.kind != other.kind or one.alternating:
        return False
    if KINDS[one.kind].alternating and one.side:
        return False
    both_exact = one.count.exact and other.count.exact
    return both_exact and one.model_copy(update={"count": other.count}) == other


def _without_repeats(brief: Brief) -> Brief:
    clauses = brief.clauses
    turning = [clause for clause in clauses if clause.kind not in STRAIGHT]
    if not turning:
        return brief
    gone: list[str] = []
    if brief.turns and _within(total(clauses), brief.turns):
        gone.append("turns")
    told = all(c.kind in SINGLE and c.side and not (c.alternating and c.count != exactly(1)) for c in turning)
    for side in OTHER_SIDE:
        wished: Amount | None = getattr(brief, side)
        if wished and told and _within(total([c for c in turning if c.side == side]), wished):
            gone.append(side)
    if brief.starts == clauses[0]:
        gone.append("starts")
    if brief.ends == clauses[-1]:
        gone.append("ends")
    return brief.model_copy(update=dict.fromkeys(gone))


def _within(one: Amount, other: Amount) -> bool:
    return span(other).lo <= span(one).lo and span(one).hi <= span(other).hi
