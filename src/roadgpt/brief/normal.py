"""The normal form of a Brief: two Briefs that ask for the same road have the same normal form.

- ``words``, ``unused``, ``confidence`` and ``other`` describe the origin of a Brief, not its requirements,
  and are cleared.
- A slope with a number loses its adverb: 'steeply up' at 12 percent becomes 'up' at 12 percent. A grade in
  percent without a direction is uphill.
- A clause with several straights, crests or dips is split into clauses with a single one. So is a clause
  with alternating turns if the direction of the first is known. Consecutive clauses for equal turns, S-bends
  or chicanes are merged into one clause with the total count.
- A serpentine 'of 4 turns or more' becomes a serpentine without a count. ``alternating`` is not set for kinds
  that always alternate.
- A requirement for every turn (sharpness, degrees, radius) moves to the clauses if they name the turns.
- If all clauses have the same slope and none has a height, it becomes that of the whole road.
- A height in metres makes 'steeply up' an 'up', and is uphill without a direction.
- Fields that only repeat the clauses (number of turns, left or right, slope, first and last feature) are
  cleared.
- If 4 of 5 turns go left, 1 goes right; if none goes left, all turns go right.
- If a Brief names no other feature, 'N turns' becomes a clause, and 'N or more turns' a requirement for the
  whole road.
- A Brief that names no features and no number of turns requires at least one turn. A Brief that names only
  straights forbids turns, unless it has the requirement '0 or more turns'. This requirement is removed from
  all other Briefs.
"""

from math import inf

from roadgpt.brief.like_numbers import with_like_numbers
from roadgpt.brief.model import OTHER_SIDE, Amount, Brief, Clause, Kind, Side, Slope, at_least, exactly, span
from roadgpt.brief.words import KINDS

STRAIGHT: frozenset[Kind] = frozenset({"straight", "crest", "dip"})
BUMPS: frozenset[Kind] = frozenset({"crest", "dip"})
SINGLE: frozenset[Kind] = frozenset({"turn", "hairpin", "switchback", "u_turn"})
SHAPED: frozenset[Kind] = frozenset({"turn", "s_bend", "winding", "serpentine", "zigzag"})
"""The kinds of turns whose sharpness is not fixed by their kind."""
MOST_SINGLE = 60
MOST_STEPS = 8  # one step may enable another; contradictory Briefs need the most steps
UNSAID = {"words": "", "unused": (), "confidence": 1.0, "other": ""}
"""The fields of a Brief that require nothing."""
PLAIN: dict[Slope, Slope] = {
    "steeply_up": "up",
    "steeply_down": "down",
    "gently_up": "up",
    "gently_down": "down",
}


def normal(brief: Brief) -> Brief:
    """Returns the normal form of a Brief; a Brief in normal form is returned unchanged.

    For a route with junctions, the requirements for each road are brought into normal form.
    """
    if brief.junctions or brief.map is not None:
        stretches = tuple(map(_normal_stretch, brief.stretches))
        return brief.model_copy(update={**UNSAID, "stretches": stretches})
    before, after = brief, _simpler(brief)
    for _ in range(MOST_STEPS):
        if after == before:
            break
        before, after = after, _simpler(after)
    return after


def _normal_stretch(brief: Brief) -> Brief:
    """Returns the normal form of the requirements for a road of a route, which needs no turn."""
    if brief.clauses or brief.turns is not None:
        return normal(brief)
    return normal(brief).model_copy(update={"turns": None})


def _simpler(brief: Brief) -> Brief:
    clauses = [one for clause in with_like_numbers(brief).clauses for one in _singles(_plain(clause))]
    whole = _plain_slope(_without_empty_bounds(brief))
    whole = whole.model_copy(update=UNSAID)
    whole, clauses = _ends(whole, clauses)
    whole, clauses = _turns_as_clause(whole, clauses)
    whole, clauses = _sided(whole, clauses)
    whole, clauses = _pushed_down(whole, clauses)
    whole = _with_one_slope(whole, clauses)
    clauses = _merged([_without_slope_of(whole, clause) for clause in clauses])
    whole = _without_repeats(whole, clauses)
    whole, clauses = _turns_as_wish(whole, clauses)
    if whole.turns is None:
        whole = whole.model_copy(update={"turns": _unsaid_turns(whole, clauses)})
    if whole.turns == exactly(0) and not clauses_turn(clauses):
        whole = whole.model_copy(update={"alternating": False})
    return whole.model_copy(update={"clauses": tuple(clauses)})


def clauses_turn(clauses: list[Clause] | tuple[Clause, ...]) -> bool:
    """Returns True if any of the clauses contains a turn."""
    return any(clause.kind not in STRAIGHT for clause in clauses)


def _unsaid_turns(whole: Brief, clauses: list[Clause]) -> Amount | None:
    neither = all(side == exactly(0) for side in (whole.left, whole.right))
    if not clauses:
        return exactly(0) if neither else at_least(1)
    turning = whole.hard or whole.left or whole.right or _turns(whole.starts) or _turns(whole.ends)
    return exactly(0) if total(clauses) == exactly(0) and not turning else None


def _without_empty_bounds(brief: Brief) -> Brief:
    """'0 to 4 turns' becomes at most 4; '0 or more' requires nothing and is removed."""
    update: dict[str, Amount | None] = {}
    for name in ("turns", "left", "right", "hills"):
        amount: Amount | None = getattr(brief, name)
        if amount and amount.hi == 0:
            update[name] = exactly(0)
        elif amount and amount.lo == 0 and not (name == "turns" and _only_straights(brief, amount)):
            update[name] = None if amount.hi is None else Amount(hi=amount.hi)
    return brief.model_copy(update=update)


def _only_straights(brief: Brief, amount: Amount) -> bool:
    """True if only straights are named; '0 or more turns' then allows turns that are excluded otherwise."""
    turning = brief.left or brief.right or brief.hard or _turns(brief.starts) or _turns(brief.ends)
    return bool(brief.clauses) and amount.hi is None and not clauses_turn(brief.clauses) and not turning


def _turns(clause: Clause | None) -> bool:
    return clause is not None and clause.kind not in STRAIGHT


def total(clauses: list[Clause] | tuple[Clause, ...]) -> Amount:
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
    if clause.kind in ("s_bend", "chicane"):
        return lo * least, hi * most
    return (least, most) if clause.count == exactly(1) else (lo, hi)


def _plain(clause: Clause) -> Clause:
    kind, count = clause.kind, clause.count
    said = {"slope": clause.slope, "incline": clause.incline, **_slope(clause.slope, clause.incline)}
    if clause.climb and kind not in BUMPS:  # metres replace "steep" and "gentle", as a grade does
        said["slope"] = PLAIN.get(clause.slope, clause.slope) if clause.slope else "up"
    if kind in STRAIGHT:
        return Clause(
            kind=kind,
            count=count,
            climb=clause.climb,
            length=clause.length,
            size=clause.size if kind == "straight" and not clause.length else None,
            **(said if kind == "straight" else {"incline": clause.incline}),
        )
    own = KINDS[kind]
    if (
        own.turns
        and own.turns.lo > 1
        and kind not in ("s_bend", "chicane")
        and count == at_least(own.turns.lo)
    ):
        count = exactly(1)
    one = count == exactly(1) and (own.turns is None or own.turns.hi == 1)
    alternating = clause.alternating and not own.alternating and not one
    return clause.model_copy(update={**said, "count": count, "alternating": alternating, "size": None})


def _slope(slope: Slope | None, incline: Amount | None) -> dict[str, Slope]:
    if incline is None:
        return {}
    if slope in (None, "flat", "nearly_flat"):
        return {} if slope else {"slope": "up"}
    return {"slope": PLAIN.get(slope, slope)} if slope else {}


def _plain_slope(brief: Brief) -> Brief:
    return brief.model_copy(update=_slope(brief.slope, brief.incline))


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


def _ends(whole: Brief, clauses: list[Clause]) -> tuple[Brief, list[Clause]]:
    """Converts the first and last feature to clauses where possible."""
    starts, ends = (None if c is None else _plain(c) for c in (whole.starts, whole.ends))
    if not clauses and (whole.turns is None or whole.turns == at_least(1)):
        return whole.model_copy(update={"starts": starts, "ends": ends}), clauses
    if not clauses and whole.turns and (starts or ends):
        if whole.turns == exactly(0):
            return _ends_of_a_straight(whole, [c for c in (starts, ends) if c])
        clauses = [Clause(kind="turn", count=whole.turns)]
        whole = whole.model_copy(update={"turns": None})
    if starts and (folded := _folded(clauses[:1], starts)) is not None:
        clauses, starts = folded + clauses[1:], None
    if ends and (folded := _folded(clauses[-1:], ends)) is not None:
        clauses, ends = clauses[:-1] + folded[::-1], None
    return whole.model_copy(update={"starts": starts, "ends": ends}), clauses


def _ends_of_a_straight(whole: Brief, things: list[Clause]) -> tuple[Brief, list[Clause]]:
    if clauses_turn(things):  # a contradiction; ``check`` reports it
        return whole, []
    return whole.model_copy(update={"starts": None, "ends": None}), things


def _folded(edge: list[Clause], thing: Clause) -> list[Clause] | None:
    """Returns the first or last feature and the rest of the clause there; None if they cannot be split."""
    if not edge or edge[0] == thing:
        return edge or None
    if thing.kind in STRAIGHT:
        return [thing, *edge]
    first = edge[0]
    number = thing.count.lo or 1
    more = (first.count.lo or 0) > number and thing.count.exact
    if first.kind != "turn" or not more or first.alternating or (first.side and first.side != thing.side):
        return None
    count = Amount(
        lo=(first.count.lo or 1) - number, hi=None if first.count.hi is None else first.count.hi - number
    )
    return [thing, first.model_copy(update={"count": count})]


def _is_plain(clause: Clause) -> bool:
    return clause.kind == "turn" and not any((clause.side, clause.slope, clause.length))


def _turns_as_clause(whole: Brief, clauses: list[Clause]) -> tuple[Brief, list[Clause]]:
    """Converts 'exactly 3 turns', or '3 turns or more, none to the right', to a clause."""
    turns, side = whole.turns, _forced_side(whole)
    if clauses or not turns or not turns.lo or whole.starts or whole.ends or not (turns.exact or side):
        return whole, clauses
    alternating = whole.alternating and turns.exact
    return whole.model_copy(update={"turns": None, "alternating": alternating}), [
        Clause(kind="turn", count=turns, side=None if turns.exact else side)
    ]


def _sided(whole: Brief, clauses: list[Clause]) -> tuple[Brief, list[Clause]]:
    """Fills in the sides of turns where the numbers leave no choice."""
    if not clauses_turn(clauses):
        return whole, clauses
    whole = _with_other_side(whole, total(clauses))
    side = _forced_side(whole)
    open_kinds = SINGLE - {"switchback"}
    if not side:
        return whole, clauses
    return whole, [
        c.model_copy(update={"side": side}) if c.kind in open_kinds and not (c.side or c.alternating) else c
        for c in clauses
    ]


def _with_other_side(whole: Brief, turns: Amount) -> Brief:
    """Fills in the number of turns in one direction, if the total and the number in the other direction
    are exact.
    """
    for one, other in OTHER_SIDE.items():
        counted: Amount | None = getattr(whole, one)
        if turns.exact and counted and counted.exact and getattr(whole, other) is None:
            rest = span(turns).lo - span(counted).lo
            if rest >= 0:
                return whole.model_copy(update={other: exactly(rest)})
    return whole


def _forced_side(whole: Brief) -> Side | None:
    """Returns the direction of all turns if turns in the other direction are excluded; None if they are
    not.
    """
    sides = [one for one, other in OTHER_SIDE.items() if getattr(whole, other) == exactly(0)]
    return sides[0] if len(sides) == 1 else None


def _turns_as_wish(whole: Brief, clauses: list[Clause]) -> tuple[Brief, list[Clause]]:
    """Converts the clause '3 turns or more' to a requirement for the whole road."""
    if len(clauses) != 1 or not _is_plain(clauses[0]) or clauses[0].count.exact or whole.turns:
        return whole, clauses
    only = clauses[0]
    update = {"turns": only.count, "alternating": whole.alternating or only.alternating}
    shape = {"sharpness": only.sharpness, "degrees": only.degrees, "radius": only.radius}
    return whole.model_copy(update={**update, **shape}), []


def _pushed_down(whole: Brief, clauses: list[Clause]) -> tuple[Brief, list[Clause]]:
    """Moves requirements for every turn to the clauses that turn."""
    turning = [clause for clause in clauses if clause.kind not in STRAIGHT]
    if not turning:
        return whole, clauses
    stays = _radius_stays(whole, turning)
    shared = whole.model_copy(update={"radius": None}) if stays else whole
    pushed = [clause if clause.kind in STRAIGHT else _shaped(shared, clause) for clause in clauses]
    if whole.alternating and len(turning) == 1:
        pushed = [one for c in pushed for one in _singles(_plain(c.model_copy(update={"alternating": True})))]
    alternating = whole.alternating and len(turning) > 1
    gone = {"sharpness": None, "degrees": None, **({} if stays else {"radius": None})}
    return whole.model_copy(update={**gone, "alternating": alternating}), pushed


def _radius_stays(whole: Brief, turning: list[Clause]) -> bool:
    """Returns whether a radius of "at least" or "at most" for every turn stays a limit of the road, because
    turns have a word such as "sharp" instead of a radius of their own.
    """
    is_worded = any(clause.sharpness and not clause.radius for clause in turning)
    return is_worded and whole.radius is not None and not whole.radius.exact


def _shaped(whole: Brief, clause: Clause) -> Clause:
    said = {
        name: getattr(clause, name) or getattr(whole, name) for name in ("sharpness", "degrees", "radius")
    }
    if clause.radius or clause.sharpness:  # its own shape is not mixed with the shape asked of the whole road
        said["sharpness"], said["radius"] = clause.sharpness, clause.radius
    if clause.kind not in SHAPED:
        said["sharpness"] = clause.sharpness
    return clause.model_copy(update=said)


def _with_one_slope(whole: Brief, clauses: list[Clause]) -> Brief:
    said = {(clause.slope, clause.incline) for clause in clauses}
    rises_and_falls = any(clause.kind in BUMPS for clause in clauses)
    has_height = any(clause.climb for clause in clauses)  # its grade need not be the usual one of the word
    if whole.slope or whole.hills or whole.starts or whole.ends or len(said) != 1 or rises_and_falls:
        return whole
    if has_height:
        return whole
    slope, incline = said.pop()
    return whole.model_copy(update={"slope": slope, "incline": incline or whole.incline})


def _without_slope_of(whole: Brief, clause: Clause) -> Clause:
    is_said_alone = clause.incline in (None, whole.incline) and clause.climb is None
    if clause.slope and clause.slope == whole.slope and is_said_alone:
        return clause.model_copy(update={"slope": None, "incline": None})
    return clause


def _merged(clauses: list[Clause]) -> list[Clause]:
    out: list[Clause] = []
    for clause in clauses:
        last = out[-1] if out else None
        if last is not None and _like(last, clause):
            count = exactly((last.count.lo or 0) + (clause.count.lo or 0))
            out[-1] = last.model_copy(update={"count": count})
        else:
            out.append(clause)
    return out


def _like(one: Clause, other: Clause) -> bool:
    if one.kind not in (*SINGLE, "s_bend", "chicane") or one.kind != other.kind or one.alternating:
        return False
    if KINDS[one.kind].alternating and one.side:
        return False
    both_exact = one.count.exact and other.count.exact
    return both_exact and one.model_copy(update={"count": other.count}) == other


def _without_repeats(whole: Brief, clauses: list[Clause]) -> Brief:
    turning = [clause for clause in clauses if clause.kind not in STRAIGHT]
    if not turning:
        return whole
    gone: list[str] = []
    if whole.turns and _within(total(clauses), whole.turns):
        gone.append("turns")
    sides: tuple[Side, Side] = ("left", "right")
    for side in sides:
        wished: Amount | None = getattr(whole, side)
        told = all(
            c.kind in SINGLE and c.side and not (c.alternating and c.count != exactly(1)) for c in turning
        )
        if wished and told and _within(total([c for c in turning if c.side == side]), wished):
            gone.append(side)
    if whole.starts == clauses[0]:
        gone.append("starts")
    if whole.ends == clauses[-1]:
        gone.append("ends")
    return whole.model_copy(update=dict.fromkeys(gone))


def _within(one: Amount, other: Amount) -> bool:
    """True if ``other`` allows every number that ``one`` allows."""
    return span(other).lo <= span(one).lo and span(one).hi <= span(other).hi
