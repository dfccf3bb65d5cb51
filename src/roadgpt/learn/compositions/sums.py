"""Descriptions with counts that add up, such as the number of all turns and the numbers of left and right
turns.
"""

from roadgpt.learn.compositions.voice import NOUNS, OTHER, SIDES, Composition, DescribedTurn, Voice, clauses


def sided_sum(voice: Voice) -> Composition:
    """Returns a description that gives the number of turns and how many go left and right.

    Sometimes it also says that the turns to one side come first or last.
    """
    total = voice.whole(2, 9)
    side = voice.pick(SIDES)
    few = voice.whole(1, max(1, total // 2))
    many = total - few
    count = voice.say("totals", n=voice.number(total), noun=voice.pick(NOUNS))
    text = f"{count}, " + voice.say(
        "sums", one=_sided(voice, few, side), other=_sided(voice, many, OTHER[side])
    )
    if voice.chance(0.45):
        left, right = (few, many) if side == "left" else (many, few)
        return voice.framed(text, f"| turns={total} lefts={left} rights={right}")
    place = voice.pick(("last", "last", "first"))
    text += voice.pick((", ", "; ", ", and ")) + voice.say(f"{'one' if few == 1 else 'many'} {place}", s=side)
    own, rest = [DescribedTurn(mods={"side": side})] * few, [DescribedTurn(mods={"side": OTHER[side]})] * many
    return voice.framed(text, clauses([*rest, *own] if place == "last" else [*own, *rest]))


def _sided(voice: Voice, number: int, side: str) -> str:
    return (
        f"{voice.number(number)} {voice.pick((side, side if number == 1 else f'{side}s', f'to the {side}'))}"
    )


def ranged(voice: Voice) -> Composition:
    """Returns a description with a range of counts, such as three to five turns.

    Sometimes it also says how the first or the last turn differs from the others.
    """
    low = voice.whole(2, 5)
    high = low + voice.whole(1, 3)
    numbers = {"low": low, "high": high, "less": low - 1, "more": high + 1}
    count = voice.say(
        "ranges", noun=voice.pick(NOUNS), **{name: voice.number(value) for name, value in numbers.items()}
    )
    if voice.chance(0.35):
        return voice.framed(count, f"| turns={low}..{high}")
    side = voice.pick(SIDES)
    own, said = voice.pick(
        (("turn", f"a {side}"), ("turn", f"a {side}-hander"), ("hairpin", f"a {side} hairpin"))
    )
    rest = f"turn x{low - 1}..{high - 1}"
    if voice.chance(0.5):
        return voice.framed(voice.say("first of", count=count, said=said), f"{own} {side}; {rest}")
    return voice.framed(voice.say("last of", count=count, said=said), f"{rest}; {own} {side}")
