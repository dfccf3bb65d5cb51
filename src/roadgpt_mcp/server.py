"""The server that agents see: its tools are rows of ``tools.toml``, and a process does the work of a call."""

import base64
import csv
import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator
from jsonschema.exceptions import best_match
from mcp import types
from mcp.server import Server, ServerRequestContext

from roadgpt import __version__, plugins
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.reading import read_text
from roadgpt_mcp.knowledge import topics
from roadgpt_mcp.work import Workshop, rows_in

TABLE = tomllib.loads(read_text(Path(__file__).with_name("tools.toml")))
OPTIONS = {name: row.pop("option", "") for name, row in TABLE["arguments"].items()}
MOST_RUNS, MOST_PICTURES = 200, 2  # in an answer
PAGE, VIEW, OURS = "page", ("moments.png", "birds_eye.png"), ("exports", "pictures")
Given = Mapping[str, Any]
Context = ServerRequestContext[Any, Any]
Answer = tuple[dict[str, Any], list[Path]]


def _schema(fields: Given, names: list[str], needs: list[str]) -> dict[str, Any]:
    of = {name: fields[name] for name in names}
    return {"type": "object", "properties": of, "required": needs, "additionalProperties": False}


class ToolServer:
    """The tools, and the folder of runs that they share; it is made."""

    def __init__(self, shop: Workshop) -> None:
        self._shop = shop
        shop.home.mkdir(parents=True, exist_ok=True)
        TABLE["arguments"]["tests"]["maximum"] = shop.tests
        TABLE["arguments"]["formats"]["items"] = {"enum": [*plugins.names("exporters"), PAGE]}
        self._tools = {
            name: types.Tool(
                name=name, description=row["says"], output_schema=_schema(TABLE["fields"], row["tells"], []),
                input_schema=_schema(TABLE["arguments"], row["takes"], row.get("needs", [])),
                annotations=types.ToolAnnotations(read_only_hint="looks" in row),
            )
            for name, row in TABLE["tools"].items()
        }  # fmt: skip
        calls: dict[str, Any] = {"on_list_tools": self._listed, "on_call_tool": self._call}
        self.server = Server("roadgpt", version=__version__, instructions=TABLE["instructions"], **calls)

    async def _listed(self, *_: object) -> types.ListToolsResult:
        return types.ListToolsResult(tools=[*self._tools.values()])

    async def _call(self, ctx: Context, params: types.CallToolRequestParams) -> types.CallToolResult:
        """Answers a call, as data and as text, with pictures; an error is one sentence."""
        try:
            told, pictures = await self._answer(ctx, params.name, params.arguments or {})
        except RoadGPTError as error:
            return types.CallToolResult(content=[types.TextContent(text=str(error))], is_error=True)
        content: list[types.ContentBlock] = [types.TextContent(text=json.dumps(told, ensure_ascii=False))]
        for path in pictures[:MOST_PICTURES]:
            data = base64.b64encode(path.read_bytes()).decode()
            content.append(types.ImageContent(data=data, mime_type="image/png"))
        return types.CallToolResult(content=content, structured_content=told)

    async def _answer(self, ctx: Context, name: str, asked: Given) -> Answer:
        if name not in self._tools:
            raise UsageError(f"there is no tool {name[:40]!r}; there are {', '.join(self._tools)}")
        takes, row = self._tools[name].input_schema, TABLE["tools"][name]
        if mistake := best_match(Draft202012Validator(takes).iter_errors(asked)):
            said = ": ".join((*map(str, mistake.path), mistake.message[-300:]))
            raise UsageError(f"this cannot be: {said}; {mistake.schema.get('description', row['says'])}")
        given = {key: its["default"] for key, its in takes["properties"].items() if "default" in its}
        given |= asked
        place = self._shop.place(given["run"]) if "run" in given else self._shop.home
        given["words"] = [*self._options(given), *_said(given, place, row)]
        if "command" not in row:
            return await getattr(self, f"_{name}")(given)  # type: ignore[no-any-return]
        given["folder"] = self._shop.new(row["makes"]) if "makes" in row else place
        given["workers"] = self._shop.workers

        async def tell(lines: list[str]) -> None:
            last = {"done": len(lines), "total": given.get("tests"), **(rows_in(lines) or [{}])[-1]}
            await ctx.session.report_progress(last["done"], last["total"])

        command = [each.format_map(given) for each in row["command"]]
        try:
            told, notes = await self._shop.done([*command, *given["words"]], tell)
        finally:
            if "makes" in row and not any(given["folder"].iterdir()):
                given["folder"].rmdir()
        return await self._told(name, given, rows_in(told), notes)

    def _options(self, given: Given) -> list[str]:
        """Returns the options of the command line for the arguments that have one."""
        words = [f"--{given['which']}"] if "which" in given else []
        for name, value in given.items():
            if OPTIONS[name] and value is not False:
                said = self._shop.driver(value) if name == "driver" else f"{value}"
                words += [OPTIONS[name], *([] if value is True else [said])]
        return words

    async def _told(self, name: str, given: Given, rows: list[dict[str, Any]], notes: list[str]) -> Answer:
        """Returns the answer of a tool whose process printed rows, and its pictures."""
        folder, files = given["folder"], self._shop.found
        for row in rows:
            if "file" in row:
                row["test"] = re.sub(r"/(?:test\.|runs/)0*(\d+)(?:\.json)?$", r"/\1", row.pop("file"))
        match name:
            case "run" | "change":
                notes = [*(rows[0].get("changes", ()) if rows else ()), *notes]
                seen = files(folder / "runs" / "0001", *VIEW)
                return {"name": folder.name, "tests": rows, "notes": notes}, seen
            case "campaign" | "resume":
                return {"name": folder.name, "state": rows[-1]}, []
            case "scenarios":
                short = [{"name": row["name"], "says": row["says"]} for row in rows]
                return {"rows": rows if "pattern" in given else short}, []
            case "faults":
                tables = map(read_text, files(folder, "faults/faults.csv"))  # none without a failure
                rows = [row for each in tables for row in csv.DictReader(each.splitlines())]
                return {"rows": rows}, files(folder, "faults/*/*.png")
            case "show" if "outcomes" not in rows[0]:
                seen = files(folder.parent / "runs" / folder.name.zfill(4), *VIEW)
                if len(rows) == 1 and not seen:
                    drawn = self._made("pictures", given["run"])
                    await self._shop.done(["view", "--format", "png", "--out", f"{drawn}", *given["words"]])
                    seen = files(drawn, "*/birds_eye.png")
                return {"tests": rows[: self._shop.tests]}, seen or files(folder, "*.png")
        return rows[0] if name == "check" else {"state": rows[0]}, []

    async def _language(self, given: Given) -> Answer:
        return {"text": topics().get(given["topic"]) or "\n".join(topics().values())}, []

    async def _runs(self, given: Given) -> Answer:
        there = (path for path in self._shop.home.iterdir() if path.is_dir() and path.name not in OURS)
        newest = sorted(there, key=lambda path: path.stat().st_mtime, reverse=True)
        return {"rows": [{"name": path.name} for path in newest[:MOST_RUNS]]}, []

    async def _export(self, given: Given) -> Answer:
        folder, formats = self._made("exports", given["run"]), [*dict.fromkeys(given["formats"])]
        if others := ",".join(each for each in formats if each != PAGE):
            await self._shop.done(["export", "-q", "--to", others, "--out", f"{folder}", *given["words"]])
        if PAGE in formats:
            await self._shop.done(["view", "-q", "--out", f"{folder / 'page.html'}", *given["words"]])
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        return {"files": [f"{path.relative_to(self._shop.home)}" for path in files]}, []

    def _made(self, kind: str, run: str) -> Path:
        folder = self._shop.inside(self._shop.home / kind / run.replace("/", "-"))
        folder.mkdir(parents=True, exist_ok=True)
        return folder


def _said(given: Given, place: Path, row: Given) -> list[str]:
    """Returns what stands behind the options: a run, and the plan or the words, of which there may be one."""
    plan, words = (given.get(each, "").strip() * ("words" in row["takes"]) for each in ("plan", "words"))
    is_open = "words" in row["takes"] and "scenario" not in given and not plan + words
    if is_open or (plan and words) or (plan or words).endswith(".toml"):
        raise UsageError("give a plan or words, one of them; neither ends with .toml")
    said = (f"{place}" if "run" in given else "", plan or words or given.get("pattern", ""))
    return [*(["--plan"] if plan else []), "--", *filter(None, said)]
