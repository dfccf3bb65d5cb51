"""Makes the sentences and tables of a survey's report."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from roadgpt.report.page import Block, Details, Figure, Table, TableCell, cell
from roadgpt.study.statistics import LEVEL, conover, friedman, spearman, wilcoxon
from roadgpt.study.survey.answers import Answers
from roadgpt.study.survey.questions import REMARKS
from roadgpt.study.survey.rating_charts import PageFigure
from roadgpt.study.survey.tally import RatingTally, Unit, agreement, score_matrix

NAMES = {"alignment": "road and description", "similarity": "two roads"}


def summary(answers: Answers, match: RatingTally, alike: RatingTally) -> list[str]:
    """Returns the sentences of the summary."""
    used = len({row.rater for row in answers.used})
    lines = [
        f"The answers of {used} raters are analysed; {answers.finished} of them rated everything. "
        f"{len(answers.failed)} failed the attention check and are left out."
    ]
    for found, says in (
        (match, "that roads match their descriptions"),
        (alike, "that two roads are similar"),
    ):
        scores = [score for unit in found.overall for score in unit.given]
        if scores:
            share = sum(score >= 4 for score in scores) / len(scores)
            lines.append(
                f"Overall, {share:.0%} of {len(scores)} ratings say {says} (one of the two highest answers)"
                f"{_alpha_text(agreement(found.overall))}."
            )
    return lines


@dataclass(frozen=True)
class SurveyBlocks:
    """Makes tables and figures; those of made-up raters say so in their captions."""

    is_synthetic: bool

    def figure(self, drawn: PageFigure, caption: str) -> Figure:
        """Returns a figure with its caption."""
        return Figure(drawn.name, self._marked(caption), drawn.svg)

    def table(
        self,
        name: str,
        caption: str,
        heads: Sequence[str],
        rows: Sequence[Sequence[TableCell]],
        note: str = "",
    ) -> Table:
        """Returns a table with its caption."""
        name = f"synthetic-{name}" if self.is_synthetic else name
        return Table(name, self._marked(caption), heads, rows, note)

    def _marked(self, caption: str) -> str:
        return f"SYNTHETIC (made-up raters): {caption}" if self.is_synthetic else caption

    def numbers(self, answers: Answers) -> Table:
        """Returns the table of how many raters were invited, agreed, withdrew and were analysed."""
        used = len({row.rater for row in answers.used})
        rows = [
            ("links given or taken", answers.invited),
            ("agreed to take part", answers.agreed),
            ("withdrew; their answers are deleted", answers.withdrawn),
            ("failed the attention check; left out below", len(answers.failed)),
            ("left the attention check out; analysed", len(answers.unchecked)),
            ("analysed", used),
            ("of these, rated everything", answers.finished),
        ]
        return self.table(
            "raters", "Raters", ("", "number"), [[cell(text), cell(count)] for text, count in rows]
        )

    def about(self, counts: Sequence[tuple[str, Sequence[tuple[str, int]]]]) -> Details:
        """Returns the table of the answers about the raters, folded."""
        rows = [
            [cell(text), cell(answer), cell(count)]
            for text, answers in counts
            for answer, count in answers
            if count
        ]
        table = self.table("about", "Who answered", ("question", "answer", "raters"), rows)
        return Details("The same as a table", [table])

    def ratings(self, found: RatingTally) -> Table:
        """Returns the table of ratings: every road in every criterion."""
        answers = found.units[0].question.answers
        firsts = {unit.item.id: unit.question.id for unit in reversed(found.units)}
        rows = [self._rating(unit, firsts[unit.item.id] == unit.question.id) for unit in found.units]
        heads = (
            "item",
            "description",
            "criterion",
            "n",
            "1",
            "2",
            "3",
            "4",
            "5",
            "median",
            "quartiles",
            "4 or 5",
            "95 %",
        )
        scale = "; ".join(f"{number}: {answer}" for number, answer in enumerate(answers, 1))
        return self.table(f"{found.part}-ratings", f"Ratings: {NAMES[found.part]}", heads, rows, scale)

    def _rating(self, unit: Unit, is_first: bool) -> list[TableCell]:
        """Returns a row; the description is shown once for each item."""
        low, middle, high = unit.quartiles
        count, interval = unit.favourable
        share = count / unit.number if unit.number else float("nan")
        return [
            cell(unit.item.id, unit.item.id if is_first else ""),
            cell(unit.item.prompt, unit.item.prompt if is_first else ""),
            cell(unit.criterion),
            cell(unit.number),
            *(cell(each) for each in unit.counts),
            cell(_finite(middle), _number(middle, 1)),
            cell(f"{low:g} to {high:g}" if unit.number else None),
            cell(_finite(share), f"{share:.0%}" if unit.number else "–"),
            cell(f"{interval.lo:.0%} to {interval.hi:.0%}" if unit.number else None),
        ]

    def differences(self, found: RatingTally) -> list[Block]:
        """Tests whether the items differ: Friedman and Conover for three or more, Wilcoxon for two."""
        units = found.overall
        if len(units) < 2 or not found.raters:
            return ["One item alone cannot be compared with others."]
        scores = score_matrix(units)
        if len(units) == 2:
            paired = wilcoxon(scores[:, 0], scores[:, 1])
            return [
                f"The two{_verdict(paired.p)} in general: Wilcoxon's signed-rank test of "
                f"{paired.pairs} raters, p {_p(paired.p)}, rank-biserial correlation {paired.effect:.2f}."
            ]
        test = friedman(scores)
        if test.people < 2:
            return ["Fewer than two raters rated all of them, so they cannot be compared."]
        line = (
            f"The items{_verdict(test.p)} in general: Friedman's test of the {test.people} raters who "
            f"rated all, chi-squared({test.freedom}) = {test.statistic:.2f}, p {_p(test.p)}, "
            f"Kendall's W = {test.kendalls_w:.2f}."
        )
        if test.p >= LEVEL:  # pairs are compared only where the items differ at all (Conover 1999, 5.8)
            return [f"{line} So pairs of them are not compared."]
        p = conover(scores)
        rows = [
            [
                cell(one.item.id),
                *(
                    cell(float(p[i, j]), _p(p[i, j]).removeprefix("= ")) if j < i else cell("", "")
                    for j in range(len(units))
                ),
            ]
            for i, one in enumerate(units)
        ]
        heads = ("", *(unit.item.id for unit in units))
        caption = "p of every pair after Friedman's test (Conover, corrected by Holm)"
        return [line, self.table(f"{found.part}-pairs", caption, heads, rows)]

    def agreement(self, tallies: Sequence[RatingTally]) -> Table:
        """Returns the table of Krippendorff's alpha, criterion by criterion."""
        rows = []
        for found in tallies:
            for criterion in found.criteria:
                units = found.of(criterion)
                rows.append(self._agreed(found, criterion, units))
            if found.units:
                rows.append(self._agreed(found, "all ratings", found.units))
        return self.table(
            "agreement",
            "Agreement between raters: Krippendorff's alpha (ordinal)",
            ("part", "criterion", "items", "ratings", "alpha"),
            rows,
            "1: all raters agree; 0: as by chance; below 0: less than by chance. A dash: one item only, or "
            "all ratings are the same, so alpha is undefined. Krippendorff asks for 0.8, and 0.667 for "
            "tentative conclusions.",
        )

    def _agreed(self, found: RatingTally, criterion: str, units: Sequence[Unit]) -> list[TableCell]:
        alpha = agreement(units)
        return [
            cell(NAMES[found.part]),
            cell(criterion),
            cell(len(units)),
            cell(sum(unit.number for unit in units)),
            cell(_finite(alpha), _number(alpha)),
        ]

    def machine(self, tallies: Sequence[RatingTally]) -> list[Block]:
        """Returns the mean scores of people beside the measured ones, with their rank correlation."""
        blocks: list[Block] = []
        for found in tallies:
            units = [unit for unit in found.units if unit.measured is not None and unit.number]
            if not units:
                continue
            people = [float(unit.given.mean()) for unit in units]
            machine = [float(unit.measured or 0.0) for unit in units]
            correlation = spearman(people, machine)
            rows = [
                [
                    cell(u.item.id),
                    cell(u.item.prompt),
                    cell(u.criterion),
                    cell(one, f"{one:.2f}"),
                    cell(two, f"{two:.2f}"),
                ]
                for u, one, two in zip(units, people, machine, strict=True)
            ]
            line = f"{NAMES[found.part].capitalize()}: "
            if isfinite(correlation.rho):
                line += (
                    f"Spearman's rho is {correlation.rho:.2f} over {correlation.pairs} questions, each with "
                    f"people's mean (p {_p(correlation.p)}, as if questions were independent; those "
                    "about one road are not)."
                )
            else:
                line += (
                    "the scores of people or the measured scores are all equal, or too few for a correlation."
                )
            heads = ("item", "description", "criterion", "people, mean of 1 to 5", "machine, 0 to 1")
            blocks += [
                line,
                self.table(
                    f"{found.part}-machine", f"People and measurements: {NAMES[found.part]}", heads, rows
                ),
            ]
        return blocks or ["None of the criteria that people rated was measured."]

    def remarks(self, answers: Answers) -> Block:
        """Returns the table of remarks."""
        rows = [
            [cell(row.item or "at the end"), cell(row.prompt), cell(row.answer)]
            for row in sorted(answers.used, key=lambda row: (row.item, row.rater))
            if row.question.endswith(f".{REMARKS}")
        ]
        if not rows:
            return "There are no remarks."
        return self.table("remarks", f"{len(rows)} remarks", ("item", "description", "remark"), rows)


def _alpha_text(alpha: float) -> str:
    return f"; Krippendorff's alpha is {_number(alpha)}" if isfinite(alpha) else ""


def _verdict(p: float) -> str:
    return " differ" if p < LEVEL else " do not differ significantly"


def _finite(value: float) -> float | None:
    return round(value, 4) if isfinite(value) else None


def _number(value: float, digits: int = 2) -> str:
    # adding 0 makes minus nothing nothing
    return f"{round(value, digits) + 0.0:.{digits}f}" if isfinite(value) else "–"


def _p(value: float) -> str:
    return "< 0.001" if value < 0.001 else f"= {value:.3f}"
