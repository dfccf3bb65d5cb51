"""Renders the pages that raters see. They work without scripts; with scripts each answer is saved at once."""

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from roadgpt.study.survey.questions import MOST_LETTERS
from roadgpt.study.survey.survey import Survey

HEADINGS = {
    "about": "About you",
    "alignment": "Does the road match its description?",
    "check": "A quick check",
    "similarity": "How similar are the two roads?",
    "end": "Final remarks",
}
"""Heading of each part of a questionnaire."""
ENVIRONMENT = Environment(
    loader=FileSystemLoader(Path(__file__).parent / "templates"),
    autoescape=True,  # every value, whatever its template is called
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
"""The templates; all of them can use ``headings`` and ``most_letters``."""


def _paragraphs(text: str) -> Markup:
    """Returns text as paragraphs; empty lines separate them."""
    parts = [part.strip() for part in text.replace("\r\n", "\n").split("\n\n") if part.strip()]
    return Markup("\n").join(Markup("<p>{}</p>").format(part) for part in parts)  # it escapes each part


ENVIRONMENT.filters["paragraphs"] = _paragraphs
ENVIRONMENT.globals.update(headings=HEADINGS, most_letters=MOST_LETTERS)


def render(template: str, survey: Survey, **values: object) -> str:
    """Returns a page as HTML; every value is escaped.

    Args:
        template: name of a file in ``templates``.
        survey: the survey, for its title, texts and pages.
        **values: other values that the template uses.
    """
    return ENVIRONMENT.get_template(template).render(survey=survey, **values)
