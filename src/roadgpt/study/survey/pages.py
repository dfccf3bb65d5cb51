"""The pages that raters see, as HTML. They work without scripts; with them answers are saved at once."""

from collections.abc import Collection, Mapping, Sequence
from functools import cache
from pathlib import Path

from roadgpt.study.survey.asking import asked, told_of_missing
from roadgpt.study.survey.markup import Markup, fill, joined, paragraphs
from roadgpt.study.survey.media_markup import shown
from roadgpt.study.survey.survey import Page, Survey

HERE = Path(__file__).parent / "page"
HEADINGS = {
    "about": "About you",
    "alignment": "Does the road match its description?",
    "check": "Are you with us?",
    "similarity": "How similar are the two roads?",
    "end": "Last words",
}
LAYOUT = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="robots" content="noindex, nofollow">
<meta name="color-scheme" content="light dark">
<title>{head} - {title}</title>
<link rel="stylesheet" href="/static/survey.css">
<link rel="icon" href="data:,">
<script src="/static/survey.js" defer></script>
</head>
<body>
<a class="skip" href="#main">Skip to the questions</a>
<header class="top"><p class="name">{title}</p>{progress}</header>
<main id="main" tabindex="-1">
{body}
</main>
<footer class="bottom">{foot}</footer>
</body>
</html>
"""


def layout(
    survey: Survey, head: str, body: Markup, progress: Markup | str = "", foot: Markup | str = ""
) -> str:
    """A whole page."""
    return fill(LAYOUT, title=survey.title, head=head, body=body, progress=progress, foot=foot)


def consent(survey: Survey, action: str, is_joining: bool = False) -> str:
    """The first page: who asks, what for, what is kept; nothing is asked before it is agreed to."""
    body = fill(
        """<h1>{title}</h1>
{purpose}
<h2>Who asks</h2>
{asks}
<p>Questions go to {contact}.</p>
<h2>What is kept</h2>
<p>Your answers, the day on which you agreed, and nothing else: no name, no address, no network address, no
cookies. Your link stands for you; whoever has it can read and change your answers.</p>
{keeps}
<h2>It is up to you</h2>
<p>You may leave out any question, stop at any time and go on later with the same link, and have all your
answers deleted with the link “my answers” at the foot of every page.</p>
{joining}
<form method="post" action="{action}">
<p class="agree"><label><input type="checkbox" name="agree" value="yes" required>
<span>I have read this, I am at least 18 years old, and I agree to take part.</span></label></p>
<p class="go"><button class="main">Begin</button></p>
</form>""",
        title=survey.title,
        purpose=paragraphs(survey.purpose),
        asks=paragraphs(survey.asks),
        contact=survey.contact,
        keeps=paragraphs(survey.keeps),
        joining=is_joining
        and Markup("<p>You will get a link of your own; keep it if you want to go on later.</p>"),
        action=action,
    )
    return layout(survey, "Welcome", body)


def questionnaire(
    survey: Survey,
    pages: Sequence[Page],
    number: int,
    base: str,
    given: Mapping[str, str],
    missing: Collection[str] = (),
) -> str:
    """Page ``number`` (from 1) of a rater's questionnaire.

    Args:
        survey: what is asked.
        pages: in this rater's order.
        number: of the page.
        base: the rater's address, ``/r/TOKEN``.
        given: answers so far.
        missing: questions of this page that were left out, of which the rater is to be told.
    """
    page = pages[number - 1]
    body = fill(
        """<h1>{heading}</h1>
{missing}
{shown}
<form method="post" action="{base}/{number}" class="questions" data-save="{base}/answer" novalidate>
{questions}
<p class="go">{back}<button class="main" name="go" value="next">{next}</button>{skip}</p>
<p class="saved" role="status" aria-live="polite"></p>
</form>""",
        heading=HEADINGS[page.part],
        missing=told_of_missing(page, missing),
        shown=shown(page.item, base) if page.item else "",
        base=base,
        number=number,
        questions=joined([asked(question, given.get(question.id, "")) for question in page.questions]),
        back=number > 1 and Markup('<button name="go" value="back">Back</button>'),
        next="Finish" if number == len(pages) else "Next",
        skip=bool(missing) and Markup('<button name="go" value="skip">Go on without</button>'),
    )
    head = f"{HEADINGS[page.part]} ({number} of {len(pages)})"
    return layout(survey, head, body, _progress(number, len(pages)), _foot(base))


def _progress(number: int, total: int) -> Markup:
    return fill(
        '<p class="progress"><label for="progress">Page {number} of {total}</label>'
        '<progress id="progress" value="{done}" max="{total}"></progress></p>',
        number=number,
        total=total,
        done=number - 1,
    )


def _foot(base: str) -> Markup:
    return fill(
        "<p>Every answer is saved as you give it; this link brings you back to where you were. "
        '<a href="{base}/mine">My answers</a></p>',
        base=base,
    )


def done(survey: Survey, base: str, left_out: int) -> str:
    """The page after the last one."""
    body = fill(
        """<h1>Thank you</h1>
<p>All your answers are saved{left}. You may close this page, or <a href="{base}/1">look through your
answers</a> and change them for as long as the survey is open.</p>
<p>Questions go to {contact}.</p>""",
        base=base,
        contact=survey.contact,
        left=f"; {left_out} {'question has' if left_out == 1 else 'questions have'} none" if left_out else "",
    )
    return layout(survey, "Thank you", body, foot=_foot(base))


def mine(survey: Survey, base: str, given: Mapping[str, str], agreed_on: str) -> str:
    """All that is kept of a rater, and the button that deletes it."""
    rows = [
        fill(
            "<tr><td>{about}</td><td>{text}</td><td>{value}</td></tr>",
            about=about,
            text=text,
            value=given[id_],
        )
        for id_, about, text in _named(survey)
        if id_ in given
    ]
    table = fill(
        '<div class="wide"><table><thead><tr><th scope="col">About</th><th scope="col">Question</th>'
        '<th scope="col">Your answer</th></tr></thead><tbody>{rows}</tbody></table></div>',
        rows=joined(rows),
    )
    body = fill(
        """<h1>My answers</h1>
<p>You agreed to take part on {agreed_on}. Besides that, this is all that is kept:</p>
{table}
<p class="go"><a class="button" href="{base}">Back to the survey</a></p>
<h2>Withdraw</h2>
<p>This deletes all your answers for good. They cannot be brought back, and your link will be closed.</p>
<form method="post" action="{base}/withdraw">
<p class="agree"><label><input type="checkbox" name="sure" value="yes" required>
<span>Yes, delete all my answers.</span></label></p>
<p class="go"><button class="danger">Delete my answers</button></p>
</form>""",
        base=base,
        agreed_on=agreed_on,
        table=table if rows else Markup("<p>(no answers yet)</p>"),
    )
    return layout(survey, "My answers", body)


def _named(survey: Survey) -> list[tuple[str, str, str]]:
    """Every question with what it is about."""
    return [
        (question.id, page.item.prompt if page.item else HEADINGS[page.part], question.text)
        for page in survey.pages
        for question in page.questions
    ]


def withdrawn(survey: Survey) -> str:
    """After a withdrawal."""
    body = fill(
        "<h1>Your answers are deleted</h1><p>Nothing that you answered is kept, and this link is closed. "
        "Thank you for having thought about it. Questions go to {contact}.</p>",
        contact=survey.contact,
    )
    return layout(survey, "Deleted", body)


def notice(survey: Survey, head: str, text: str) -> str:
    """A page with a sentence: what is wrong, and what to do."""
    return layout(survey, head, fill("<h1>{head}</h1><p>{text}</p>", head=head, text=text))


@cache
def static(name: str) -> bytes:
    """A file that stands beside the pages."""
    return (HERE / name).read_bytes()
