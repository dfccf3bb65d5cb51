"""Handles the HTTP requests to one survey, as a Starlette application.

/static/NAME                                    the style sheet and the script
/join/SHARED                                    adds a rater who agrees to take part, if anyone may join
/r/TOKEN                                        consent, or the first page with an unanswered question
/r/TOKEN/N             GET, POST a form         page N of this rater
/r/TOKEN/answer        POST JSON                saves one answer and confirms it when it is on the disk
/r/TOKEN/media/NAME                             a picture, a film or a 3-D view
/r/TOKEN/done                                   thanks
/r/TOKEN/mine                                   lists everything that is stored about this rater
/r/TOKEN/withdraw      POST a form              deletes all of this rater's answers
"""

import hmac
import json
import re
import sqlite3
import sys
from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from http import HTTPStatus
from pathlib import Path
from urllib.parse import parse_qsl

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from roadgpt_study.survey.store import MOST_RATERS, AnswerStore, Rater
from roadgpt_study.survey.survey import MEDIA, MOST_LETTERS, TABLE, QuestionPage, Survey, clean

MOST_BYTES = 64 * 1024  # of a body: a page of remarks in any alphabet, many times over
MOST_ADDRESS = 2048  # bytes
OUR_PAGES = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; media-src 'self'; "
    "frame-src 'self'; connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
FRAMES = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'; sandbox allow-scripts"
)
"""Content security policy of a 3-D view. The page contains its scripts; it may neither fetch anything nor
reach the page around it."""
HEADERS = {
    "Server": "roadgpt",
    "Cache-Control": "no-store",
    "Content-Security-Policy": OUR_PAGES,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",  # the address is the rater's key
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=()",
    "X-Robots-Tag": "noindex, nofollow",
}
"""Headers of every response, unless the response sets them itself."""
ENVIRONMENT = Environment(
    loader=FileSystemLoader(Path(__file__).parent / "templates"),
    autoescape=True,  # every value, whatever its template is called
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
"""The templates; all of them can use ``texts`` and ``most_letters``."""
ENVIRONMENT.globals.update(texts=TABLE, most_letters=MOST_LETTERS)
STATIC = Path(__file__).parent / "static"
MEDIA_TYPES = {"picture": "image/png", "film": "video/mp4", "view": "text/html"}
JSON, FORM = "application/json", "application/x-www-form-urlencoded"
MOST_FIELDS = 100  # of a form
KEPT = {"Cache-Control": "private, max-age=3600"}
CLOSED = "This link is closed: its answers were deleted."
NOT_SAVED = "Your answer could not be saved. Please try again in a moment."
NOTICES: Mapping[str, list[str]] = TABLE["notices"]
Answer = Callable[[Request, bytes], Response]


def _in_thread(answer: Answer) -> Callable[[Request], Awaitable[Response]]:
    """Returns an endpoint that reads the body and answers in a worker thread, which may wait for the disk."""

    async def endpoint(request: Request) -> Response:
        return await run_in_threadpool(answer, request, await request.body())

    return endpoint


class SurveyApp:
    """Serves one survey; ``asgi`` is its ASGI application. Several threads may handle requests at the same
    time. ``shared`` is the token of the link with which anyone may join, or empty."""

    def __init__(self, folder: Path, survey: Survey, store: AnswerStore, shared: str = "") -> None:
        self.folder, self.survey, self.store, self.shared = folder, survey, store, shared

        def at(path: str, answer: Answer, *methods: str) -> Route:
            return Route(path, _in_thread(answer), methods=methods or ["GET"])

        own = "/r/{token}"
        routes = [
            Mount("/static", StaticFiles(directory=STATIC)),
            at("/join/{token}", self._join, "GET", "POST"),
            at(own, self._door, "GET", "POST"),
            at(f"{own}/", self._door, "GET", "POST"),
            at(f"{own}/media/{{name}}", self._medium),
            at(f"{own}/answer", self._save_one, "POST"),
            at(f"{own}/done", self._done),
            at(f"{own}/mine", self._mine),
            at(f"{own}/withdraw", self._withdraw, "POST"),
            at(f"{own}/{{number:int}}", self._numbered, "GET", "POST"),
        ]
        app = Starlette(
            routes=routes,
            exception_handlers={HTTPException: self._notice, sqlite3.Error: self._not_saved},  # type: ignore[dict-item]
        )
        app.router.redirect_slashes = False  # it would redirect to whatever host the request names
        self.asgi = RequestGuard(app)

    def _join(self, request: Request, body: bytes) -> Response:
        token = request.path_params["token"].encode("utf-8", "replace")
        if not self.shared or not hmac.compare_digest(token, self.shared.encode()):
            raise HTTPException(404)
        here = f"/join/{self.shared}"
        if request.method != "POST":
            return self._page("consent.html", action=here, is_joining=True)
        if _fields(request, body).get("agree") != "yes":
            return RedirectResponse(here, 303)
        if len(self.store.raters()) >= MOST_RATERS:
            raise HTTPException(503)
        own = self.store.add_rater(joined=True)
        rater = self.store.rater_of(own)
        assert rater is not None
        self.store.agree(rater)
        return RedirectResponse(f"/r/{own}/1", 303)

    def _rater(self, request: Request, has_agreed: bool = True) -> tuple[Rater, str]:
        """Returns the rater of a link and the link's path; otherwise, and if ``has_agreed`` is true and the
        rater has not agreed yet, raises HTTPException."""
        token = request.path_params["token"]
        rater = self.store.rater_of(token)
        if rater is None:
            raise HTTPException(404)
        if rater.state == "withdrawn":
            raise HTTPException(410, CLOSED)
        if has_agreed and rater.state != "agreed":
            raise HTTPException(303, headers={"Location": f"/r/{token}"})
        return rater, f"/r/{token}"

    def _door(self, request: Request, body: bytes) -> Response:
        """Shows the consent page, or redirects a rater who agreed to the first unfinished page."""
        rater, base = self._rater(request, has_agreed=False)
        if rater.state == "invited":
            if request.method != "POST":
                return self._page("consent.html", action=base, is_joining=False)
            if _fields(request, body).get("agree") != "yes":
                return RedirectResponse(base, 303)
            self.store.agree(rater)
            return RedirectResponse(f"{base}/1", 303)
        given, own = self.store.answers_of(rater), self.survey.pages_for(rater.digest)
        unfinished = [number for number, page in enumerate(own, 1) if _missing(page, given)]
        return RedirectResponse(f"{base}/{unfinished[0] if unfinished else len(own)}", 303)

    def _medium(self, request: Request, _: bytes) -> Response:
        self._rater(request, has_agreed=False)
        medium = self.survey.media.get(request.path_params["name"])
        if medium is None or not (path := self.folder / MEDIA / medium.name).is_file():
            raise HTTPException(404)
        policy = {"Content-Security-Policy": FRAMES} if medium.kind == "view" else {}
        return FileResponse(path, headers=KEPT | policy, media_type=MEDIA_TYPES[medium.kind])

    def _save_one(self, request: Request, body: bytes) -> Response:
        """Saves one answer that was sent as JSON; it is confirmed after it is on the disk."""
        rater, _ = self._rater(request, has_agreed=False)
        if _kind(request) != JSON:
            raise HTTPException(415, "send the answer as application/json")
        try:
            data = json.loads(body)
        except (ValueError, RecursionError) as error:
            raise HTTPException(400, "this is not JSON") from error
        match data:
            case {"question": str(id_), "value": str(value)} if len(data) == 2:
                question, value = self.survey.questions.get(id_), clean(value)
            case _:
                raise HTTPException(400, "an answer has a question and a value")
        if question is None:
            raise HTTPException(422, "there is no such question")
        if not question.takes(value):
            raise HTTPException(422, "it is too long or not one of the answers offered")
        if not self.store.save(rater, {id_: value}):
            raise HTTPException(403, "please agree to take part first")
        return JSONResponse({"saved": id_})

    def _numbered(self, request: Request, body: bytes) -> Response:
        rater, base = self._rater(request)
        own, number = self.survey.pages_for(rater.digest), int(request.path_params["number"])
        if not 1 <= number <= len(own):
            raise HTTPException(404)
        page, total = own[number - 1], len(own)

        show = partial(self._page, "questionnaire.html", page=page, number=number, total=total, base=base)
        if request.method != "POST":
            return show(given=self.store.answers_of(rater), missing=())
        if _kind(request) != FORM:
            raise HTTPException(415)
        fields = _fields(request, body)
        answers = {q.id: clean(fields[q.id]) for q in page.questions if q.id in fields}
        if not all(q.takes(answers.get(q.id, "")) for q in page.questions):
            raise HTTPException(422)
        if not self.store.save(rater, answers):
            raise HTTPException(410, CLOSED)
        given = self.store.answers_of(rater)
        go, missing = fields.get("go", "next"), _missing(page, given)
        if go == "back":
            return RedirectResponse(f"{base}/{max(1, number - 1)}", 303)
        if missing and go != "skip":
            return show(given=given, missing=missing)
        return RedirectResponse(f"{base}/{number + 1}" if number < total else f"{base}/done", 303)

    def _done(self, request: Request, _: bytes) -> Response:
        rater, base = self._rater(request)
        given = self.store.answers_of(rater)
        left_out = sum(len(_missing(page, given)) for page in self.survey.pages)
        return self._page("done.html", base=base, left_out=left_out)

    def _mine(self, request: Request, _: bytes) -> Response:
        rater, base = self._rater(request)
        given = self.store.answers_of(rater)
        return self._page("mine.html", base=base, given=given, agreed_on=rater.agreed_on or "")

    def _withdraw(self, request: Request, body: bytes) -> Response:
        rater, base = self._rater(request)
        if _fields(request, body).get("sure") != "yes":
            return RedirectResponse(f"{base}/mine", 303)
        self.store.withdraw(rater)
        return self._page("deleted.html")

    def _page(self, template: str, status: int = 200, **values: object) -> Response:
        return HTMLResponse(ENVIRONMENT.get_template(template).render(survey=self.survey, **values), status)

    def _notice(self, request: Request, error: HTTPException) -> Response:
        """Returns a page, or JSON for the script, that says why a request was refused."""
        status, headers = error.status_code, error.headers
        if status == 303:
            return Response(status_code=status, headers=headers)
        if request.scope["path"].endswith("/answer"):
            return JSONResponse({"error": error.detail}, status, headers)
        if status == 410:
            return self._page("deleted.html", 410 if request.method == "POST" else 200)
        heading, sentence = NOTICES.get(str(status), (error.detail, error.detail))
        page = self._page("notice.html", status, heading=heading, sentence=sentence)
        page.headers.update(headers or {})
        return page

    def _not_saved(self, request: Request, error: sqlite3.Error) -> Response:
        sys.stderr.write(f"roadgpt: an answer could not be saved ({error})\n")
        return refusal(request.scope["path"], 503, NOT_SAVED)


def _missing(page: QuestionPage, given: Mapping[str, str]) -> list[str]:
    return [question.id for question in page.questions if question.is_needed and question.id not in given]


def _kind(request: Request) -> str:
    """Returns the content type of the body, without parameters."""
    return request.headers.get("content-type", "").split(";")[0].strip().lower()


def _fields(request: Request, body: bytes) -> dict[str, str]:
    """Returns the fields of a form; the last field of a name counts. Empty if the body is not a form."""
    if _kind(request) != FORM:
        return {}
    try:
        text = body.decode("ascii", "replace")
        return dict(parse_qsl(text, keep_blank_values=True, max_num_fields=MOST_FIELDS))
    except ValueError:
        return {}


class RequestGuard:
    """ASGI middleware that refuses requests beyond the limits, adds ``HEADERS`` and reports errors."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers one request."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        status = _refused_with(scope)
        app = refusal(scope["path"], status) if status else self.app
        try:
            await app(scope, receive, send_with_headers)
        except ClientDisconnect:
            pass  # the rater went away; nobody is there to be answered
        except Exception as error:  # Starlette has answered with status 500 by now
            sys.stderr.write(f"roadgpt: a request could not be answered ({error!r})\n")


def _refused_with(scope: Scope) -> int:
    """Returns the status with which a request is refused; 0 if it is within the limits."""
    if len(scope["raw_path"]) + len(scope["query_string"]) > MOST_ADDRESS:
        return 414
    if scope["method"] == "POST":
        headers = Headers(scope=scope)
        length = headers.get("content-length", "")
        if "transfer-encoding" in headers or not re.fullmatch("[0-9]{1,20}", length, re.ASCII):
            return 411
        if int(length) > MOST_BYTES:
            return 413
    return 0


def refusal(path: str, status: int, sentence: str = "") -> Response:
    """Returns a response that consists of one sentence, by default the standard phrase of the HTTP status,
    and closes the connection. The sentence must not quote the request. Requests to ``/answer`` come from the
    pages' script and are answered in JSON."""
    sentence = sentence or f"{HTTPStatus(status).phrase}."
    if path.endswith("/answer"):
        content, kind = json.dumps({"error": sentence}), "application/json"
    else:
        content, kind = sentence, "text/plain"
    return Response(content, status, {"Connection": "close"}, media_type=kind)
