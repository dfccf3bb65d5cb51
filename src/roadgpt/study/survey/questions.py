"""Defines the questions in the three parts of the thesis' survey, with their answers and criteria.

Source: RoadGPT's thesis, section 6.2. The thesis gives all five answers to questions about a road and its
description. For questions about two roads, it gives only the first, the second and the last of five answers;
the third and the fourth are our additions.
"""

from typing import Literal

from roadgpt.brief.model import Frozen

Part = Literal["about", "alignment", "check", "similarity", "end"]
"""The parts of a questionnaire."""
Rated = Literal["alignment", "similarity"]
"""The parts in which raters rate roads."""
MOST_LETTERS = 2000  # of a remark
REMARKS = "remarks"
OVERALL = "overall"
MATCHES = (
    "does not match the description at all",
    "generally does not match the description",
    "somewhat matches the description",
    "mostly matches the description",
    "perfectly matches the description",
)
ALIKE = (
    "definitely different",
    "mostly dissimilar",
    "somewhat similar",
    "mostly similar",
    "basically the same road",
)
ALIKE_IN = (*ALIKE[:-1], "(almost) identical")
CHECK = 2  # index in MATCHES of the answer that the attention check asks for
CRITERIA = {
    "turns": "number of turns",
    "incline": "incline",
    "order": "order of turns",
    "length": "length of the road",
}
"""The names of criteria in SURVEY.toml, and the texts that raters read."""
PAIR_CRITERIA = tuple(CRITERIA.values())


class Question(Frozen):
    """One question with a choice of answers, or with free text if no answers are given."""

    id: str
    text: str
    answers: tuple[str, ...] = ()
    criterion: str = ""
    """The criterion that is rated, or "overall"; empty if the question is not a rating."""
    is_needed: bool = True
    """True if the page reminds raters who leave the question unanswered."""

    @property
    def is_rating(self) -> bool:
        """True if the answer is a rating of a road or of two roads."""
        return bool(self.criterion)

    def takes(self, value: str) -> bool:
        """Returns whether a value is a valid answer. An empty value, which deletes an earlier answer, is
        always valid."""
        return value in self.answers or not value if self.answers else len(value) <= MOST_LETTERS

    def score(self, value: str) -> int:
        """Returns the position of an answer on the scale of answers, counted from 1."""
        return self.answers.index(value) + 1


RATHER_NOT = "I would rather not say"
HOW_OFTEN = ("never", "occasionally", "regularly", RATHER_NOT)
ABOUT = tuple(
    Question(id=f"about.{name}", text=text, answers=answers)
    for name, text, answers in (
        (
            "age",
            "How old are you?",
            ("under 20", "20 to 29", "30 to 39", "40 to 49", "50 to 59", "60 or older", RATHER_NOT),
        ),
        (
            "occupation",
            "What is your occupation?",
            (
                "student",
                "researcher",
                "engineer or developer",
                "teacher or lecturer",
                "something else",
                RATHER_NOT,
            ),
        ),
        ("licence", "Do you have a driver's licence?", ("yes", "no", RATHER_NOT)),
        (
            "countries",
            "In how many countries have you driven?",
            ("none", "1", "2 to 3", "4 to 6", "7 or more", RATHER_NOT),
        ),
        ("ai", "How often do you use generative AI (chat and the like)?", HOW_OFTEN),
        ("simulators", "How often do you use driving simulators?", HOW_OFTEN),
    )
)
"""The thesis' six questions about the rater."""


def rating_questions(item: str, part: Rated, criteria: tuple[str, ...]) -> tuple[Question, ...]:
    """Returns the questions about a road and its description, or about two roads.

    The first question asks for an overall rating, one question follows for each criterion, and the last one
    asks for remarks.

    Args:
        item: id of the road, or of the pair of roads, in the survey.
        part: "alignment" for a road and its description, "similarity" for two roads.
        criteria: the names of the criteria that raters read.
    """
    if part == "alignment":
        overall, each = (
            "How well does the road match the description in general?",
            "how well does the road match?",
        )
        answers, in_each, what = MATCHES, MATCHES, "this road"
    else:
        overall, each = (
            "How similar are road 1 (top) and road 2 (bottom) in general?",
            "how similar are the two roads?",
        )
        answers, in_each, what = ALIKE, ALIKE_IN, "these two roads"
    remarks = f"Do you have any remarks about {what}? (optional)"
    return (
        Question(id=f"{item}.{OVERALL}", text=overall, answers=answers, criterion=OVERALL),
        *(
            Question(
                id=f"{item}.{number}",
                text=f"{criterion[:1].upper()}{criterion[1:]}: {each}",
                answers=in_each,
                criterion=criterion,
            )
            for number, criterion in enumerate(criteria, 1)
        ),
        Question(id=f"{item}.{REMARKS}", text=remarks, is_needed=False),
    )


ATTENTION = Question(
    id="check",
    text=f"This question checks that questions are read. Please choose “{MATCHES[CHECK]}” here.",
    answers=MATCHES,
)
"""The attention check, whose text contains the right answer."""
END = Question(
    id="end.remarks", text="Is there anything else that you want to tell us? (optional)", is_needed=False
)


def clean(text: str) -> str:
    """Returns text with plain spaces, and with line feeds as line ends. Control characters (except tabs),
    surrogates, and white space at both ends are removed."""
    text = text.replace("\r\n", "\n").replace("\r", "\n").encode("utf-8", "ignore").decode()
    return "".join(map(_letter, text)).strip()


def _letter(letter: str) -> str:
    """Returns a character as it is stored. White space becomes a plain space (tabs and line feeds are
    kept); other invisible characters, except joiners, become an empty string."""
    if letter in "\n\t\u200c\u200d" or letter.isprintable():
        return letter
    return " " if letter.isspace() else ""
