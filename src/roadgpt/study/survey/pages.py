"""Renders the pages that raters see. They work without scripts; with them each answer is saved at once."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from roadgpt.study.survey.questions import MOST_LETTERS
from roadgpt.study.survey.survey import QuestionPage, Survey

TEMPLATES = Path(__file__).parent / "templates"
HEADINGS = {
    "about": "About you",
    "alignment": "Does the road match its description?",
    "check": "A quick check",
    "similarity": "How similar are the two roads?",
    "end": "Final remarks",
}


ENVIRONMENT = Environment(
    loader=FileSystemLoader(TEMPLATES),
    autoescape=True,  # every value, whatever its template is called
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)


def _paragraphs(text: str) -> Markup:
    """Returns text as paragraphs; empty lines separate them."""
    parts = [part.strip() for part in text.replace("\r\n", "\n").split("\n\n") if part.strip()]
    return Markup("\n").join(Markup("<p>{}</p>").format(part) for part in parts)  # it escapes each part


ENVIRONMENT.filters["paragraphs"] = _paragraphs


def render(template: str, survey: Survey, **values: object) -> str:
    """Returns a page as HTML; every value is escaped.

    Args:
        template: name of a file in ``templates``.
        survey: the survey, for its title and texts.
        **values: what else the template names.
    """
    return ENVIRONMENT.get_template(template).render(survey=survey, **values)


def questionnaire(
    survey: Survey,
    pages: Sequence[QuestionPage],
    number: int,
    base: str,
    given: Mapping[str, str],
    missing: Collection[str] = (),
) -> str:
    """Returns one page of a rater's questionnaire.

    Args:
        survey: the survey.
        pages: all pages in this rater's order.
        number: which page, from 1.
        base: the rater's address, ``/r/TOKEN``.
        given: the answers so far, by question.
        missing: ids of questions on this page without an answer, which the page lists at its top.
    """
    return render(
        "questionnaire.html",
        survey,
        headings=HEADINGS,
        page=pages[number - 1],
        number=number,
        total=len(pages),
        base=base,
        given=given,
        missing=missing,
        most_letters=MOST_LETTERS,
    )


def own_answers(survey: Survey, base: str, given: Mapping[str, str], agreed_on: str) -> str:
    """Returns the page that lists everything stored about a rater, with the button that deletes it."""
    rows = [
        (page.item.prompt if page.item else HEADINGS[page.part], question.text, given[question.id])
        for page in survey.pages
        for question in page.questions
        if question.id in given
    ]
    return render("mine.html", survey, base=base, rows=rows, agreed_on=agreed_on)
