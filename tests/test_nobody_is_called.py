"""The program opens no connection and writes no file behind the user's back; nor do the libraries it uses."""

import ast
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
COMMANDS = """
run "two hairpins" -n 1 --seed 7 --out runs --junit runs.xml
campaign "a road with 3 turns" -n 2 -j 2 --seed 7 --out hard
report hard
view runs/runs/0001 --out page.html
export runs --to opendrive,openscenario,gltf,lanelet2,commonroad,sumo,crg,beamng,sbft --out roads
import roads/runs-0001.xodr --out imported.json
film runs/runs/0001 --size 160x90 --seconds 1 --out film.mp4
doctor
"""
ALL_OF_THEM = """
import os, shlex, sys
def watch(event, told):
    if event == "import" and told[0] == "onnxruntime":
        assert os.environ["ORT_DISABLE_TELEMETRY"] == "1"
        open("telemetry is off", "a").close()
sys.addaudithook(watch)
from roadgpt.cli import app
if __name__ == "__main__":
    for line in sys.argv[1:]:
        assert app(shlex.split(line), "roadgpt", standalone_mode=False) in (None, 0), line
"""
TRACED = (
    "connect,sendto,sendmsg,open,openat,creat,mkdir,mkdirat,rename,renameat,renameat2,link,linkat,symlink"
)


def imports_it(file: Path) -> bool:
    tree = [*ast.walk(ast.parse(file.read_text()))]
    froms = [node.module for node in tree if isinstance(node, ast.ImportFrom) and not node.level]
    plain = [each.name for node in tree if isinstance(node, ast.Import) for each in node.names]
    return "onnxruntime" in (*froms, *plain)


@pytest.mark.timeout(900)
def test_one_module_imports_onnxruntime_and_first_switches_its_telemetry_off(
    traced: tuple[Path, list[str]],
) -> None:
    files = [file for file in (ROOT / "src").rglob("*.py") if "onnxruntime" in file.read_text()]
    assert [file.relative_to(ROOT / "src" / "roadgpt").as_posix() for file in files if imports_it(file)] == [
        "brief/readers/model/onnx_runtime.py"
    ]
    # conftest.py watches the order in this process; ``traced`` is a new one, with a wish to the contrary
    assert (traced[0] / "telemetry is off").exists()


@pytest.fixture(scope="module")
def traced(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """A folder in which all commands ran, and what strace told of their system calls, line by line."""
    if shutil.which("strace") is None:
        pytest.skip("there is no strace, which tells whom the commands call and what they write")
    folder = tmp_path_factory.mktemp("traced")
    (folder / "home").mkdir()
    env = {
        "HOME": str(folder / "home"),
        "PATH": os.environ["PATH"],
        "TMPDIR": str(folder),
        "ORT_DISABLE_TELEMETRY": "0",
    }
    (folder / "all.py").write_text(ALL_OF_THEM)
    done = subprocess.run(
        ["strace", "-f", "-y", "--seccomp-bpf", f"-etrace={TRACED}", f"-o{folder}/calls",
         sys.executable, "all.py", *COMMANDS.strip().splitlines()],
        cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True,
    )  # fmt: skip
    if "ptrace" in done.stderr or "PTRACE" in done.stderr:
        pytest.skip("strace may not trace here")
    assert done.returncode == 0, done.stderr
    return folder, (folder / "calls").read_text().splitlines()


@pytest.mark.timeout(900)
def test_no_command_calls_anybody(traced: tuple[Path, list[str]]) -> None:
    _, calls = traced
    outside = re.compile(r"(connect|sendto|sendmsg)\(.*(AF_INET|sin_addr)")
    loopback = re.compile(r'inet_addr\("127\.|"::1"')
    resolver = re.compile(r"htons\(53\)")  # which may listen on loopback
    assert [
        call
        for call in calls
        if outside.search(call) and not (loopback.search(call) and not resolver.search(call))
    ] == []


@pytest.mark.timeout(900)
def test_no_command_writes_outside_of_its_output_and_the_declared_caches(
    traced: tuple[Path, list[str]],
) -> None:
    folder, calls = traced
    assert {path for path in written(calls, folder) if not is_declared(path, folder)} == set()
    assert any(path.match("hard/results.csv*") for path in written(calls, folder))


def written(calls: Iterable[str], folder: Path) -> Iterator[Path]:
    """Yields the paths that system calls write to or make."""
    writing = re.compile(r"\d+ +(open\w*\(.*(O_WRONLY|O_RDWR|O_CREAT)|creat|mkdir|rename|link|symlink)")
    for call in calls:
        if " = -1 " in call or not writing.match(call):
            continue
        if found := re.search(r'(?:(?:AT_FDCWD|\d+)<([^>]*)>, )?"([^"]*)"', call):
            yield Path(found[1] or folder) / found[2]


def is_declared(path: Path, folder: Path) -> bool:
    """Whether docs/reference/limits.md says that RoadGPT and its libraries write there."""
    home = folder / "home"
    caches = (home / ".cache" / "matplotlib", home / ".config" / "matplotlib")
    if path.is_relative_to(home):
        parents = {parent for cache in caches for parent in cache.parents}
        return path in parents or any(path.is_relative_to(cache) for cache in caches)
    is_bytecode = "__pycache__" in path.parts
    is_of_system = path.is_relative_to("/dev") or path.is_relative_to("/proc/self")
    return path.is_relative_to(folder) or is_bytecode or is_of_system


@pytest.mark.skipif(sys.platform != "linux", reason="/proc takes no file")
def test_a_home_that_takes_no_file_is_nothing_to_talk_about(tmp_path: Path) -> None:
    design = ROOT / "examples" / "roads" / "my_road.json"
    env = {"HOME": "/proc/nowhere", "PATH": os.environ["PATH"]}
    command = [
        sys.executable, "-m", "roadgpt", "view", str(design), "--format", "png", "--out", str(tmp_path),
    ]  # fmt: skip
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert [*tmp_path.rglob("*.png")]
