"""Grammars whose rules write a description and its plan at the same time.

A grammar is a text. ``= name`` begins the rules of a symbol; each following line is one rule::

    = bend
    3* <sharpness?> {bend|curve} to the <side>        => turn <sharpness> <side>
    [rather ]<#2-9:n> bends, the last one a hairpin   => turn x<=n-1>; hairpin

The parts of a rule are:

    ``3*``         the weight of the rule
    ``{a|b}``      a choice between ``a`` and ``b``
    ``[a]``        ``a`` in half of the cases (``[20:a]`` in 20 % of cases)
    ``<name>``     another symbol (``<name?>`` in half of the cases, ``<name?20>`` in 20 % of cases), which
                   may have a label: ``<name:label>``
    ``<#2-9>``     a number (``<#20-90/5>`` in steps of 5), which may have a label: ``<#2-9:n>``
    ``<=n-1>``     only in a plan: a number computed from labelled numbers of the text, here ``n`` minus 1;
                   also ``<=n/2>``, ``<=n*3>`` and ``<=n+d*2>``, which is ``n`` and twice ``d``

Without ``=>``, the plan of a rule consists of the plans of its parts in order. In a plan, ``|word`` is a
requirement for the whole road, wherever it occurs. A rule with ``-`` before ``=>`` has an empty text. Lines
that begin with ``--`` are comments.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from itertools import accumulate

import numpy as np

from roadgpt.errors import UsageError
from roadgpt_training.phrasebook import one_of, weighted
from roadgpt_training.spelling import spell

WEIGHT = re.compile(r"(\d+)\*\s*")
CHOICE = re.compile(r"\{([^{}]*)\}")
OPTION = re.compile(r"\[(?:(\d+):)?([^\[\]]*)\]")
PART = re.compile(r"<([^<>]+)>")
NUMBER = re.compile(r"#(\d+)-(\d+)(?:/(\d+))?")
SUM = re.compile(r"=(\w+)([-+*/])(\w+)(?:\*(\d+))?")
JOINT = re.compile(r"<((?:link|lastlink|vlink|oops|prewish|tailwish|lenwish|sidewish|hardwish)[?0-9]*)>")
"""Symbols that join other symbols; they get a space on both sides, and ``tidy`` removes unneeded spaces."""
DEEPEST = 30


class Discarded(Exception):  # noqa: N818 - not an error: another draw follows
    """Raised if the randomly chosen parts of a description do not fit together; the caller then tries
    again.
    """


@dataclass(frozen=True, slots=True)
class Production:
    """One rule of a symbol: a text, and the plan that it stands for."""

    text: str
    plan: str | None
    """The plan of the rule; None: the plans of the parts of the text, in order."""


@dataclass(frozen=True, slots=True)
class Grammar:
    """The rules of one language."""

    language: str
    rules: Mapping[str, tuple[Production, ...]]
    weights: Mapping[str, tuple[float, ...]]
    """The cumulative weights of the rules of each symbol, for the random choice of a rule."""


def read_grammar(text: str, language: str) -> Grammar:
    """Parses the text of a grammar.

    Raises:
        UsageError: a symbol is used but has no rules.
    """
    rules: dict[str, list[Production]] = {}
    weights: dict[str, list[float]] = {}
    symbol = ""
    for line in map(str.strip, text.splitlines()):
        if not line or line.startswith("--"):
            continue
        if line.startswith("= "):
            symbol = line[2:].strip()
            rules.setdefault(symbol, [])
            weights.setdefault(symbol, [])
            continue
        weight = WEIGHT.match(line)
        said, arrow, plan = line[weight.end() if weight else 0 :].partition("=>")
        said = JOINT.sub(r" <\1> ", said).strip()
        rules[symbol].append(Production("" if said == "-" else said, plan.strip() if arrow else None))
        weights[symbol].append(float(weight[1]) if weight else 1.0)
    for name, its in rules.items():
        for rule in its:
            for part in PART.findall(rule.text):
                used = _name(part)[0]
                if not NUMBER.fullmatch(used) and used not in rules:
                    raise UsageError(
                        f"the grammar '{language}' uses <{used}> in <{name}>, but has no rules for it"
                    )
    return Grammar(
        language,
        {name: tuple(its) for name, its in rules.items()},
        {name: tuple(accumulate(its)) for name, its in weights.items()},
    )


def _name(part: str) -> tuple[str, str, int]:
    """Returns symbol, label and percentage of a part."""
    symbol, _, label = part.partition(":")
    symbol, question, percent = symbol.partition("?")
    return symbol, label or symbol, int(percent or 50) if question else 100


class Speaker:
    """Makes random descriptions from a grammar. Each speaker has a habit in writing numbers: mostly digits,
    mostly words, or both.
    """

    def __init__(self, grammar: Grammar, rng: np.random.Generator) -> None:
        self.grammar = grammar
        self.rng = rng
        self.digits = float(rng.choice([0.02, 0.5, 0.97], p=[0.35, 0.2, 0.45]))

    def say(self, symbol: str, depth: int = 0) -> tuple[str, str]:
        """Returns a random text for a symbol, and the plan of the text.

        Raises:
            Discarded: the randomly chosen parts do not fit together, or are nested too deeply.
        """
        if depth > DEEPEST:
            raise Discarded
        rule = self.grammar.rules[symbol][weighted(self.grammar.weights[symbol], self.rng)]
        text = self._chosen(rule.text)
        plans: dict[str, str] = {}
        in_order: list[str] = []
        out: list[str] = []
        end = 0
        for part in PART.finditer(text):
            out.append(text[end : part.start()])
            end = part.end()
            name, label, percent = _name(part[1])
            if percent < 100 and self.rng.random() * 100 >= percent:
                continue
            said, plan = (
                self._number(name, _is_glued(text, part)) if name[0] == "#" else self.say(name, depth + 1)
            )
            out.append(said)
            plans[label] = f"{plans[label]} {plan}" if label in plans and name[0] != "#" else plan
            in_order.append(plan)
        out.append(text[end:])
        if rule.plan is None:
            return "".join(out), " ".join(plan for plan in in_order if plan)
        return "".join(out), PART.sub(lambda match: _filled(match[1], plans), rule.plan)

    def _chosen(self, text: str) -> str:
        before = ""
        while text != before:
            before = text
            text = OPTION.sub(lambda m: m[2] if self.rng.random() * 100 < float(m[1] or 50) else "", text)
            text = CHOICE.sub(lambda m: one_of(m[1].split("|"), self.rng), text)
        return text

    def _number(self, name: str, is_glued: bool) -> tuple[str, str]:
        match = NUMBER.fullmatch(name)
        if not match:
            raise UsageError(f"the grammar has a number <{name}>; write <#2-9> or <#20-90/5>")
        low, high, step = int(match[1]), int(match[2]), int(match[3] or 1)
        number = low + step * int(self.rng.integers((high - low) // step + 1))
        in_words = self.rng.random() > (self.digits if number <= 20 else 1 - (1 - self.digits) * 0.3)
        if in_words and not is_glued and 1 < number <= 1500 and (number <= 200 or number % 5 == 0):
            return spell(number, self.grammar.language), str(number)
        return str(number), str(number)


def _is_glued(text: str, part: re.Match[str]) -> bool:
    """True if a letter touches this number, as in 50m or R20; it is then written in digits."""
    return text[part.end() : part.end() + 1].isalpha() or text[: part.start()][-1:].isalpha()


def _filled(part: str, plans: Mapping[str, str]) -> str:
    total = SUM.fullmatch(part)
    if not total:
        return plans.get(part, "")
    left, right = (
        int(name) if name.isdigit() else int(plans.get(name) or 0) for name in (total[1], total[3])
    )
    right *= int(total[4] or 1)
    if total[2] == "/" and (not right or left % right):
        raise Discarded
    number = {"-": left - right, "+": left + right, "*": left * right, "/": left // max(right, 1)}[total[2]]
    if number < 1:
        raise Discarded
    return str(number)


@cache
def grammar_of(language: str, phrases: str = "") -> Grammar:
    """Returns RoadGPT's grammar of a language: en, de, fr, es or it.

    ``phrases`` is "" for the grammar of descriptions; "contrasts", "specs" or "networks" to add further
    symbols to it; "changes" for the grammar of change requests.

    Raises:
        UsageError: there are no phrases in this language.
    """
    folder = files("roadgpt_training") / "phrases"
    begin = [*([] if phrases == "changes" else [language]), *([f"{phrases}_{language}"] if phrases else [])]
    every = sorted(path.name for path in folder.iterdir())
    names = [name for each in begin for name in every if name.startswith(each)]
    if not names:
        raise UsageError(f"there are no phrases in the language '{language}'; there are: de, en, es, fr, it")
    return read_grammar("\n".join((folder / name).read_text(encoding="utf-8") for name in names), language)
