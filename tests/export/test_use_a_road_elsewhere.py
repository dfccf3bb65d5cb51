"""The how-to runs: what it says of each format is so, as far as readers of it are installed here."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from exported import ROADS, WORLD, drive
from roadgpt import plugins
from roadgpt.export import save

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "use-a-road-elsewhere.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("code", BLOCKS, ids=lambda code: code.split()[1])
def test_three_lines_open_the_file(tmp_path: Path, code: str) -> None:
    if find_spec(code.split()[1]) is None:
        pytest.skip("this reader has no wheel for this Python")
    save(ROADS["arcs"], tmp_path / "exports", ["gltf", "lanelet2", "crg", "csv"], WORLD, "my_road")
    assert sum(bool(line) for line in code.splitlines()) <= 3
    run = [sys.executable, "-c", code]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_table_names_every_format_and_its_files(tmp_path: Path) -> None:
    rows = dict(re.findall(r"^\| `(\w+)` \| ([^|]+) \|", PAGE, flags=re.MULTILINE))
    assert set(rows) == set(plugins.names("exporters"))
    for format_, files in rows.items():
        told = set(re.findall(r"`([^`]+)`", files))
        folder = tmp_path / format_
        written = save(ROADS["arcs"], folder, [format_], WORLD, "my_road", drive(ROADS["arcs"]))
        endings = {path.name.removeprefix("my_road") for path in written}
        assert endings | {".net.xml"} == told | {".net.xml"}, format_
