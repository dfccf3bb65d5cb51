"""What is answered to whom: every request of a rater becomes a page, a file or a sentence. Knows no sockets.

/static/NAME                                    the style and the script
/join/SHARED                                    where a survey is open: makes a rater of whoever agrees
/r/TOKEN                                        consent, or the first page that is not finished
/r/TOKEN/N             GET, POST a form         page N of this rater
/r/TOKEN/answer        POST JSON                one answer, confirmed when it is on the disk
/r/TOKEN/media/NAME                             a picture, a film, a 3-D view
/r/TOKEN/done, /mine, /withdraw                 the end; what is kept; deletes it
"""

import hmac
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import parse_qsl

from roadgpt.study.survey import pages
from roadgpt.study.survey.order import pages_for
from roadgpt.study.survey.questions import clean
from roadgpt.study.survey.store import MOST_RATERS, Rater, Store
from roadgpt.study.survey.survey import MEDIA, Page, Survey

STATIC = {"survey.css": "text/css; charset=utf-8", "survey.js": "text/javascript; charset=utf-8"}
TYPES = {"picture": "image/png", "film": "video/mp4", "view": "text/html; charset=utf-8"}
JSON, HTML = "application/json", "text/html; charset=utf-8"
FORM = "application/x-www-form-urlencoded"
MOST_FIELDS = 100  # of a form
CLOSED = "This link is closed: the answers given with it were deleted."
UNKNOWN = "Nothing is here. Please open the link that you were given, in full."


@dataclass(frozen=True)
class Asked:
    """A request, as far as it matters; ``body`` is empty unless it is a POST."""

    method: str
    path: str
    kind: str = ""
    """Content type of the body, without parameters."""
    body: bytes = b""


@dataclass(frozen=True)
class Told:
    """An answer: a body, or a file to be sent."""

    status: int
    body: bytes = b""
    kind: str = HTML
    headers: Mapping[str, str] = field(default_factory=dict)
    file: Path | None = None
    is_frame: bool = False
    """Is it a page of its own scripts, which is shown in a frame?"""


@dataclass(frozen=True)
class Desk:
    """Answers requests about one survey; may be asked by many threads at once."""

    folder: Path
    survey: Survey
    store: Store
    shared: str = ""
    """Token of the link with which anyone may join; empty where nobody may."""

    def answer(self, asked: Asked) -> Told:
        """The answer to any request whatsoever; raises only where the file of answers fails."""
        if asked.method not in ("GET", "POST"):
            return self._notice(
                405, "Not here", "This address answers to GET and POST only.", {"Allow": "GET, POST"}
            )
        match asked.path.split("?")[0].split("#")[0].split("/")[1:]:
            case ["static", name] if asked.method == "GET" and name in STATIC:
                return Told(200, pages.static(name), STATIC[name])
            case ["join", token] if self.shared and _is_same(token, self.shared):
                return self._join(asked)
            case ["r", token, *rest]:
                rater = self.store.rater_of(token)
                if rater is not None:
                    return self._of_rater(asked, rater, f"/r/{token}", rest)
        return self._notice(404, "Not found", UNKNOWN)

    def _join(self, asked: Asked) -> Told:
        if asked.method == "GET":
            return _page(pages.consent(self.survey, asked.path.split("?")[0], is_joining=True))
        if _fields(asked).get("agree") != "yes":
            return _moved(asked.path.split("?")[0])
        if len(self.store.raters()) >= MOST_RATERS:
            return self._notice(503, "Full", "This survey takes no more people.")
        token = self.store.add_rater(joined=True)
        rater = self.store.rater_of(token)
        assert rater is not None
        self.store.agree(rater)
        return _moved(f"/r/{token}/1")

    def _of_rater(self, asked: Asked, rater: Rater, base: str, rest: list[str]) -> Told:
        if rater.state == "withdrawn":
            if rest == ["answer"]:
                return _said(410, error=CLOSED)
            return _page(pages.withdrawn(self.survey), 410 if asked.method == "POST" else 200)
        match rest:
            case [] | [""]:
                return self._door(asked, rater, base)
            case ["media", name] if asked.method == "GET":
                return self._medium(name)
            case ["answer"] if asked.method == "POST":
                return self._one(asked, rater)
            case [*_] if rater.state != "agreed":
                return _moved(base)
            case ["done"] if asked.method == "GET":
                return _page(pages.done(self.survey, base, len(self._left_out(rater))))
            case ["mine"] if asked.method == "GET":
                return _page(
                    pages.mine(self.survey, base, self.store.answers_of(rater), rater.agreed_on or "")
                )
            case ["withdraw"] if asked.method == "POST":
                return self._withdraw(asked, rater, base)
            case [number] if re.fullmatch("[1-9][0-9]{0,3}", number, re.ASCII):
                return self._numbered(asked, rater, base, int(number))
        return self._notice(404, "Not found", UNKNOWN)

    def _door(self, asked: Asked, rater: Rater, base: str) -> Told:
        """Consent; for one who agreed, the first page that is not finished."""
        if rater.state == "invited":
            if asked.method == "GET":
                return _page(pages.consent(self.survey, base))
            if _fields(asked).get("agree") != "yes":
                return _moved(base)
            self.store.agree(rater)
            return _moved(f"{base}/1")
        given = self.store.answers_of(rater)
        own = self._pages(rater)
        open_ = [number for number, page in enumerate(own, 1) if _missing(page, given)]
        last = open_[0] if open_ else len(own)
        return _moved(f"{base}/{last}")

    def _numbered(self, asked: Asked, rater: Rater, base: str, number: int) -> Told:
        own = self._pages(rater)
        if number > len(own):
            return self._notice(404, "Not found", UNKNOWN)
        if asked.method == "GET":
            return _page(pages.questionnaire(self.survey, own, number, base, self.store.answers_of(rater)))
        if asked.kind != FORM:
            return self._notice(415, "Not taken", "Answers come as a form; files are not taken.")
        page, fields = own[number - 1], _fields(asked)
        answers = {q.id: clean(fields[q.id]) for q in page.questions if q.id in fields}
        by_id = self.survey.questions
        if any(not by_id[id_].takes(value) for id_, value in answers.items()):
            return self._notice(
                422, "Not saved", "One answer is none of those offered, or too long; go back and mend it."
            )
        if not self.store.save(rater, answers):
            return _page(pages.withdrawn(self.survey), 410)
        given = self.store.answers_of(rater)
        go, missing = fields.get("go", "next"), _missing(page, given)
        if go == "back":
            return _moved(f"{base}/{max(1, number - 1)}")
        if missing and go != "skip":
            return _page(pages.questionnaire(self.survey, own, number, base, given, missing), 200)
        return _moved(f"{base}/{number + 1}" if number < len(own) else f"{base}/done")

    def _one(self, asked: Asked, rater: Rater) -> Told:
        """One answer as JSON; the reply says so only after it is on the disk."""
        if asked.kind != JSON:
            return _said(415, error="an answer comes as application/json")
        try:
            data = json.loads(asked.body)
        except (ValueError, RecursionError):
            return _said(400, error="this is not JSON")
        match data:
            case {"question": str(id_), "value": str(value)} if len(data) == 2:
                question, value = self.survey.questions.get(id_), clean(value)
            case _:
                return _said(400, error="an answer has a question and a value")
        if question is None:
            return _said(422, error="there is no such question")
        if not question.takes(value):
            return _said(422, error="it is none of the answers offered, or too long")
        if not self.store.save(rater, {id_: value}):
            return _said(403, error="please agree to take part first")
        return _said(200, saved=id_)

    def _withdraw(self, asked: Asked, rater: Rater, base: str) -> Told:
        if _fields(asked).get("sure") != "yes":
            return _moved(f"{base}/mine")
        self.store.withdraw(rater)
        return _page(pages.withdrawn(self.survey))

    def _medium(self, name: str) -> Told:
        """A file of the survey: the name must be one of those that the survey lists."""
        medium = self.survey.media.get(name)
        if medium is None:
            return self._notice(404, "Not found", UNKNOWN)
        path = self.folder / MEDIA / medium.name
        return Told(200, kind=TYPES[medium.kind], file=path, is_frame=medium.kind == "view")

    def _left_out(self, rater: Rater) -> list[str]:
        given = self.store.answers_of(rater)
        return [id_ for page in self.survey.pages for id_ in _missing(page, given)]

    def _pages(self, rater: Rater) -> Sequence[Page]:
        return pages_for(self.survey, rater.digest)

    def _notice(self, status: int, head: str, text: str, headers: Mapping[str, str] | None = None) -> Told:
        return Told(status, pages.notice(self.survey, head, text).encode(), headers=headers or {})


def _missing(page: Page, given: Mapping[str, str]) -> list[str]:
    return [question.id for question in page.questions if question.is_needed and question.id not in given]


def _is_same(given: str, token: str) -> bool:
    """Compared in a time that does not tell how much of it is right."""
    return hmac.compare_digest(given.encode("utf-8", "replace"), token.encode())


def _page(text: str, status: int = 200) -> Told:
    return Told(status, text.encode("utf-8", "replace"))


def _moved(to: str) -> Told:
    return Told(303, headers={"Location": to})


def _said(status: int, **data: str) -> Told:
    return Told(status, json.dumps(data).encode(), JSON)


def _fields(asked: Asked) -> dict[str, str]:
    """The fields of a form, the last of each name; none where it is no form."""
    if asked.kind != FORM:
        return {}
    try:
        return dict(
            parse_qsl(
                asked.body.decode("ascii", "replace"), keep_blank_values=True, max_num_fields=MOST_FIELDS
            )
        )
    except ValueError:
        return {}
