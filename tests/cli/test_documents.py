"""The documents run: examples are executed, the page of commands is current, links lead somewhere."""

import html
import importlib
import importlib.util
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

import roadgpt
from roadgpt import provenance
from roadgpt.brief.feasible import check
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.cli import app
from roadgpt.design.unbuilt import check_built
from roadgpt.network import build_route, network_of
from roadgpt.road import World, build, read_design

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page: str, language: str) -> list[str]:
    """The code in a page's fenced blocks of one language."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def test_the_page_of_commands_is_current() -> None:
    # in a process of its own: click keeps the help option with which a command was first asked
    script = "import runpy, sys; print(runpy.run_path(sys.argv[1])['page'](), end='')"
    command = [sys.executable, "-X", "utf8", "-c", script, str(ROOT / "docs" / "commands.py")]
    printed = subprocess.run(command, capture_output=True, encoding="utf-8", check=True).stdout
    assert (ROOT / "docs" / "reference" / "commands.md").read_text(encoding="utf-8") == printed, (
        "run: make docs"
    )


@pytest.mark.usefixtures("no_workers")
def test_the_workflow_for_continuous_integration_works_as_printed() -> None:
    page = "docs/how-to/continuous-integration.md"
    (workflow,), (prepared,) = blocks(page, "yaml"), blocks(page, "sh")
    steps = pytest.importorskip("yaml").safe_load(workflow)["jobs"]["drive"]["steps"]
    drive, campaign = [step["run"] for step in steps if step.get("run", "").startswith("roadgpt")]
    code, *_ = blocks("docs/how-to/own-driver.md", "python")

    def typed(line: str) -> Result:
        provenance.CODE.forget()
        line = re.sub(r"-n \d+", "-n 1", line.replace("${{ github.run_number }}", "17"))
        return CliRunner().invoke(app, shlex.split(line)[1:])

    Path("my_driver.py").write_text(code)
    for line in prepared.splitlines():
        assert not line.startswith("roadgpt") or typed(line).exit_code == 0, line
    passed = typed(drive)
    assert passed.exit_code == 0, passed.output
    assert "1 of 1 road compared with baseline\n" in passed.stdout
    shutil.rmtree("now")
    Path("my_driver.py").write_text(code.replace("30 / 3.6", "60 / 3.6"))
    failed = typed(drive)
    assert failed.exit_code == 6
    (told,) = [line for line in failed.stderr.splitlines() if "driven road" in line]
    for one, five in (("1 of 1 driven road", "5 of 5 driven roads"), ("1 road worse", "5 roads worse")):
        told = told.replace(one, five)
    assert f"\n{told}, ...\n" in (ROOT / page).read_text(encoding="utf-8")
    assert typed(campaign).exit_code == 0
    assert Path("roads.xml").is_file()
    assert Path("new.xml").is_file()


def test_the_rule_in_the_docs_objects_to_a_straight_road() -> None:
    from roadgpt.road import Road

    code, *_ = blocks("docs/how-to/add-a-part.md", "python")
    names: dict[str, object] = {}
    exec(compile(code, "add-a-part.md", "exec"), names)
    inspect = names["inspect"]
    assert callable(inspect)
    straight, bent = Road.through([[0, 0], [50, 0], [100, 0]]), Road.through([[0, 0], [30, 0], [45, 15]])
    for road, said in ((straight, ["not_boring"]), (bent, [])):
        network = network_of(road, World())
        assert [each.rule for each in inspect(network, road, None, World())] == said
        assert [each.rule for each in inspect(network, None, None, World())] == said


def test_the_design_in_the_docs_is_one() -> None:
    text, *_ = blocks("docs/reference/design-format.md", "json")
    design, remarks = read_design(json.loads(text))
    assert build(design).length == pytest.approx(40 + 35 + 30)
    assert remarks == ()


def test_the_design_with_junctions_in_the_docs_is_valid() -> None:
    design, remarks = read_design(json.loads(blocks("docs/reference/design-format.md", "json")[1]))
    assert remarks == ()
    route = build_route(design, World())
    assert [each.entered.kind for each in route.passages] == ["t_junction", "roundabout"]
    assert inspect(route, None, World()) == ()


def test_the_map_in_the_docs_is_valid() -> None:
    design, remarks = read_design(json.loads(blocks("docs/reference/design-format.md", "json")[-1]))
    assert remarks == ()
    route = build_route(design, World())
    assert [each.entered.kind for each in route.passages] == ["t_junction", "roundabout"]
    assert inspect(route, None, World()) == ()


def test_the_plans_on_the_page_of_junctions_are_plans() -> None:
    page = (ROOT / "docs" / "how-to" / "junctions.md").read_text(encoding="utf-8")
    cells = re.findall(r"^\| [^|]+ \| (.+) \|$", page, flags=re.MULTILINE)
    plans = [a or b for cell in cells for a, b in re.findall(r"`([^`]+)`|<code>(.+?)</code>", cell)]
    assert len(plans) > 20
    for plan in plans:
        brief = read_plan(html.unescape(plan))
        assert brief.junctions or brief.map is not None
        check(brief)
        check_built(brief)


def test_the_ranges_in_the_docs_are_those_of_the_options() -> None:
    text = (ROOT / "docs" / "reference" / "limits.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(-[\w-]+)`[^|]*\| (above )?([\d,]+) \| ([\d,]+) \|", text, flags=re.MULTILINE)
    run = app.get_command(click.Context(app), "run")
    assert run is not None
    assert len(rows) == 8

    def takes(option: str, value: int) -> bool:
        try:
            run.make_context(
                "run", ["a road", f"{option}", str(value)], click.Context(app, **app.context_settings)
            )
        except click.BadParameter:
            return False
        return True

    for option, above, *bounds in rows:
        low, high = (int(bound.replace(",", "")) for bound in bounds)
        assert [takes(option, value) for value in (low - 1, low, high, high + 1)] == [
            False, not above, True, False
        ], option  # fmt: skip


def test_the_columns_of_results_in_the_docs_are_those_of_the_table() -> None:
    from roadgpt.campaign.csv_tables import COLUMNS

    text = (ROOT / "docs" / "reference" / "campaign-folder.md").read_text(encoding="utf-8")
    (table,) = re.findall(r"^\| columns of `results.csv`.*?\n\n", text, flags=re.MULTILINE | re.DOTALL)
    named = re.findall(r"`(\w+)`", "".join(row.split("|")[1] for row in table.strip().splitlines()[2:]))
    assert sorted(named) == sorted(COLUMNS)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_pages_and_headings_that_exist(page: Path) -> None:
    for target, _, heading in re.findall(r"\]\(([^)#]*)(#([^)]*))?\)", page.read_text(encoding="utf-8")):
        there = page.parent / target if target else page
        if "://" not in target:
            assert there.exists(), target
            assert not heading or heading in anchors(there), f"{target}#{heading}"


def anchors(page: Path) -> set[str]:
    """The addresses of a page's headings, as GitHub and Python-Markdown make them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    heads = (re.sub(r"\]\([^)]*\)", "", head) for head in re.findall(r"^#+ +(.*)$", text, re.MULTILINE))
    return {re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", head.lower()).strip()) for head in heads}


def test_the_navigation_leads_to_every_page() -> None:
    docs = ROOT / "docs"
    listed = re.findall(r"[\w/-]+\.md", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    assert len(listed) == len(set(listed))
    pages = {str(page.relative_to(docs)) for page in PAGES if docs in page.parents}
    assert {page for page in pages if not page.startswith("decisions/0")} == set(listed)
    listed_there = (docs / "decisions" / "index.md").read_text(encoding="utf-8")
    records = [page for page in pages if page.startswith("decisions/0")]
    assert [page for page in records if Path(page).name not in listed_there] == []


def test_the_reference_of_python_holds_every_name_that_the_package_offers() -> None:
    text = (ROOT / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    paths = re.findall(r"^::: (roadgpt\S+)", text, flags=re.MULTILINE)
    named = {path.rpartition(".")[2] for path in paths}
    line = re.search(r"^Other names: (.+)$", text, flags=re.MULTILINE)
    others = dict(re.findall(r"`(\w+)` is `(\w+)`", line[1] if line else ""))
    assert set(roadgpt.__all__) - {"__version__"} <= named | others.keys()
    assert all(getattr(roadgpt, other) is getattr(roadgpt, name) for other, name in others.items())
    for path in paths:
        module, _, name = path.rpartition(".")
        assert getattr(importlib.import_module(module), name).__doc__, path


def test_the_python_in_the_readme_and_in_the_reference_runs(tmp_path: Path) -> None:
    (first,) = blocks("README.md", "python")
    codes = [first, *blocks("docs/reference/python.md", "python")]
    assert len(codes) > 1
    each = "import sys\nfor code in sys.argv[1:]:\n    exec(code, {'__name__': '__main__'})\n    print('END')"
    env = {**os.environ, "MPLBACKEND": "agg"}
    command = [sys.executable, "-c", each, *codes]
    done = subprocess.run(command, cwd=tmp_path, env=env, stdout=subprocess.PIPE, text=True, check=True)
    assert done.stdout.partition("END")[0].strip()
    assert (tmp_path / "two-roads.pdf").read_bytes().startswith(b"%PDF")


def test_every_command_line_in_the_docs_is_understood() -> None:
    """Its command exists, and so does each of its options."""
    lines = [
        line.split("#")[0].split(">")[0].strip()
        for page in PAGES
        for line in page.read_text(encoding="utf-8").splitlines()
        if re.match("roadgpt +[^ #]", line)
    ]
    assert len(lines) > 10
    for line in lines:
        words = line.removeprefix("roadgpt ").split()
        command, rest = app.get_command(click.Context(app), words[0]), words[1:]
        assert command is not None, line
        while isinstance(command, click.Group) and (rest or not command.invoke_without_command):
            command, rest = command.commands[rest[0]], rest[1:]
        known = {
            option
            for parameter in command.get_params(click.Context(command, **app.context_settings))
            for option in parameter.opts
        }
        assert {word for word in rest if re.match(r"--?[a-z]", word)} <= known, line
