"""Changes of scenes that clauses of a request tell in words of the table, such as "the truck brakes harder".
Whatever else a request says is left to the networks."""

import re
from contextlib import suppress

from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.languages import TABLE, pattern_of
from roadgpt.brief.plan import SCENE
from roadgpt.brief.readers.model.mentions import known_as, mentions_in
from roadgpt.brief.readers.model.number_words import plain
from roadgpt.errors import EditError
from roadgpt.language.table import WEATHER

WORDS, DEEDS, SPOTS, WISHES = (
    {name: pattern_of(name, f"scene_{part}") for name in TABLE[f"scene_{part}"]}
    for part in ("changes", "deeds", "spots", "wishes")
)
IDLE = {*TABLE["scene_changes"]["idle"].split()}
Span = tuple[int, int]


def told_in(words: str) -> tuple[list[str], list[str], list[str]]:
    """Returns the changes as plans, the clauses that tell none, and words without effect in the others."""
    said, rest, unused, who, deed, start = list[str](), list[str](), list[str](), "", "", 0
    text, every, is_shared = plain(words), [*mentions_in(words)], False
    for end, behind in [*(found.span() for found in WORDS["divided"].finditer(text)), (len(text),) * 2]:
        clause, begin, start = text[start:end], start, behind
        inside = [each for each in every if begin <= each.start < end]
        named = [(str(each.name), (each.start - begin, each.end - begin)) for each in inside]
        who, spans = _who_in(clause, named) or (who, [])
        deeds = {name: found for name, each in DEEDS.items() if (found := [*each.finditer(clause)])}
        wishes = {wish: found for wish, each in WISHES.items() if (found := [*each.finditer(clause)])}
        deed = next(iter(deeds), deed)
        plans = [plan for wish in wishes if (plan := _plan(wish, who, deed))]
        spans += [each.span() for found in (*deeds.values(), *wishes.values()) for each in found]
        left = [found for found in re.finditer(r"[^\W\d_]+", clause) if found[0] not in IDLE]
        left = [found for found in left if not any(a <= found.start() < b for a, b in spans)]
        is_clear = not (WORDS["others"].search(WORDS["vehicle"].sub("", clause)) or (left and who in WEATHER))
        if (wait := WORDS["wait"].search(clause)) and said and said[-1].startswith("add ego: stop"):
            said[-1] += f", wait {wait[1].replace(',', '.')}"
        elif plans and len(plans) == len(wishes) and is_clear:
            said += plans
            unused += [words[begin + found.start() : begin + found.end()] for found in left]
        elif spans or left:
            rest.append(words[begin:end].strip())
            is_shared |= not (left or deeds or wishes) and text[end:behind].isalpha()  # "the bus and the car"
    return ([], [words], []) if is_shared else (said, rest, unused)


def unnamed_in(words: str, plan: str) -> tuple[str, ...]:
    """Returns the words that name others, or weather, of which a plan of changes of a scene says nothing."""
    told = {*re.findall(r"\w+", plan)}
    missed = [each for each in mentions_in(words) if not {each.name, known_as(each.name), "actor"} & told]
    return tuple(words[each.start : each.end] for each in missed if not each.is_own)


def _who_in(clause: str, named: list[tuple[str, Span]]) -> tuple[str, list[Span]] | None:
    """Returns whom or what a clause names, as plans do, and where; None if it names nobody."""
    if own := WORDS["own"].search(clause):
        return "ego", [own.span()]
    if one := WORDS["vehicle"].search(clause):
        return f"actor {int(one[1]) - 1}", [one.span()]
    named = named or [("actor", found.span()) for found in WORDS["any"].finditer(clause)]
    if not named or len({name for name, _ in named}) > 1:  # of several, who does what is not clear
        return ("", []) if named else None
    spots = [(spot, found.span()) for spot, each in SPOTS.items() if (found := each.search(clause))][:1]
    return " ".join([named[0][0], *(spot for spot, _ in spots)]), [span for _, span in (*named, *spots)]


def _plan(wish: str, who: str, deed: str) -> str:
    """Returns the change that a wish asks for; "" if that cannot be."""
    plan = f"add {who}" if wish == "add" else f"{who}: {wish.format(deed=deed)}"
    plan = f"add {plan}" if wish.startswith("stop") else plan
    is_possible = (who in WEATHER) == (wish in ("add", "remove")) and (who == "ego" or "stop" not in wish)
    with suppress(EditError):
        return plan if who and is_possible and read_change_plan(f"{SCENE} {plan}") else ""
    return ""
