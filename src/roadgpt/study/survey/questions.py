"""Defines the questions: the thesis' three parts, its answers and its criteria.

Source: RoadGPT's thesis, section 6.2. It names all five answers about a description, but of those about two
roads only the ends and "mostly dissimilar"; the two between are ours.
"""

from typing import Literal

from roadgpt.brief.model import Frozen

Part = Literal["about", "alignment", "check", "similarity", "end"]
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
"""Short names in a survey's file, and the texts that raters read."""
PAIR_CRITERIA = tuple(CRITERIA.values())


class Question(Frozen):
    """One question: a choice of answers, or free text if there are none."""

    id: str
    text: str
    answers: tuple[str, ...] = ()
    criterion: str = ""
    """What is rated: "overall" or a criterion; empty if the question is no rating."""
    is_needed: bool = True
    """Whether the page says so if the question has no answer."""

    @property
    def is_rating(self) -> bool:
        """Whether it is a rating of a road."""
        return bool(self.criterion)

    def takes(self, value: str) -> bool:
        """Returns whether a value is a possible answer; an empty one always is, and deletes the answer."""
        return value in self.answers or not value if self.answers else len(value) <= MOST_LETTERS

    def score(self, value: str) -> int:
        """Returns the position of an answer on its scale, from 1."""
        return self.answers.index(value) + 1


RATHER_NOT = "I would rather not say"
ABOUT = (
    Question(
        id="about.age",
        text="How old are you?",
        answers=("under 20", "20 to 29", "30 to 39", "40 to 49", "50 to 59", "60 or older", RATHER_NOT),
    ),
    Question(
        id="about.occupation",
        text="What is your occupation?",
        answers=(
            "student",
            "researcher",
            "engineer or developer",
            "teacher or lecturer",
            "something else",
            RATHER_NOT,
        ),
    ),
    Question(id="about.licence", text="Do you have a driver's licence?", answers=("yes", "no", RATHER_NOT)),
    Question(
        id="about.countries",
        text="In how many countries have you driven?",
        answers=("none", "1", "2 to 3", "4 to 6", "7 or more", RATHER_NOT),
    ),
    Question(
        id="about.ai",
        text="How often do you use generative AI (chat and the like)?",
        answers=("never", "occasionally", "regularly", RATHER_NOT),
    ),
    Question(
        id="about.simulators",
        text="How often do you use driving simulators?",
        answers=("never", "occasionally", "regularly", RATHER_NOT),
    ),
)


def alignment_questions(item: str, criteria: tuple[str, ...]) -> tuple[Question, ...]:
    """Returns the questions about a road and its description: overall, each criterion, remarks."""
    overall = Question(
        id=f"{item}.{OVERALL}",
        text="How well does the road match the description in general?",
        answers=MATCHES,
        criterion=OVERALL,
    )
    return (
        overall,
        *_each(item, criteria, "{}: how well does the road match?", MATCHES),
        _remarks(item, "this road"),
    )


def similarity_questions(item: str, criteria: tuple[str, ...]) -> tuple[Question, ...]:
    """Returns the questions about two roads: overall, each criterion, remarks."""
    overall = Question(
        id=f"{item}.{OVERALL}",
        text="How similar are road 1 (top) and road 2 (bottom) in general?",
        answers=ALIKE,
        criterion=OVERALL,
    )
    return (
        overall,
        *_each(item, criteria, "{}: how similar are the two roads?", ALIKE_IN),
        _remarks(item, "these two roads"),
    )


def _each(item: str, criteria: tuple[str, ...], text: str, answers: tuple[str, ...]) -> tuple[Question, ...]:
    return tuple(
        Question(
            id=f"{item}.{number}",
            text=text.format(criterion[:1].upper() + criterion[1:]),
            answers=answers,
            criterion=criterion,
        )
        for number, criterion in enumerate(criteria, 1)
    )


def _remarks(item: str, what: str) -> Question:
    return Question(
        id=f"{item}.{REMARKS}", text=f"Do you have any remarks about {what}? (optional)", is_needed=False
    )


def check_question() -> Question:
    """Returns the attention check, whose text contains the right answer."""
    return Question(
        id="check",
        text=f"This question checks that questions are read. Please choose “{MATCHES[CHECK]}” here.",
        answers=MATCHES,
    )


END = Question(
    id="end.remarks", text="Is there anything else that you want to tell us? (optional)", is_needed=False
)


def clean(text: str) -> str:
    """Returns a text without control characters, lone surrogates and outer spaces; "\\n" ends its lines."""
    text = text.replace("\r\n", "\n").replace("\r", "\n").encode("utf-8", "ignore").decode()
    return "".join(map(_letter, text)).strip()


def _letter(letter: str) -> str:
    """Returns a character as stored: any space becomes a plain one; invisible ones but joiners vanish."""
    if letter in "\n\t\u200c\u200d" or letter.isprintable():
        return letter
    return " " if letter.isspace() else ""
