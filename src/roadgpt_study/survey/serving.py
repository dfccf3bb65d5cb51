"""Opens a survey to its raters: makes the links, and runs the server until Ctrl-C."""

import ipaddress
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.errors import RoadGPTError, UsageError, explained, to_install
from roadgpt.reading import read_text
from roadgpt.run.atomic import write_whole
from roadgpt_study.survey.store import ANSWERS, MOST_RATERS, AnswerStore, new_token
from roadgpt_study.survey.survey import read_survey

if TYPE_CHECKING:
    from roadgpt_study.survey.server import Server

LINKS = "links.txt"
OPEN_DOOR = (
    "anyone who can reach this machine can open the survey, and answers travel unencrypted; put an HTTPS "
    "server in front of it and give its address with --url"
)
NEEDS = "serving a survey needs Starlette, uvicorn and Jinja2"
Tell = Callable[[str], None]


def open_server(folder: Path | str, host: str, port: int, is_open: bool = False) -> "Server":
    """Returns a server that listens, on a free port if ``port`` is 0. If ``is_open``, anyone may join by a
    shared link."""
    try:
        from roadgpt_study.survey.app import SurveyApp
        from roadgpt_study.survey.server import Server
    except ImportError as error:
        raise UsageError(f"{NEEDS}; run {to_install('survey')}") from error
    folder = Path(folder).resolve()
    survey = read_survey(folder)
    store = AnswerStore(folder / ANSWERS)
    try:
        return Server(SurveyApp(folder, survey, store, store.shared() if is_open else ""), host, port)
    except BaseException:
        store.close()
        raise


def serve(
    folder: Path | str,
    tell: Tell,
    host: str = "127.0.0.1",
    port: int = 0,
    raters: int = 0,
    is_open: bool = False,
    url: str = "",
) -> None:
    """Serves a survey until Ctrl-C. First it tells the raters' links, and writes them into ``links.txt``:
    ``raters`` of them, including those of earlier. ``url`` is the address at which raters reach the server;
    empty: host and port."""
    server = open_server(folder, host, port, is_open)
    store = server.app.store
    try:
        base = url.rstrip("/") or f"http://{_shown(host)}:{server.port}"
        if not _is_own(host):
            tell(f"roadgpt: {OPEN_DOOR}")
        for line in _invited(Path(folder), store, raters, base):
            tell(line)
        if is_open:
            tell(f"shared link: {base}/join/{server.app.shared}")
        if not store.links() and not is_open:
            tell("nobody has been invited yet; give --raters N for N links, or --open for one shared link")
        tell(f"serving {server.app.survey.title!r} at {base}; stop it with Ctrl-C")
        server.serve_forever()
    finally:
        server.close()
        states = [rater.state for rater in store.raters()]
        store.close()
        tell(f"{states.count('agreed')} of {len(states)} raters agreed so far; all answers are in {folder}")


def _invited(folder: Path, store: AnswerStore, wanted: int, base: str) -> list[str]:
    """Writes the links of all raters, including those of new raters, and returns the lines that show them."""
    path = folder / LINKS
    tokens = re.findall(r"/r/([\w-]+)\s*$", read_text(path), re.M) if path.is_file() else []
    tokens = [token for token in tokens if store.rater_of(token) is not None]
    there = store.links()
    if wanted > MOST_RATERS:
        raise UsageError(f"{wanted} raters are too many; a survey takes at most {MOST_RATERS:,}")
    new = [new_token() for _ in range(wanted - there)]
    tokens += new
    if not tokens and not there:
        return []
    if not tokens:
        return [f"{there} links were made earlier, but {path}, which listed them, is missing"]
    links = [f"{base}/r/{token}" for token in tokens]
    with explained(RoadGPTError, f"cannot write {path}", "make room there"):
        write_whole(path, "\n".join(links) + "\n", is_private=True)
    for token in new:  # last: a link without a rater is replaced later, but a rater without a link is lost
        store.add_rater(token=token)
    return [*links, f"one link for each rater; {path} lists them, too"]


def _is_own(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _shown(host: str) -> str:
    return f"[{host}]" if ":" in host else host
