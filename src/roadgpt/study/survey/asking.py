"""Questions as HTML: scales, choices, words, and what is said of those that were left out."""

from collections.abc import Collection

from roadgpt.study.survey.markup import Markup, fill, joined
from roadgpt.study.survey.questions import MOST_LETTERS, Question
from roadgpt.study.survey.survey import Page


def told_of_missing(page: Page, missing: Collection[str]) -> Markup | str:
    """Which questions have no answer yet, each a link to it; nothing where none is missing."""
    left = [question for question in page.questions if question.id in missing]
    if not left:
        return ""
    links = [fill('<li><a href="#{id}">{text}</a></li>', id=_place(each), text=each.text) for each in left]
    return fill(
        '<div class="missing" role="alert" tabindex="-1"><h2>{head}</h2><ul>{links}</ul></div>',
        head="One question has no answer yet"
        if len(left) == 1
        else f"{len(left)} questions have no answer yet",
        links=joined(links),
    )


def _place(question: Question) -> str:
    return f"q-{question.id.replace('.', '-')}"


def asked(question: Question, given: str) -> Markup:
    """A question with the answer that was given; empty: none."""
    return _choice(question, given) if question.answers else _words(question, given)


def _choice(question: Question, given: str) -> Markup:
    answers = [
        fill(
            '<label><input type="radio" name="{id}" value="{answer}"{checked}><span>{answer}</span></label>',
            id=question.id,
            answer=answer,
            checked=Markup(" checked") if answer == given else "",
        )
        for answer in question.answers
    ]
    return fill(
        '<fieldset id="{place}" class="{kind}"><legend>{text}</legend>'
        '<div class="answers">{answers}</div></fieldset>',
        place=_place(question),
        kind="scale" if question.is_rating or question.id == "check" else "choice",
        text=question.text,
        answers=joined(answers),
    )


def _words(question: Question, given: str) -> Markup:
    # a first line that is empty would be lost without the one that the template adds
    return fill(
        '<p class="words"><label for="{place}">{text}</label>'
        '<textarea id="{place}" name="{id}" rows="3" maxlength="{most}">\n{given}</textarea></p>',
        place=_place(question),
        id=question.id,
        text=question.text,
        most=MOST_LETTERS,
        given=given,
    )
