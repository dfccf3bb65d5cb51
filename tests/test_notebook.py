"""The notebook among the examples runs, cell by cell, in IPython's shell; its values show themselves."""

import json
import subprocess
import sys
from pathlib import Path

NOTEBOOK = Path(__file__).parents[1] / "examples" / "notebooks" / "words_to_verdict.ipynb"
RUN = """
import json, sys
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
for cell in json.load(open(sys.argv[1]))["cells"]:
    if cell["cell_type"] == "code":
        done = shell.run_cell("".join(cell["source"]))
        done.raise_error()
        if done.result is not None:
            shown, _ = shell.display_formatter.format(done.result)
            told = type(done.result).__name__, sorted(shown), shown.get("text/markdown", "")
            print("SHOWN " + json.dumps(told))
"""


def test_the_notebook_runs_and_its_values_show_themselves(tmp_path: Path) -> None:
    book = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    assert all(not cell.get("outputs") for cell in book["cells"])  # nothing generated is committed
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(NOTEBOOK)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    values = [json.loads(line[6:]) for line in lines if line.startswith("SHOWN ")]
    pictured = ["image/png", "text/plain"]
    assert [(name, shown) for name, shown, _ in values if name != "tuple"] == [
        ("Brief", ["text/markdown", "text/plain"]),
        ("Road", pictured),
        ("Verdict", ["text/markdown", "text/plain"]),
        ("Run", pictured),
        ("Verdict", ["text/markdown", "text/plain"]),
    ]
    assert values[0][2] == "An uphill road with 3 turns."
    said = [text for name, _, text in values if name == "Verdict"]
    assert all(text.startswith(("**PASS**: kept its lane", "**FAIL**: ")) for text in said)
    printed = [line for line in lines if not line.startswith(("SHOWN ", "Out["))]
    assert [line.split()[0] for line in printed if "from failing" in line] == [
        "lane_centring",
        "pure_pursuit",
        "reference",
    ]
    assert not [*tmp_path.iterdir()]
