"""Folders of runs: their names, and the folder of one Run, which is written completely or not at all and read
back as an equal Run.

campaign/
  campaign.sqlite          which tests have ended, and how, see ``campaign.record``
  test.0001.json           the test as the SBFT competition writes it
  runs/0001/
    brief.json design.json road.json drive.npz verdict.json    the Run's values, each in its own format
    run.json               outcome, findings, seed, versions, and the full request
    seconds.json           wall-clock times. When a Run is repeated, only these times differ (if a
                           language model was used, also the times in run.json)
    error.txt              the traceback, if a simulator or driver failed
    *.png                  the pictures
"""

import re
import shutil
import unicodedata
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Protocol

from pydantic import ConfigDict, Field, ValidationError

from roadgpt.brief import remarks
from roadgpt.brief.model import Brief
from roadgpt.chat import Spent
from roadgpt.check import Finding
from roadgpt.design import DesignReport
from roadgpt.drive import Drive
from roadgpt.errors import UsageError, explained
from roadgpt.ground.given import BESIDE, GivenGround
from roadgpt.network import road_from_json
from roadgpt.reading import LARGEST, read_json, read_text, strictly
from roadgpt.road import World, read_design
from roadgpt.run.atomic import json_text, refuse_links, to_bytes, whole_folder, write_whole
from roadgpt.run.execution import test_name, test_text
from roadgpt.run.model import Outcome, Request, Run, Seconds
from roadgpt.verdict import Verdict

HOME = Path("roadgpt-runs")
LONGEST = 40  # letters of a description


def slug(words: str) -> str:
    """Returns a description as a path component: only a-z, 0-9 and '-', at most 40 characters; "road" if
    no character is left."""
    plain = unicodedata.normalize("NFKD", words[:1000].casefold()).encode("ascii", "ignore").decode()
    return re.sub(r"[^a-z0-9]+", "-", plain.lower()).strip("-")[:LONGEST].strip("-") or "road"


def new_folder(words: str, seed: int, home: Path = HOME) -> Path:
    """Creates a new folder named after the description and the seed; and a number, if the name is taken."""
    name, number = f"{slug(words)}-{seed}", 1
    with explained(UsageError, f"cannot make a folder in {home}", "say --out FOLDER"):
        home.mkdir(parents=True, exist_ok=True)
        while True:
            folder = home / (name if number == 1 else f"{name}-{number}")
            try:
                folder.mkdir()
            except FileExistsError:
                number += 1
            else:
                return folder


def reject_used(out: Path | None) -> None:
    """Raises UsageError if ``out`` is a folder that is not empty."""
    if out is not None and out.is_dir() and any(out.iterdir()):
        raise UsageError(f"{out} is not empty; name another folder")


EDIT_CARD = "edit.json"
FORMAT = 1
RUNS = "runs"


class Draw(Protocol):
    """Draws pictures and saves them in folders of runs; ``report.Drawing`` does it."""

    def of_run(self, run: Run, folder: Path) -> object:
        """Draws the pictures of a Run and saves them in its folder."""
        ...

    def of_campaign(self, folder: Path) -> object:
        """Draws a picture of all roads of a campaign and saves it in the campaign's folder."""
        ...


def run_folder(campaign: Path, index: int) -> Path:
    """Returns the path of the folder of road ``index`` of a campaign."""
    return campaign / RUNS / f"{index:04d}"


def write_run(run: Run, campaign: Path, draw: Draw | None = None) -> Path:
    """Writes a Run into a campaign's folder, its test file last; returns the Run's own folder."""
    folder = write_run_folder(run, campaign, draw)
    keep_ground(run.world, campaign, folder)
    write_whole(campaign / test_name(run.index), test_text(run))
    return folder


def write_run_folder(run: Run, campaign: Path, draw: Draw | None = None) -> Path:
    """Writes the Run's own folder and returns it. The Run is not finished until the test file exists."""
    folder = run_folder(campaign, run.index)
    refuse_links(campaign / RUNS, folder)
    with whole_folder(folder) as draft:
        for name, content in _files(run):
            (draft / name).write_bytes(content)
        if draw is not None:
            draw.of_run(run, draft)
    return folder


def keep_ground(world: World, folder: Path, own: Path | None = None) -> None:
    """Writes the heights of given land into a folder of runs, if they are not there; where other land is,
    into the run's ``own`` folder."""
    given = world.site.ground
    if not isinstance(given, GivenGround):
        return
    from roadgpt.ground.files import attached, save_ground

    if (folder / BESIDE).is_file():
        try:
            attached(str(given), folder)
            return
        except UsageError:
            folder = folder if own is None else own
    write_whole(folder / BESIDE, save_ground(given))


def remove_run(index: int, campaign: Path) -> None:
    """Removes a Run, if it is there: the test file first, from when on the Run counts as unfinished."""
    (campaign / test_name(index)).unlink(missing_ok=True)
    shutil.rmtree(run_folder(campaign, index), ignore_errors=True)


def _files(run: Run) -> list[tuple[str, bytes]]:
    texts = {
        "brief.json": run.brief and run.brief.model_dump(mode="json", exclude_defaults=True),
        "design.json": run.design and run.design.to_json(),
        "road.json": run.road and run.road.to_json(),
        "verdict.json": run.verdict and run.verdict.to_json(),
        "run.json": _card(run),
        "seconds.json": asdict(run.seconds),
    }
    files = [(name, to_bytes(json_text(data))) for name, data in texts.items() if data is not None]
    if run.trace:
        files.append(("error.txt", to_bytes(run.trace)))
    if run.drive is not None:
        files.append(("drive.npz", run.drive.to_bytes()))
    return files


def _card(run: Run) -> dict[str, Any]:
    asked = {"designing": run.designing, "spent": run.spent}
    site = run.world.site
    noted = remarks(run.brief, site.map_size, site.friction, run.world.scene.surfaces) if run.brief else ()
    return {
        "format": FORMAT,
        "index": run.index,
        "seed": run.seed,
        "outcome": run.outcome,
        "description": run.description,
        "findings": [asdict(finding) for finding in run.findings],
        "rounds": run.rounds,
        **({"remarks": list(noted)} if noted else {}),
        "request": run.request.model_dump(mode="json"),
        "versions": dict(run.versions),
        **{name: value.model_dump(mode="json") for name, value in asked.items() if value is not None},
    }


def finished(campaign: Path) -> list[int]:
    """Returns the numbers of the Runs whose files are complete in a folder of runs, in ascending order."""
    numbers = (path.name.split(".")[1] for path in campaign.glob("test.*.json"))
    indices = sorted({int(number) for number in numbers if number.isdecimal()})
    return [index for index in indices if is_finished(campaign, index)]


def is_finished(campaign: Path, index: int) -> bool:
    """Returns whether the files of a Run are complete in a folder of runs."""
    return (campaign / test_name(index)).is_file() and is_run(run_folder(campaign, index))


def is_run(path: Path) -> bool:
    """Returns whether a folder holds a Run."""
    return (path / "run.json").is_file()


def read_run(path: Path | str) -> Run:
    """Reads the Run in a folder.

    Args:
        path: the Run's own folder, a file in this folder, or the Run's ``test.NNNN.json``.

    Raises:
        UsageError: there is no Run, one of its files cannot be read, or another version of RoadGPT wrote it.
    """
    folder = _folder_of(Path(path))
    card = _loaded(folder / "run.json")
    if not isinstance(card, dict) or card.get("format") != FORMAT:
        raise UsageError(f"{folder} was written by another version of roadgpt; make the road again")

    def value(name: str) -> Any:
        return _loaded(folder / name) if (folder / name).is_file() else None

    try:
        brief, design, road, verdict = (value(f"{n}.json") for n in ("brief", "design", "road", "verdict"))
        trace = folder / "error.txt"
        return Run(
            **vars(strictly(_Card, card)),
            request=Request.model_validate(card["request"]).came_with(folder / "run.json"),
            brief=None if brief is None else Brief.model_validate(brief),
            design=None if design is None else read_design(design)[0],
            road=None if road is None else road_from_json(road),
            drive=Drive.load(folder / "drive.npz") if (folder / "drive.npz").is_file() else None,
            verdict=None if verdict is None else Verdict.from_json(verdict),
            designing=DesignReport.model_validate(card["designing"]) if "designing" in card else None,
            spent=Spent.model_validate(card["spent"]) if "spent" in card else None,
            source=_change(value(EDIT_CARD)),
            trace=read_text(trace, LARGEST, "a file of a run") if trace.is_file() else "",
            seconds=strictly(Seconds, value("seconds.json") or {}),
        )
    except (KeyError, TypeError, ValueError, ValidationError) as error:
        raise UsageError(f"the run in {folder} cannot be read ({error!r}); make the road again") from error


def run_of_test(path: Path) -> Path | None:
    """Returns the folder of the run that a campaign's test.NNNN.json belongs to; None for any other file."""
    parts = path.name.split(".")
    beside = path.parent / RUNS / parts[1] if len(parts) == 3 and parts[0] == "test" else path
    return beside if path.is_file() and is_run(beside) else None


def _folder_of(path: Path) -> Path:
    if path.is_file():
        beside = run_of_test(path) or path.parent
        if not is_run(beside):
            raise UsageError(
                f"{path} belongs to no run; give a folder like DIR/runs/0001 or DIR/test.0001.json"
            )
        path = beside
    if is_run(path):
        return path
    if (path / RUNS).is_dir():
        raise UsageError(f"{path} holds many runs; give one of the folders in {path / RUNS}")
    raise UsageError(f"there is no run in {path}; give a folder like DIR/runs/0001")


def _change(card: Any) -> str:
    words = card.get("request") if isinstance(card, dict) else None
    return words if isinstance(words, str) else ""


@dataclass(frozen=True)
class _Card:
    """Fields of a Run in ``run.json``; its request and its reports have models of their own."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="ignore", allow_inf_nan=False)

    index: Annotated[int, Field(ge=0, lt=2**63)]
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    outcome: Outcome
    description: str
    findings: tuple[Finding, ...]
    rounds: int
    versions: dict[str, str]


def _loaded(path: Path) -> Any:
    try:
        return read_json(path, LARGEST, "a file of a run")
    except (OSError, ValueError) as error:
        raise UsageError(f"{path} cannot be read ({error}); make the road again") from error
