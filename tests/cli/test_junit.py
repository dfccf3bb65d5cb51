"""JUnit XML as its common format is documented, checked by a validator that knows nothing of who wrote it."""

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from command_line import roadgpt
from roadgpt.cli import app
from roadgpt.cli.junit import write_junit
from roadgpt.cli.screen import Row
from roadgpt.errors import RoadGPTError

# github.com/testmoapp/junitxml: attributes of each element, and which may stand in which.
NUMBERS = {"tests", "failures", "errors", "skipped", "assertions", "time"}
ALLOWED = {
    "testsuites": {"name", "timestamp", *NUMBERS},
    "testsuite": {"name", "timestamp", "file", *NUMBERS},
    "testcase": {"name", "classname", "assertions", "time", "file", "line"},
    "properties": set(),
    "property": {"name", "value"},
    "skipped": {"message"},
    "failure": {"message", "type"},
    "error": {"message", "type"},
}
INSIDE = {
    "testsuites": ["testsuite"],
    "testsuite": ["properties", "testcase"],
    "testcase": ["properties", "skipped", "failure", "error"],
    "properties": ["property"],
}
ROAD = [[60, 100], [100, 100], [140, 100]]
OUTSIDE = [[-20, 100], [100, 100], [140, 100]]


def checked(path: Path) -> ET.Element:
    """The document, where it is of this format; its counts are counted again."""
    root = ET.fromstring(path.read_bytes())
    assert root.tag == "testsuites"
    for element in root.iter():
        assert {*element.attrib} <= ALLOWED[element.tag], element.tag
        order = [INSIDE.get(element.tag, []).index(child.tag) for child in element]
        assert order == sorted(order), f"children of {element.tag}"
        if element.tag == "testcase":
            assert len([child for child in element if child.tag != "properties"]) <= 1
            assert element.get("name")
            assert element.get("classname")
        if element.tag in ("testsuites", "testsuite"):
            cases = [*element.iter("testcase")]
            counts = {name: len([*element.iter(tag)]) for name, tag in
                      (("failures", "failure"), ("errors", "error"), ("skipped", "skipped"))}  # fmt: skip
            assert {name: int(element.attrib[name]) for name in counts} == counts
            assert int(element.attrib["tests"]) == len(cases)
            total = sum(float(case.attrib["time"]) for case in cases)
            assert float(element.attrib["time"]) == pytest.approx(total, abs=1e-3 * (1 + len(cases)))
        for name in {"time"} & {*element.attrib}:
            assert re.fullmatch(r"\d+\.\d{3}", element.attrib[name])
    return root


def properties(element: ET.Element) -> dict[str, str]:
    return {each.attrib["name"]: each.attrib["value"] for each in element.findall("properties/property")}


outcomes = st.sampled_from(["PASS", "FAIL", "NOT TESTED", "INVALID", "ERROR", "VALID"])
texts = st.text(max_size=30)  # lone surrogates, control characters and all


@given(st.lists(st.tuples(outcomes, texts, st.floats(0, 1e4)), max_size=6), texts)
def test_whatever_is_said_the_file_is_of_the_format(
    tmp_path_factory: pytest.TempPathFactory, told: list[tuple[str, str, float]], words: str
) -> None:
    rows = [
        Row("", outcome, says, cause=says, seconds=seconds, trace=says, name=f"road {n}", words=says)  # type: ignore[arg-type]
        for n, (outcome, says, seconds) in enumerate(told)
    ]
    path = tmp_path_factory.mktemp("junit") / "roads.xml"
    write_junit(path, [(f"x{words}", {"words": words}, rows), ("empty", {}, [])])
    root = checked(path)
    suite = root.findall("testsuite")[0]
    marks = {"FAIL": ["failure"], "INVALID": ["skipped"], "ERROR": ["error"], "PASS": [], "VALID": []}
    marks["NOT TESTED"] = ["skipped"]
    for case, (outcome, _, _) in zip(suite.findall("testcase"), told, strict=True):
        assert [child.tag for child in case if child.tag != "properties"] == marks[outcome]
        assert "origin" not in properties(case)


def test_what_was_there_stays_where_the_file_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(RoadGPTError, match=r"cannot write .*name another file with --junit"):
        write_junit(tmp_path / "no" / "roads.xml", [])
    assert [*tmp_path.iterdir()] == []


def test_run_and_its_folder_write_the_same_tests(tmp_path: Path) -> None:
    own, again = tmp_path / "own.xml", tmp_path / "again.xml"
    words = ["turn x2", "-n", 4, "--seed", 7, "--reader", "plan", "--no-plot"]
    words += ["--driver", "beamng_like", "--oracle", "sbft"]
    out = tmp_path / "runs"
    told = roadgpt("run", *words, "--friction", 0.35, "--out", out, "--junit", own, "--json")
    roadgpt("report", out, "--junit", again)
    rows = [json.loads(line) for line in told.stdout.splitlines()]
    first, second = checked(own), checked(again)
    assert ET.tostring(first) == ET.tostring(second)
    (suite,) = first
    assert suite.get("name") == "turn x2"
    assert properties(suite)["friction"] == "0.35"
    assert properties(suite)["seed"] == "7"
    assert (properties(suite)["driver"], properties(suite)["oracle"]) == ("beamng_like", "sbft")
    for row, case in zip(rows, suite.findall("testcase"), strict=True):
        mark = case.find("failure")
        assert (mark is not None) == (row["test_outcome"] == "FAIL")
        if mark is not None:
            assert mark.get("message") == row["description"]
            assert mark.get("type") == "out of lane"
        found = properties(case)
        assert float(found["max_oob"]) == pytest.approx(row["max_oob"], abs=1e-4)
        assert float(found["margin_m"]) == pytest.approx(row["margin_m"], abs=1e-4)
        assert found["words"] == "turn x2"
        assert found["seed"].isdecimal()
    assert {row["test_outcome"] for row in rows} >= {"FAIL"}


def test_drive_tells_invalid_roads_as_skipped_and_broken_files_as_errors(tmp_path: Path) -> None:
    files = {"good.json": json.dumps(ROAD), "outside.json": json.dumps(OUTSIDE), "broken.json": "{"}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    path = tmp_path / "roads.xml"
    given_ = [tmp_path / name for name in files]
    done = CliRunner().invoke(
        app, ["drive", *map(str, given_), "--rules", "sbft", "--junit", str(path)], prog_name="roadgpt"
    )
    assert done.exit_code == 2  # one file holds no road
    (suite,) = checked(path)
    marks = [[child.tag for child in case if child.tag != "properties"] for case in suite.iter("testcase")]
    assert marks == [[], ["skipped"], ["error"]]
    error = suite.findall("testcase/error")[0]
    assert error.get("type") == "unreadable"


def test_an_error_has_the_place_in_the_drivers_code_where_it_arose(tmp_path: Path) -> None:
    driver = tmp_path / "mine.py"
    driver.write_text('class Mine:\n    def steer(self, view):\n        raise RuntimeError("no way to go")\n')
    own, again, out = tmp_path / "own.xml", tmp_path / "again.xml", tmp_path / "runs"
    words = ["straight | turns=0", "--seed", 1, "--reader", "plan", "--no-plot", "--driver"]
    roadgpt("run", *words, f"{driver}:Mine", "--out", out, "--junit", own)
    roadgpt("report", out, "--junit", again)
    assert own.read_bytes() == again.read_bytes()
    (error,) = checked(again).findall("testsuite/testcase/error")
    assert error.get("type") == "ERROR"
    assert error.text is not None
    assert f'File "{driver}", line 3, in steer' in error.text
    assert "RuntimeError: no way to go" in error.text


@pytest.mark.usefixtures("no_workers")
def test_a_campaign_writes_a_suite_for_each_cell(tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_text('prompts = ["turn x2", "straight | turns=0"]\nreader = "plan"\ntests = 2\n')
    first, second, third = (tmp_path / f"{n}.xml" for n in (1, 2, 3))
    roadgpt("campaign", plan, "--out", tmp_path / "c", "--junit", first, "--quiet")
    roadgpt("resume", tmp_path / "c", "--junit", second, "--quiet")
    roadgpt("report", tmp_path / "c", "--junit", third)
    root = checked(first)
    assert first.read_bytes() == second.read_bytes() == third.read_bytes()
    assert [suite.get("name") for suite in root] == ["c01: turn x2", "c02: straight | turns=0"]
    for suite in root:
        assert suite.get("tests") == "2"
        assert properties(suite)["generator"] == "words"
        for case in suite.findall("testcase"):
            assert {"words", "seed", "max_oob", "beyond_m", "margin_m"} <= {*properties(case)}


@pytest.mark.parametrize(("where", "says"), [("", "is a folder"), ("no/roads.xml", "there is no folder")])
def test_a_place_that_cannot_be_is_told_before_any_work(tmp_path: Path, where: str, says: str) -> None:
    result = CliRunner().invoke(app, ["run", "a road", "--junit", str(tmp_path / where)])
    assert result.exit_code == 2
    assert says in re.sub(r"\s+", " ", result.output)
